//! Gauss integrators: their orders, their passes against Newton's iteration, and what they keep.

use evi_core::baseline::Rk4;
use evi_core::integrator::Statistics;
use evi_core::prelude::*;
use evi_examples::{FermiPastaUlam, Start, StiffSpringPendulum};
use evi_tests::agreement::roundings_between;
use evi_tests::conservation::there_and_back;
use evi_tests::convergence::check_orders;
use evi_tests::motions::{damped_pendulum, long_double_pendulum_in_angles, modulated_pendulum};
use evi_tests::scenes::{
    DampedOscillator, DoublePendulumInAngles, KapitzaPendulum, KapitzaPendulumInAngle,
    MotorisedDoublePendulum,
};

const ANGLES: DoublePendulumInAngles = DoublePendulumInAngles::UNEQUAL;
const MODERATE: Start<2> = DoublePendulumInAngles::MODERATE;

mod order {
    use super::*;

    #[test]
    fn configuration_dependent_mass() {
        check_orders(&long_double_pendulum_in_angles(), 8, Gauss::<1>::new, 2.0);
        check_orders(&long_double_pendulum_in_angles(), 8, Gauss::<2>::new, 4.0);
        check_orders(&long_double_pendulum_in_angles(), 8, Gauss::<3>::new, 6.0);
    }

    #[test]
    fn time_dependent_lagrangians() {
        check_orders(&modulated_pendulum(), 6, Gauss::<3>::new, 6.0);
        check_orders(&damped_pendulum(), 6, Gauss::<2>::new, 4.0);
    }
}

/// Steps by passes and by Newton's iteration from the same states.
mod agreement {
    use super::*;

    #[track_caller]
    fn check<S, const K: usize, const N: usize>(system: S, start: Start<N>, h: f64)
    where
        S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Clone,
    {
        let scheme = Gauss::<K>::new(h);
        let both = [scheme, scheme.by_newton()];
        let roundings = roundings_between(&system, start, h, both, |step| step.iteration());
        // Two iterations: 2.3 measured.
        assert!(roundings <= 4.0, "{roundings:.0} roundings");
    }

    #[test]
    fn every_number_of_nodes() {
        check::<_, 1, 2>(ANGLES, MODERATE, 0.02);
        check::<_, 2, 2>(ANGLES, MODERATE, 0.02);
        check::<_, 3, 2>(ANGLES, MODERATE, 0.05);
        check::<_, 5, 2>(ANGLES, MODERATE, 0.05);
        check::<_, 8, 2>(ANGLES, MODERATE, 0.05);
    }

    #[test]
    fn kinds_of_scenes() {
        let spring = StiffSpringPendulum::with_stiffness(1e3);
        check::<_, 8, 2>(spring, spring.horizontal(), 0.02);
        let chain = FermiPastaUlam::STANDARD;
        check::<_, 4, 6>(chain, chain.one_spring_excited(), 0.02);
        check::<_, 8, 2>(MotorisedDoublePendulum::STANDARD, MODERATE, 0.05);
        check::<_, 3, 1>(DampedOscillator::STANDARD, Start { q: [1.0], v: [0.3] }, 0.05);
        let moving = KapitzaPendulumInAngle::of(KapitzaPendulum::STANDARD);
        check::<_, 5, 1>(moving, Start { q: [3.0], v: [0.2] }, 0.002);
    }

    /// A plane in coordinates of which one is along the light cone: its mass matrix is indefinite, with a zero on the diagonal.
    #[derive(MechanicalSystem, Clone)]
    #[evi(
        coordinates(x, y),
        kinetic = 0.5 * a * der(x).powi(2) + c * der(x) * der(y),
        potential = 0.0,
        force(x: k * y.sin()),
        force(y: g),
    )]
    struct LightCone {
        a: f64,
        c: f64,
        k: f64,
        g: f64,
    }

    /// `x` is known at once, and only `y` takes several passes: its change has a length, though not in the metric of the mass matrix.
    #[test]
    fn indefinite_mass() {
        let plane = LightCone { a: 0.2, c: 0.06, k: 0.3, g: -0.4 };
        check::<_, 2, 2>(plane, Start { q: [0.4, -2.0], v: [-1.0, 2.0] }, 0.06);
    }
}

mod kept {
    use super::*;

    #[test]
    fn forty_steps_back_undo_forty_steps() {
        for distance in [
            there_and_back(ANGLES, Gauss::<8>::new, MODERATE, 0.05, 40),
            there_and_back(ANGLES, Gauss::<3>::new, MODERATE, 0.02, 40),
        ] {
            println!("misses the start by {distance:e}");
            assert!(distance <= 1e-14, "misses the start by {distance:e}");
        }
    }

    /// Momentum and position after `STEPS` steps from canonical variables.
    fn flow<F: Scheme<DoublePendulumInAngles>>(scheme: F, [q, p]: [[f64; 2]; 2]) -> [f64; 4] {
        const STEPS: usize = 10;
        // v = M⁻¹ p from the two columns of M.
        let momentum =
            |v: [f64; 2]| *Simulation::new(ANGLES, Rk4::new(0.1)).start(q, v).expect("a start").state().p();
        let [a, b] = [momentum([1.0, 0.0]), momentum([0.0, 1.0])];
        let determinant = a[0] * b[1] - a[1] * b[0];
        let v = [(p[0] * b[1] - p[1] * b[0]) / determinant, (a[0] * p[1] - a[1] * p[0]) / determinant];
        let mut run = Simulation::new(ANGLES, scheme).start(q, v).expect("a start");
        for _ in 0..STEPS {
            run.advance().expect("a step");
        }
        let state = run.state();
        [state.q()[0], state.q()[1], state.p()[0], state.p()[1]]
    }

    /// Largest change of the symplectic form, from differences of fourth order.
    fn defect<F: Scheme<DoublePendulumInAngles> + Copy>(scheme: F) -> f64 {
        const STEP: f64 = 1e-3;
        let start = [MODERATE.q, [1.9, 1.2]];
        let column = |k: usize| -> [f64; 4] {
            let at = |factor: f64| {
                let mut moved = start;
                moved[k / 2][k % 2] += factor * STEP;
                flow(scheme, moved)
            };
            let [near, far] = [[at(1.0), at(-1.0)], [at(2.0), at(-2.0)]];
            core::array::from_fn(|i| {
                (8.0 * (near[0][i] - near[1][i]) - (far[0][i] - far[1][i])) / (12.0 * STEP)
            })
        };
        let columns = [column(0), column(1), column(2), column(3)];
        let form = |a: &[f64; 4], b: &[f64; 4]| a[0] * b[2] + a[1] * b[3] - a[2] * b[0] - a[3] * b[1];
        let mut largest = 0.0_f64;
        for i in 0..4 {
            for j in 0..i {
                let before = if j + 2 == i { 1.0 } else { 0.0 };
                largest = largest.max((form(&columns[j], &columns[i]) - before).abs());
            }
        }
        largest
    }

    /// Differences of fourth order over 1e-3 leave 1e-11, and round-off over 1e-3 as much.
    #[test]
    fn the_symplectic_form() {
        let [two, eight, not] =
            [defect(Gauss::<2>::new(0.1)), defect(Gauss::<8>::new(0.1)), defect(Rk4::new(0.1))];
        println!("{two:e}, {eight:e}; Rk4 {not:e}");
        assert!(not > 1e-5, "vacuous: {not:e}");
        assert!(two <= 1e-9 && eight <= 1e-9, "{two:e}, {eight:e}");
    }
}

/// Springs far too stiff for passes: Newton's iteration takes their place, and is counted.
#[test]
fn newton_takes_over_where_passes_cannot_converge() {
    let spring = StiffSpringPendulum::with_stiffness(1e6);
    let Start { q, v } = spring.horizontal();
    let run = Simulation::new(spring, Gauss::<3>::new(0.01)).start(q, v).expect("a start");
    let mut run = run.with_tally(Statistics::default());
    for _ in 0..20 {
        run.advance().expect("a step of Newton");
    }
    assert_eq!(run.tally().newton_steps, 20, "{:?}", run.tally());
}

/// A bead that is pulled to an end of its rail beyond which the potential has no value.
#[derive(Clone, Copy, MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * m * der(x).powi(2), potential = k * x.sqrt())]
struct Well {
    m: f64,
    k: f64,
}

#[test]
fn a_step_without_solution_leaves_the_state() {
    let mut run =
        Simulation::new(Well { m: 1.0, k: 3.0 }, Gauss::<4>::new(1.0)).start([0.5], [-8.0]).expect("a start");
    let before = run.state().clone();
    let failure = run.advance().map(drop).expect_err("no step beyond the end of the rail");
    println!("{failure}");
    assert!(matches!(failure, StepError::NoSolution { .. } | StepError::Singular { .. }), "{failure}");
    assert_eq!(*run.state(), before);
}
