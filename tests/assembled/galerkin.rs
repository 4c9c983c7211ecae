//! Galerkin steps on scenes whose mass varies or couples bodies, and steps that passes do not solve.

use evi_core::assembled::{AssembledScheme, AssembledSimulation};
use evi_core::integrator::Statistics;
use evi_core::prelude::*;
use evi_tests::largest_difference;
use evi_tests::trusses::{Placed, chain, net, ring, tree};

const WINDOWS: usize = 3;
const JOINTS: usize = 4;

/// Windows of four-bar linkages of uniform rods on a wagon, whose inertia depends on the first of them: rods couple their ends by mass.
macro_rules! windows {
    ($name:ident, $windows:tt, $joints:tt) => {
        #[derive(MechanicalSystem, Clone, Debug)]
        #[evi(
            coordinates(x, b: [$joints, 2]),
            kinetic = 0.5 * wagon * der(x).powi(2) * (1 + b[0][1].powi(2))
                + sum(0..$joints, |i| m / 6.0 * (1 + 0.1 * i) * (der(b[i]).norm_squared() + der(x) * der(b[i][0]) + der(x).powi(2)))
                + sum(0..$windows, |i| m / 6.0
                    * (der(b[i]).norm_squared() + der(b[i]).dot(der(b[i + 1])) + der(b[i + 1]).norm_squared())),
            potential = 0.5 * k * x.powi(2) + m * g * sum(0..$joints, |i| b[i][1]),
            dissipation = 0.5 * c * der(x).powi(2),
            constraint(upright[i in 0..$joints]: (b[i][0] - x - l * i).powi(2) + b[i][1].powi(2) == l.powi(2)),
            constraint(coupler[i in 0..$windows]: (b[i + 1] - b[i]).norm_squared() == l.powi(2)),
        )]
        pub(crate) struct $name {
            wagon: f64,
            m: f64,
            l: f64,
            g: f64,
            k: f64,
            c: f64,
        }

        impl $name {
            pub(crate) const UNEQUAL: Self = Self { wagon: 2.0, m: 0.7, l: 0.9, g: 9.81, k: 30.0, c: 0.2 };

            /// All uprights at an angle, the wagon in motion.
            pub(crate) fn start() -> ([f64; 9], [f64; 9]) {
                let (angle, rate, speed) = (0.7_f64, 1.3, -0.4);
                let l = Self::UNEQUAL.l;
                let mut q = [0.1; 9];
                let mut v = [speed; 9];
                for i in 0..JOINTS {
                    q[1 + 2 * i] = q[0] + l * i as f64 + l * angle.sin();
                    q[2 + 2 * i] = l * angle.cos();
                    v[1 + 2 * i] = speed + l * rate * angle.cos();
                    v[2 + 2 * i] = -l * rate * angle.sin();
                }
                (q, v)
            }
        }
    };
}

windows!(Unrolled, 3, 4);
windows!(Looped, WINDOWS, JOINTS);

/// Before the uprights lie flat, where all constraints are dependent.
const END: f64 = 0.2;

/// The end of a run of the windows, and what has happened.
fn end_of(scheme: impl AssembledScheme, end: f64) -> (Vec<f64>, Vec<f64>, Statistics) {
    let (q, v) = Looped::start();
    let run = AssembledSimulation::new(Looped::UNEQUAL, scheme).start(q, v).expect("a start");
    let mut run = run.with_tally(Statistics::default());
    run.advance_to(end).expect("every step");
    assert!(run.constraint_error().max(run.hidden_constraint_error()) < 2e-15, "{}", run.constraint_error());
    (run.state().q().to_vec(), run.state().v().to_vec(), *run.tally())
}

#[test]
fn masses_that_vary_and_couple_bodies_move_as_by_the_specialised_step() {
    let (q, v) = Unrolled::start();
    let scheme = Galerkin::<3>::new(0.02);
    let mut one = Simulation::new(Unrolled::UNEQUAL, scheme)
        .start(q, v)
        .expect("a start")
        .with_tally(Statistics::default());
    one.advance_to(END).expect("every step");
    let (of_q, of_v, statistics) = end_of(scheme, END);
    let (newton_q, newton_v, by_newton) = end_of(scheme.by_newton(), END);
    assert!(largest_difference(&of_q, &q) > 0.2, "it moves");
    println!("{:?} {statistics:?} {by_newton:?}", one.tally());
    let differences = [
        largest_difference(one.state().q(), &of_q),
        largest_difference(one.state().v(), &of_v),
        largest_difference(&newton_q, &of_q),
        largest_difference(&newton_v, &of_v),
    ];
    println!("{differences:?}");
    // 1.8e-15 measured, of velocities of 2.
    assert!(differences.into_iter().all(|difference| difference < 5e-15), "{differences:?}");
    assert_eq!((statistics.newton_steps, statistics.restarts), (0, 0));
}

#[test]
fn orders_are_those_of_the_members() {
    let (exact, ..) = end_of(Galerkin::<8>::new(0.01), END);
    let check = |errors: Vec<f64>, order: f64| {
        let slopes: Vec<f64> = errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
        println!("{errors:?} {slopes:?}");
        assert!(slopes.iter().all(|slope| (slope - order).abs() < 0.2), "{slopes:?}");
    };
    let errors = |of: &dyn Fn(f64) -> Vec<f64>, h: f64| -> Vec<f64> {
        (0..4).map(|k| largest_difference(&of(h / f64::from(1 << k)), &exact)).collect()
    };
    check(errors(&|h| end_of(Galerkin::<2>::new(h), END).0, 0.02), 4.0);
    check(errors(&|h| end_of(Galerkin::<3>::new(h), END).0, 0.1), 6.0);
}

/// Round-off of places up to 10 that constraints join: 1.8e-15 measured.
const MANY: f64 = 3e-15;

/// Newton's iteration on all points ends where passes do.
#[track_caller]
fn check_newton<const K: usize>(Placed { truss, q }: Placed, h: f64, bound: f64) {
    let rest = vec![0.0; q.len()];
    let end = |scheme: Galerkin<K>| {
        let run =
            AssembledSimulation::new(truss.clone(), scheme).start(q.clone(), rest.clone()).expect("a start");
        let mut run = run.with_tally(Statistics::default());
        run.advance_to(10.0 * h).expect("every step");
        // Bodies fall 490 h² in this time.
        assert!(largest_difference(run.state().q(), &q) > 50.0 * h * h, "it moves");
        (run.state().q().to_vec(), *run.tally())
    };
    let ((passes, of_passes), (newton, of_newton)) =
        (end(Galerkin::new(h)), end(Galerkin::new(h).by_newton()));
    let difference = largest_difference(&passes, &newton);
    println!("{difference:e} {of_passes:?} {of_newton:?}");
    assert!(difference < bound, "{difference:e}");
    assert_eq!(of_passes.newton_steps, 0);
}

#[test]
fn newton_on_all_points_ends_where_passes_do() {
    // 8.2e-16 measured, where links begin to whip.
    check_newton::<3>(chain(5), 0.02, 1.5e-15);
    check_newton::<8>(chain(5), 0.05, 1.5e-15);
    check_newton::<4>(net(3), 0.02, 1.5e-15);
}

#[test]
fn passes_over_many_bodies_end_where_newton_on_all_points_does() {
    // In sweeps of many steps: places that follow each other, a last body joined with the first, parents far from their children, springs across rows.
    check_newton::<4>(chain(1_200), 5e-4, MANY);
    check_newton::<4>(ring(150), 0.002, MANY);
    check_newton::<4>(tree(150), 0.002, MANY);
    check_newton::<4>(net(12), 0.002, MANY);
}

#[test]
fn steps_that_passes_do_not_solve_are_left_to_newton() {
    // Springs that turn by two radians in a step: passes diverge, and what Newton's iteration finds is the same step there and back.
    let Placed { mut truss, q } = net(3);
    for ([a, b], stiffness, length) in &mut truss.springs {
        *stiffness *= 3e3;
        *length = (q[2 * *b] - q[2 * *a]).hypot(q[2 * *b + 1] - q[2 * *a + 1]);
    }
    let rest = vec![0.0; q.len()];
    let taken = |h: f64, t: f64, q: &[f64], v: &[f64]| {
        let simulation = AssembledSimulation::new(truss.clone(), Galerkin::<2>::new(h));
        let mut run = simulation.start_at(t, q, v).expect("a start").with_tally(Statistics::default());
        for _ in 0..10 {
            run.advance().expect("a step");
        }
        (run.state().clone(), *run.tally(), run.constraint_error())
    };
    let (end, forth, error) = taken(0.02, 0.0, &q, &rest);
    let (back, ..) = taken(-0.02, end.t(), end.q(), end.v());
    let moved = largest_difference(end.q(), &q);
    let beside = largest_difference(back.q(), &q);
    println!("{forth:?}, moved by {moved}, back to {beside:e}, φ {error:e}");
    assert!(forth.newton_steps == 10 && moved > 0.1);
    // 7.8e-16 measured, of coordinates below 1.
    assert!(beside < 2e-15 && error < 1e-16, "{beside:e} {error:e}");
}

#[test]
fn windows_swing_through_the_position_in_which_they_lie_flat() {
    // There all constraints are dependent: on the way through, passes fail.
    let (q, v) = Looped::start();
    let windows = Looped { c: 0.0, ..Looped::UNEQUAL };
    let run = AssembledSimulation::new(windows, Galerkin::<8>::new(0.02)).start(q, v).expect("a start");
    let mut run = run.with_tally(Statistics::default());
    let (energy, mut lowest, mut error) = (run.energy(), q[2], 0.0_f64);
    while run.state().t() < 1.5 {
        let state = run.advance().expect("a step");
        lowest = lowest.min(state.q()[2]);
        error = error.max((run.energy() - energy).abs());
    }
    println!("{:?}, H {error:e}, φ {:e}, down to {lowest}", run.tally(), run.constraint_error());
    assert!(run.tally().newton_steps > 0 && lowest < -0.5);
    // 6.3e-11 J measured, of some 20 J.
    assert!(error < 1e-10 && run.constraint_error() < 1e-15, "{error:e} {:e}", run.constraint_error());
}
