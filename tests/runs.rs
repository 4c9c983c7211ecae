//! What a user does with a run: starts, steps, times, recordings, observables, and comparisons.

use evi_core::baseline::{Rattle, Rk4};
use evi_core::comparison::Solver;
use evi_core::integrator::EviStep;
use evi_core::mechanics::Mechanics;
use evi_core::prelude::*;
use evi_core::scheme::Interpolant;
use evi_examples::{DoublePendulum, Pendulum, SphericalPendulum, Start, StiffSpringPendulum};
use evi_tests::largest_difference;
use evi_tests::scenes::{ChargedSphericalPendulum, Dumbbell, KapitzaPendulum, RelativisticBead};
use nalgebra::{DMatrix, DVector, SVector};

const EPSILON: f64 = f64::EPSILON;
/// No two parameters alike, so that no term can take the place of another.
const UNEQUAL: DoublePendulum = DoublePendulum { m1: 1.3, m2: 0.7, l1: 0.9, l2: 1.1, g: 9.81 };

/// The unequal double pendulum in motion: angles 0.8 and −0.3 at the rates 0.5 and 1.1.
fn moving() -> Start<4> {
    let ([a, b], [a_rate, b_rate]) = ([0.8_f64, -0.3_f64], [0.5, 1.1]);
    let q = UNEQUAL.at_angles(a, b).q;
    let inner = [UNEQUAL.l1 * a.cos() * a_rate, UNEQUAL.l1 * a.sin() * a_rate];
    let outer = [inner[0] + UNEQUAL.l2 * b.cos() * b_rate, inner[1] + UNEQUAL.l2 * b.sin() * b_rate];
    Start { q, v: [inner[0], inner[1], outer[0], outer[1]] }
}

fn midpoint_run() -> Run<DoublePendulum, impl OneStep<DoublePendulum>> {
    let Start { q, v } = moving();
    Simulation::new(UNEQUAL, Evi::midpoint(0.01)).start(q, v).expect("the start is consistent")
}

#[track_caller]
fn check_near(a: &[f64], b: &[f64], tolerance: f64) {
    let difference = largest_difference(a, b);
    assert!(difference <= tolerance, "{difference:e}, allowed {tolerance:e}: {a:?} and {b:?}");
}

// Starts.

#[test]
fn a_run_stands_at_its_start() {
    let Start { q, v } = moving();
    let run = midpoint_run();
    // A consistent position is not touched; a velocity and its momentum are rounded in the projection.
    assert_eq!(run.state().q(), &q);
    check_near(run.state().v(), &v, 4.0 * EPSILON);
    let momentum = [UNEQUAL.m1 * v[0], UNEQUAL.m1 * v[1], UNEQUAL.m2 * v[2], UNEQUAL.m2 * v[3]];
    check_near(run.state().p(), &momentum, 4.0 * EPSILON);
    assert_eq!((run.state().t(), run.steps()), (0.0, 0));
}

#[test]
fn arrays_and_vectors_of_nalgebra_start_a_run() {
    let Start { q, v } = moving();
    let simulation = Simulation::new(UNEQUAL, Evi::midpoint(0.01));
    let array = simulation.start(q, v).expect("consistent");
    let vector =
        simulation.start(SVector::<f64, 4>::from(q), SVector::<f64, 4>::from(v)).expect("consistent");
    assert_eq!(array.state(), vector.state());
}

#[test]
fn a_simulation_starts_as_many_runs_as_one_likes() {
    let Start { q, v } = moving();
    let simulation = Simulation::new(UNEQUAL, Evi::midpoint(0.01));
    let (mut first, mut second) = (simulation.start(q, v).unwrap(), simulation.start_at(3.0, q, v).unwrap());
    assert_eq!((second.state().t(), second.steps()), (3.0, 0));
    first.advance_to(1.0).unwrap();
    second.advance_to(4.0).unwrap();
    // Nothing in this scene depends on time.
    assert_eq!(first.state().q(), second.state().q());
    assert_eq!(simulation.system().m1, 1.3);
}

/// Of the consistent starts, the nearest in the metric of the masses: what was added is a combination of
/// the constraints' gradients over the masses, hence orthogonal to every velocity that the constraints allow.
#[track_caller]
fn check_projection<S, const N: usize>(
    system: S,
    t: f64,
    masses: [f64; N],
    gradients: impl Fn(&[f64; N]) -> Vec<[f64; N]>,
    start: Start<N>,
) where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
{
    let simulation = Simulation::new(system, Evi::midpoint(0.01));
    let inconsistent = simulation.start_at(t, start.q, start.v).err();
    assert!(matches!(inconsistent, Some(StartError::InconsistentPosition { .. })), "nothing to project");
    let run = simulation.start_projected(t, start.q, start.v).expect("the manifold is near");
    let state = run.state();
    assert_eq!(state.t(), t);
    for residual in run.mechanics().constraint_residual(state).as_ref() {
        assert!(residual.abs() <= 8.0 * EPSILON, "{residual:e}");
    }
    for residual in run.mechanics().hidden_constraint_residual(state).as_ref() {
        assert!(*residual <= 4.0 * EPSILON, "{residual:e}");
    }
    let gradients = gradients(state.q());
    let normal = DMatrix::from_fn(N, gradients.len(), |i, c| gradients[c][i] / masses[i].sqrt());
    check_normal(&normal, DVector::from_fn(N, |i, _| masses[i].sqrt() * (state.q()[i] - start.q[i])));
}

/// The part of `displacement` outside the columns of `normal` is round-off.
#[track_caller]
fn check_normal(normal: &DMatrix<f64>, displacement: DVector<f64>) {
    let inside = normal * normal.clone().svd(true, true).solve(&displacement, 0.0).expect("both factors");
    let outside = (&displacement - inside).norm() / displacement.norm();
    assert!(displacement.norm() > 1e-3, "vacuous: {:e}", displacement.norm());
    // A difference of positions of size 2 is off by 2 ε, over its own size of 1e-3 or more; in the metric of
    // masses a factor 1e3 apart, 30 times that: 1.2e-13 measured.
    assert!(outside <= 1e-12, "a part {outside:e} of the displacement lies in the manifold");
}

fn rods(q: &[f64; 4]) -> Vec<[f64; 4]> {
    let rod = [q[2] - q[0], q[3] - q[1]];
    vec![[q[0], q[1], 0.0, 0.0], [-rod[0], -rod[1], rod[0], rod[1]]]
}

#[test]
fn a_start_is_projected_to_the_nearest_consistent_one() {
    let masses = [UNEQUAL.m1, UNEQUAL.m1, UNEQUAL.m2, UNEQUAL.m2];
    let Start { q, v } = moving();
    // A per mille, and a third of the rods.
    for size in [1e-3, 3e-2, 0.3] {
        let q = [q[0] + size, q[1] - 0.6 * size, q[2] + 0.8 * size, q[3] + 1.1 * size];
        check_projection(UNEQUAL, 0.0, masses, rods, Start { q, v });
    }
    // Very different masses: the heavy bob stays, the light one moves.
    let lever = DoublePendulum { m1: 1e-3, m2: 1e3, ..UNEQUAL };
    let masses = [1e-3, 1e-3, 1e3, 1e3];
    check_projection(lever, 0.0, masses, rods, Start { q: [q[0] + 0.1, q[1], q[2], q[3] - 0.1], v });
}

#[test]
fn a_start_is_projected_on_constraints_that_move() {
    let system = KapitzaPendulum::STANDARD;
    let t = 0.4;
    let pivot = system.a * (system.w * t).cos();
    let gradient = |q: &[f64; 2]| vec![[q[0], q[1] - pivot]];
    check_projection(system, t, [1.0; 2], gradient, Start { q: [0.2, pivot + 0.3], v: [0.4, -0.2] });
}

#[test]
fn a_velocity_is_projected_in_the_metric_of_the_masses() {
    let Start { q, v } = moving();
    let thrown = [v[0] + 1.0, v[1] - 0.3, v[2], v[3] + 0.5];
    let simulation = Simulation::new(UNEQUAL, Evi::midpoint(0.01));
    assert!(matches!(simulation.start(q, thrown), Err(StartError::InconsistentVelocity { .. })));
    let run = simulation.start_projected(0.0, q, thrown).expect("a velocity can always be projected");
    // The position satisfied the constraints to round-off.
    check_near(run.state().q(), &q, 4.0 * EPSILON);
    let masses = [UNEQUAL.m1, UNEQUAL.m1, UNEQUAL.m2, UNEQUAL.m2];
    let rods = rods(run.state().q());
    let normal = DMatrix::from_fn(4, 2, |i, c| rods[c][i] / masses[i].sqrt());
    check_normal(&normal, DVector::from_fn(4, |i, _| masses[i].sqrt() * (run.state().v()[i] - thrown[i])));
}

#[test]
fn without_constraints_a_projected_start_is_the_start() {
    let simulation = Simulation::new(Pendulum { m: 1.0, l: 1.0, g: 9.81 }, Evi::midpoint(0.01));
    let run = simulation.start_projected(0.0, [0.3], [0.7]).unwrap();
    assert_eq!((run.state().q(), run.state().v()), (&[0.3], &[0.7]));
}

// Steps and times.

#[test]
fn time_is_the_start_plus_a_number_of_steps() {
    let Start { q, v } = moving();
    for (start, h) in [(0.0, 0.01), (17.3, 0.01), (17.3, -0.01)] {
        let mut run = Simulation::new(UNEQUAL, Evi::midpoint(h)).start_at(start, q, v).unwrap();
        for k in 1..=1_000 {
            // Equality of bits: one rounding of the product, one of the sum, however many steps.
            assert_eq!(run.advance().unwrap().t(), start + f64::from(k) * h);
            assert_eq!(run.steps(), k as u64);
        }
    }
}

#[test]
fn a_run_goes_to_the_step_nearest_to_a_time() {
    let mut run = midpoint_run();
    for (t, steps) in [(0.996, 100), (1.004, 100), (1.0, 100), (0.992, 100), (1.006, 101)] {
        run.advance_to(t).unwrap();
        assert_eq!(run.steps(), steps, "to {t}");
    }
    for t in [0.5, -3.0] {
        assert!(run.advance_to(t).is_err(), "{t} is behind");
        assert_eq!(run.steps(), 101);
    }
}

#[test]
fn a_run_with_negative_steps_goes_back_in_time() {
    let Start { q, v } = moving();
    let mut run = Simulation::new(UNEQUAL, Evi::midpoint(-0.01)).start_at(2.0, q, v).unwrap();
    assert!(run.advance_to(2.5).is_err(), "ahead");
    assert_eq!(run.steps(), 0);
    run.advance_to(1.0).unwrap();
    assert_eq!((run.steps(), run.state().t()), (100, 1.0));
}

/// 100 steps there and back again.
#[track_caller]
fn check_return<S, F, const N: usize>(system: S, there: F, back: F, start: Start<N>)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Copy,
    F: Scheme<S>,
{
    let mut run = Simulation::new(system, there).start(start.q, start.v).unwrap();
    let end = run.advance_to(1.0).unwrap();
    assert!(largest_difference(end.q(), &start.q) > 1e-2, "the run stood still");
    let (t, q, v) = (end.t(), *end.q(), *end.v());
    let mut run = Simulation::new(system, back).start_at(t, q, v).expect("the end is consistent");
    let end = run.advance_to(0.0).unwrap();
    assert_eq!(end.t(), 0.0);
    // Round-off of 200 steps, which the motion amplifies little in one unit of time: 10 ε measured.
    check_near(end.q(), &start.q, 64.0 * EPSILON);
}

#[test]
fn symmetric_schemes_come_back() {
    check_return(UNEQUAL, Evi::midpoint(0.01), Evi::midpoint(-0.01), moving());
    check_return(UNEQUAL, Evi::simpson(0.01).frequency(2.0), Evi::simpson(-0.01).frequency(2.0), moving());
    check_return(UNEQUAL, Rattle::new(0.01), Rattle::new(-0.01), moving());
    let kapitza = KapitzaPendulum::STANDARD;
    check_return(kapitza, Evi::midpoint(0.01), Evi::midpoint(-0.01), kapitza.near_inverted());
}

#[test]
fn a_recording_keeps_every_state() {
    let mut run = midpoint_run();
    let mut other = midpoint_run();
    let trajectory = run.integrate(0.5).unwrap();
    assert_eq!(trajectory.states().len(), 51);
    assert_eq!(&trajectory.states()[0], other.state());
    for state in &trajectory.states()[1..] {
        assert_eq!(state, other.advance().unwrap());
    }
    assert_eq!(trajectory.last(), run.state());
    // The next recording begins where this one ended.
    let next = run.integrate(0.1).unwrap();
    assert_eq!((&next.states()[0], next.states().len()), (trajectory.last(), 11));
    assert_eq!(run.integrate(0.0).unwrap().states().len(), 1);
    assert_eq!(run.integrate(-1.0).unwrap_err().trajectory.states().len(), 1);
}

// The two-step view.

/// Every configuration follows from the two before it.
#[track_caller]
fn check_two_step_view<S, F, const N: usize, const K: usize>(
    system: S,
    scheme: Evi<K, F>,
    t: f64,
    start: Start<N>,
) where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Interpolant<S>,
{
    let mut run = Simulation::new(system, scheme).start_at(t, start.q, start.v).unwrap();
    let trajectory = run.integrate(1.0).unwrap();
    let map: &EviStep<S, F, K> = run.map();
    let mut largest = 0.0_f64;
    for states in trajectory.states().windows(3) {
        let [prev, curr, next] = states else { unreachable!("windows of three") };
        let q = map.next_configuration(prev.t(), prev.q(), curr.q()).expect("the step exists");
        largest = largest.max(largest_difference(&q, next.q()));
    }
    assert!(trajectory.states().len() > 50);
    // A difference of positions of size 2 stands for a velocity, and is off by 2 ε, as much as is measured.
    assert!(largest <= 8.0 * EPSILON, "{:.1} ε", largest / EPSILON);
}

#[test]
fn the_two_step_view_has_the_positions_of_the_one_step_map() {
    check_two_step_view(UNEQUAL, Evi::midpoint(0.01), 0.0, moving());
    check_two_step_view(UNEQUAL, Evi::simpson(0.01), 0.0, moving());
    check_two_step_view(UNEQUAL, Evi::new(Quadrature::<2>::uniform(), 0.01), 0.0, moving());
    let spherical = SphericalPendulum::UNIT;
    check_two_step_view(spherical, Evi::midpoint(0.01), 0.0, spherical.one_radian());
    let spring = StiffSpringPendulum::with_stiffness(1e3);
    check_two_step_view(spring, Evi::simpson(0.01), 0.0, spring.horizontal());
}

#[test]
fn the_two_step_view_has_the_positions_of_the_exponential_maps() {
    check_two_step_view(UNEQUAL, Evi::midpoint(0.01).frequency(2.4), 0.0, moving());
    check_two_step_view(UNEQUAL, Evi::simpson(0.01).frequency(2.4), 0.0, moving());
    check_two_step_view(UNEQUAL, Evi::simpson(0.01).frequency(Frequency::Hyperbolic(2.4)), 0.0, moving());
    let per_body = [Frequency::ZERO, Frequency::ZERO, 2.4.into(), 2.4.into()];
    check_two_step_view(UNEQUAL, Evi::simpson(0.01).frequencies(per_body), 0.0, moving());
}

#[test]
fn the_two_step_view_knows_the_time_and_couplings_of_position_and_velocity() {
    let kapitza = KapitzaPendulum::STANDARD;
    check_two_step_view(kapitza, Evi::midpoint(0.01), 0.0, kapitza.near_inverted());
    check_two_step_view(kapitza, Evi::simpson(0.01).frequency(5.0), 0.0, kapitza.near_inverted());
    let charged = ChargedSphericalPendulum::STANDARD;
    check_two_step_view(charged, Evi::simpson(0.01).frequency(2.4), 5.0, charged.one_radian());
    let start = RelativisticBead::at_angle(1.0, 0.5);
    check_two_step_view(RelativisticBead::STANDARD, Evi::midpoint(0.01), 0.0, start);
}

// Observables.

#[test]
fn observables_are_the_formulas_of_a_textbook() {
    let DoublePendulum { m1, m2, l1, l2, g } = UNEQUAL;
    let Start { q: [x1, y1, x2, y2], v: [u1, w1, u2, w2] } = moving();
    let (q, v) = ([x1, y1, x2, y2], [u1, w1, u2, w2]);
    let mechanics = Mechanics::new(&UNEQUAL);
    let kinetic = 0.5 * m1 * (u1 * u1 + w1 * w1) + 0.5 * m2 * (u2 * u2 + w2 * w2);
    let energy = kinetic + g * (m1 * y1 + m2 * y2);
    check_near(&[mechanics.energy_at(0.0, &q, &v)], &[energy], 8.0 * EPSILON * energy.abs());
    check_near(&mechanics.momentum_at(0.0, &q, &v), &[m1 * u1, m1 * w1, m2 * u2, m2 * w2], 2.0 * EPSILON);
    // Away from the constraints, where the residuals are not zero.
    let q = [x1 + 0.1, y1, x2, y2 - 0.2];
    let rod = [q[2] - q[0], q[3] - q[1]];
    let lengths = [q[0] * q[0] + q[1] * q[1] - l1 * l1, rod[0] * rod[0] + rod[1] * rod[1] - l2 * l2];
    check_near(&mechanics.constraint_residual_at(0.0, &q), &lengths, 8.0 * EPSILON);
    let rates = [q[0] * u1 + q[1] * w1, rod[0] * (u2 - u1) + rod[1] * (w2 - w1)].map(f64::abs);
    let speed = v.iter().map(|v| v * v).sum::<f64>().sqrt();
    let gradients = [q[0].hypot(q[1]), 2.0_f64.sqrt() * rod[0].hypot(rod[1])];
    let relative = [rates[0] / (gradients[0] * speed), rates[1] / (gradients[1] * speed)];
    assert!(relative.iter().all(|relative| *relative > 1e-2), "vacuous: {relative:?}");
    check_near(&mechanics.hidden_constraint_residual_at(0.0, &q, &v), &relative, 8.0 * EPSILON);
}

#[test]
fn observables_of_a_state_are_those_at_its_numbers() {
    let mut run = midpoint_run();
    run.advance_to(0.3).unwrap();
    let (state, mechanics) = (run.state().clone(), run.mechanics());
    let (t, q, v) = (state.t(), state.q(), state.v());
    assert_eq!(run.energy(), mechanics.energy_at(t, q, v));
    assert_eq!(mechanics.constraint_residual(&state), mechanics.constraint_residual_at(t, q));
    assert_eq!(
        mechanics.hidden_constraint_residual(&state),
        mechanics.hidden_constraint_residual_at(t, q, v)
    );
    check_near(state.p(), &mechanics.momentum_at(t, q, v), 8.0 * EPSILON);
}

#[test]
fn a_hidden_constraint_at_rest_has_no_residual() {
    let mechanics = Mechanics::new(&UNEQUAL);
    assert_eq!(mechanics.hidden_constraint_residual_at(0.0, &moving().q, &[0.0; 4]), [0.0; 2]);
}

/// The constraint forces `−2 λ₁ r₁ + 2 λ₂ d` and `−2 λ₂ d` (`d` along the outer rod) from Newton's laws for
/// the bobs and the accelerations `r₁·a₁ = −v₁²`, `d·(a₂ − a₁) = −(v₂ − v₁)²` of rigid rods: two equations,
/// by Cramer's rule.
#[test]
fn accelerations_and_multipliers_are_those_of_newtons_laws() {
    let DoublePendulum { m1, m2, l1, l2, g } = UNEQUAL;
    let Start { q: [x1, y1, x2, y2], v: [u1, w1, u2, w2] } = moving();
    let [dx, dy] = [x2 - x1, y2 - y1];
    let cosine = x1 * dx + y1 * dy;
    let (a11, a12, b1) = (2.0 * l1 * l1 / m1, -2.0 * cosine / m1, u1 * u1 + w1 * w1 - g * y1);
    let (a21, a22) = (-2.0 * cosine / m1, 2.0 * l2 * l2 * (1.0 / m1 + 1.0 / m2));
    let b2 = (u2 - u1).powi(2) + (w2 - w1).powi(2);
    let determinant = a11 * a22 - a12 * a21;
    let lambda = [(b1 * a22 - a12 * b2) / determinant, (a11 * b2 - b1 * a21) / determinant];
    let inner = [
        (-2.0 * lambda[0] * x1 + 2.0 * lambda[1] * dx) / m1,
        (-2.0 * lambda[0] * y1 + 2.0 * lambda[1] * dy) / m1 - g,
    ];
    let outer = [-2.0 * lambda[1] * dx / m2, -2.0 * lambda[1] * dy / m2 - g];

    let Ok(found) = Mechanics::new(&UNEQUAL).acceleration(0.0, &[x1, y1, x2, y2], &[u1, w1, u2, w2]) else {
        panic!("masses and rods determine the acceleration");
    };
    // Both eliminations round forces of size 10: 4 ε and 8 ε measured.
    check_near(&found.multipliers, &lambda, 16.0 * EPSILON);
    check_near(&found.acceleration, &[inner[0], inner[1], outer[0], outer[1]], 32.0 * EPSILON);
    assert!(lambda.iter().all(|lambda| lambda.abs() > 1.0), "vacuous: {lambda:?}");
}

#[test]
fn multipliers_of_a_moving_constraint_know_its_acceleration() {
    // Hanging at rest below the pivot at the turn of its motion: the bob follows the pivot, a = −A w².
    let system = KapitzaPendulum::STANDARD;
    let (t, pivot) = (0.0, system.a);
    let Ok(found) = Mechanics::new(&system).acceleration(t, &[0.0, pivot - system.l], &[0.0; 2]) else {
        panic!("mass and rod determine the acceleration");
    };
    let follows = -system.a * system.w.powi(2);
    check_near(&found.acceleration, &[0.0, follows], 8.0 * EPSILON * follows.abs());
    // m a = −m g − Gᵀλ with G = (0, −2 l).
    let lambda = system.m * (follows + system.g) / (2.0 * system.l);
    check_near(&found.multipliers, &[lambda], 8.0 * EPSILON * lambda.abs());
}

// Parameters.

#[test]
fn parameters_are_numbers_of_the_run_not_of_the_build() {
    let Start { q, v } = Dumbbell::STANDARD.turning();
    let end = |system: Dumbbell| {
        let mut run = Simulation::new(system, Evi::midpoint(0.01)).start(q, v).unwrap();
        *run.advance_to(1.0).unwrap().q()
    };
    let standard = end(Dumbbell::STANDARD);
    let heavier = end(Dumbbell { m2: 5.0, ..Dumbbell::STANDARD });
    assert!(largest_difference(&standard, &heavier) > 1e-2);
    // Only the ratio of the masses matters. Equality of bits: powers of two are exact.
    assert_eq!(standard, end(Dumbbell { m1: 4.0, m2: 8.0, ..Dumbbell::STANDARD }));
}

#[test]
fn fourfold_gravity_is_the_same_motion_in_half_the_time() {
    let Start { q, .. } = moving();
    let end = |g: f64, h: f64| {
        let system = DoublePendulum { g, ..UNEQUAL };
        let mut run = Simulation::new(system, Evi::midpoint(h)).start(q, [0.0; 4]).unwrap();
        (0..100).for_each(|_| assert!(run.advance().is_ok()));
        run.state().clone()
    };
    let (slow, fast) = (end(9.81, 0.01), end(4.0 * 9.81, 0.005));
    // Equality of bits: every factor is a power of two.
    assert_eq!(slow.q(), fast.q());
    assert_eq!(slow.v().map(|v| 2.0 * v), *fast.v());
    assert!(largest_difference(slow.q(), &q) > 1e-2, "the run stood still");
}

#[test]
fn mechanics_is_a_copy_of_the_parameters() {
    let mut system = UNEQUAL;
    let mechanics = Mechanics::new(&system);
    let Start { q, v } = moving();
    let energy = mechanics.energy_at(0.0, &q, &v);
    system.g = 1.62;
    assert_eq!(mechanics.clone().energy_at(0.0, &q, &v), energy);
    assert_ne!(Mechanics::new(&system).energy_at(0.0, &q, &v), energy);
}

// Kernels in single precision.

/// Numbers rounded to single precision and back.
fn widened(values: &[f32]) -> Vec<f64> {
    values.iter().map(|value| f64::from(*value)).collect()
}

#[test]
fn kernels_in_single_precision_agree_to_single_precision() {
    type Scene = DoublePendulum;
    let Start { q, v } = moving();
    let single = |values: &[f64; 4]| values.map(|value| value as f32);
    let (q32, v32) = (single(&q), single(&v));
    let parameters = UNEQUAL.parameters();
    let constants = Scene::constants::<f64>(&parameters);
    let constants32 = Scene::constants::<f32>(&parameters.map(|parameter| parameter as f32));
    // Values of size 10 from arguments that are rounded themselves: 3 ε measured.
    let tolerance = 16.0 * f64::from(f32::EPSILON);

    let (gradient, hessian) = Scene::lagrangian_derivatives(&constants, 0.0, &q, &v);
    let (gradient32, hessian32) = Scene::lagrangian_derivatives(&constants32, 0.0, &q32, &v32);
    check_near(&widened(&gradient32.force), &gradient.force, tolerance);
    check_near(&widened(&gradient32.momentum), &gradient.momentum, tolerance);
    check_near(&widened(hessian32.as_ref()), hessian.as_ref(), tolerance);

    // Off the constraints, where the residuals are not zero.
    let (q, q32) = (q.map(|x| 1.5 * x), q32.map(|x| 1.5 * x));
    let (residual, jacobian) = Scene::constraint_derivatives(&constants, 0.0, &q);
    let (residual32, jacobian32) = Scene::constraint_derivatives(&constants32, 0.0, &q32);
    check_near(&widened(&residual32), &residual, tolerance);
    check_near(&widened(&jacobian32), &jacobian, tolerance);
    assert!(residual.iter().chain(&jacobian).all(|value| value.abs() > 0.1), "vacuous");

    let lagrangian = Scene::lagrangian(&constants, 0.0, &q, &v);
    let lagrangian32 = f64::from(Scene::lagrangian(&constants32, 0.0, &q32, &v32));
    check_near(&[lagrangian32], &[lagrangian], tolerance);
    // The kernel in single precision is not the one in double.
    assert_ne!(lagrangian32, lagrangian);
}

// Comparisons.

#[test]
fn solvers_of_every_kind_stand_in_one_list() {
    fn start(scheme: impl Scheme<DoublePendulum, Step: 'static>) -> Box<dyn Solver> {
        let Start { q, v } = moving();
        Box::new(Simulation::new(UNEQUAL, scheme).start(q, v).expect("the start is consistent"))
    }
    let mut solvers: Vec<Box<dyn Solver>> = vec![
        start(Evi::midpoint(0.001)),
        start(Evi::simpson(0.002)),
        start(Evi::simpson(0.001).frequency(2.4)),
        start(Rattle::new(0.001)),
        start(Rk4::new(0.005)),
    ];
    for solver in &mut solvers {
        assert_eq!((solver.t(), solver.steps()), (0.0, 0));
        solver.advance_to(1.0).expect("every step has a solution");
    }
    assert_eq!(solvers.iter().map(|solver| solver.steps()).collect::<Vec<_>>(), [1000, 500, 1000, 1000, 200]);
    let [reference, others @ ..] = solvers.as_slice() else { unreachable!("five solvers") };
    assert!(largest_difference(reference.q(), &moving().q) > 0.1, "the reference stood still");
    for solver in others {
        assert_eq!(solver.t(), reference.t());
        // Truncation errors of order 2 at h = 0.002: 5e-6 and 4e-5 measured.
        check_near(solver.q(), reference.q(), 2e-5);
        check_near(solver.v(), reference.v(), 2e-4);
        check_near(solver.p(), reference.p(), 2e-4);
    }
}

#[test]
fn a_solver_in_a_list_reports_errors_and_stands_before_them() {
    let system = DoublePendulum::UNIT;
    let Start { q, v } = system.horizontal();
    let run = Simulation::new(system, Evi::midpoint(0.3)).start(q, v).unwrap();
    let mut solver: Box<dyn Solver> = Box::new(run);
    let mut visited = 0;
    let failure = solver.advance_visiting(10.0, &mut |_| visited += 1).expect_err("steps far too long");
    assert!(matches!(failure.downcast_ref(), Some(StepError::NoSolution { .. })), "{failure}");
    assert_eq!((solver.steps(), visited), (2, 2));
    assert!(solver.q().iter().all(|q| q.is_finite()));
}
