//! Galerkin integrators: their orders, what they are for one interval, and what they keep.

use evi_core::baseline::Rattle;
use evi_core::generic::GenericSystem;
use evi_core::prelude::*;
use evi_core::scheme::NodalCurves;
use evi_examples::{AndrewsSqueezer, CarAxis, DoublePendulum, DrivenPendulum, SphericalPendulum, Start};
use evi_tests::conservation::{angular_momentum, largest_change, largest_residuals, there_and_back};
use evi_tests::convergence::check_orders;
use evi_tests::galerkin::GalerkinAction;
use evi_tests::motions::{
    Motion, charged_spherical_pendulum, damped_pendulum, gentle_double_pendulum, kapitza_pendulum,
    long_charged_spherical_pendulum, long_double_pendulum_in_angles, modulated_pendulum, relativistic_bead,
};
use evi_tests::references::{self, Certified};
use evi_tests::scenes::{
    ChargedSphericalPendulum, DoublePendulumInAngles, Dumbbell, KapitzaPendulum, RelativisticBead,
};
use evi_tests::tangent::{TangentSpace, symplectic_defect};
use evi_tests::{distance, largest_difference};

/// The double pendulum of unequal masses and lengths, on a swing of moderate size.
fn swing() -> (DoublePendulum, Start<4>) {
    let angles = DoublePendulumInAngles::UNEQUAL;
    let Start { q, v } = DoublePendulumInAngles::MODERATE;
    (angles.constrained(), angles.cartesian(q, v))
}

mod order {
    use super::*;

    #[test]
    fn polynomials_on_the_constrained_double_pendulum() {
        check_orders(&gentle_double_pendulum(), 400, Galerkin::<1>::new, 2.0);
        check_orders(&gentle_double_pendulum(), 8, Galerkin::<2>::new, 4.0);
        check_orders(&gentle_double_pendulum(), 4, Galerkin::<3>::new, 6.0);
        check_orders(&gentle_double_pendulum(), 4, Galerkin::<4>::new, 8.0);
    }

    #[test]
    fn mixed_curves_on_the_constrained_double_pendulum() {
        let motion = gentle_double_pendulum();
        check_orders(&motion, 400, |h| Galerkin::<1>::new(h).frequency(3.13), 2.0);
        check_orders(&motion, 8, |h| Galerkin::<2>::new(h).frequency(3.13), 4.0);
        check_orders(&motion, 4, |h| Galerkin::<3>::new(h).frequency(3.13), 6.0);
        check_orders(&motion, 4, |h| Galerkin::<3>::new(h).frequency(Frequency::Hyperbolic(2.5)), 6.0);
        check_orders(&motion, 4, |h| Galerkin::<3>::new(h).frequencies(PER_COORDINATE), 6.0);
    }

    /// All kinds of curves.
    const PER_COORDINATE: [Frequency; 4] = [
        Frequency::Trigonometric(3.13),
        Frequency::Hyperbolic(2.0),
        Frequency::ZERO,
        Frequency::Trigonometric(5.0),
    ];

    #[test]
    fn configuration_dependent_mass() {
        check_orders(&long_double_pendulum_in_angles(), 8, Galerkin::<3>::new, 6.0);
        check_orders(&long_double_pendulum_in_angles(), 8, |h| Galerkin::<2>::new(h).frequency(2.0), 4.0);
    }

    #[test]
    fn gyroscopic_coupling_with_a_constraint() {
        check_orders(&charged_spherical_pendulum(), 4, Galerkin::<3>::new, 6.0);
        check_orders(&charged_spherical_pendulum(), 4, |h| Galerkin::<2>::new(h).frequency(2.0), 4.0);
    }

    /// On this motion the errors of ten powers of `h` settle above round-off; on the double pendulum they change sign until there.
    #[test]
    fn five_intervals() {
        check_orders(&long_charged_spherical_pendulum(), 8, Galerkin::<5>::new, 10.0);
    }

    #[test]
    fn not_quadratic_in_velocity_with_a_constraint() {
        check_orders(&relativistic_bead(), 4, Galerkin::<2>::new, 4.0);
        check_orders(&relativistic_bead(), 4, |h| Galerkin::<2>::new(h).frequency(2.0), 4.0);
    }

    #[test]
    fn moving_constraint() {
        check_orders(&kapitza_pendulum(), 20, Galerkin::<3>::new, 6.0);
        check_orders(&kapitza_pendulum(), 20, |h| Galerkin::<2>::new(h).frequency(3.0), 4.0);
    }

    #[test]
    fn time_dependent_lagrangians() {
        check_orders(&modulated_pendulum(), 6, Galerkin::<3>::new, 6.0);
        check_orders(&damped_pendulum(), 6, |h| Galerkin::<3>::new(h).frequency(3.0), 6.0);
    }

    /// Drag and a drive that depends on time, with a constraint.
    #[test]
    fn forces() {
        let system = DrivenPendulum::STANDARD;
        let motion = Motion::certified(system, system.horizontal(), references::DRIVEN_PENDULUM, 50);
        let motion = Motion { multipliers: Vec::new(), ..motion.without_energy() };
        check_orders(&motion, 4, Galerkin::<2>::new, 4.0);
        check_orders(&motion, 4, Galerkin::<3>::new, 6.0);
        check_orders(&motion, 4, |h| Evi::midpoint(h).composed(Composition::kahan_li_6()), 6.0);
    }

    #[test]
    fn a_composition_raises_the_order_of_one_interval() {
        let scheme = |h| Galerkin::<1>::new(h).frequency(3.13).composed(Composition::kahan_li_6());
        check_orders(&gentle_double_pendulum(), 10, scheme, 6.0);
    }
}

/// The members that have other names.
mod one_interval {
    use super::*;

    #[track_caller]
    fn check_same<F: Scheme<DoublePendulum>, G: Scheme<DoublePendulum>>(one: F, other: G) {
        let (system, start) = swing();
        let end = |state: &State<DoublePendulum>| [*state.q(), *state.v()].concat();
        let mut run = Simulation::new(system, one).start(start.q, start.v).expect("a start");
        let one = end(run.advance_to(1.0).expect("every step"));
        let mut run = Simulation::new(system, other).start(start.q, start.v).expect("a start");
        let difference = largest_difference(&one, &end(run.advance_to(1.0).expect("every step")));
        println!("{}: difference {difference:e}", core::panic::Location::caller());
        // 32 roundings of velocities of size 4, as for the coincidences of order 2.
        assert!(difference <= 32.0 * 4.0 * f64::EPSILON, "differ by {difference:e}");
    }

    #[test]
    fn is_rattle() {
        check_same(Galerkin::<1>::new(0.01), Rattle::new(0.01));
    }

    #[test]
    fn is_the_exponential_integrator_on_the_trapezoidal_rule() {
        let trapezoid = Evi::new(Quadrature::<2>::lobatto(), 0.01);
        check_same(Galerkin::<1>::new(0.01).frequency(3.13), trapezoid.frequency(3.13));
        let hyperbolic = Frequency::Hyperbolic(2.5);
        check_same(Galerkin::<1>::new(0.01).frequency(hyperbolic), trapezoid.frequency(hyperbolic));
        let each = [3.13.into(), hyperbolic, Frequency::ZERO, 5.0.into()];
        check_same(Galerkin::<1>::new(0.01).frequencies(each), trapezoid.frequencies(each));
    }
}

mod kept {
    use super::*;

    /// 64 roundings of velocities of size 4 (8.9e-16), after 100 steps.
    const ROUND_OFF: f64 = 64.0 * 4.0 * f64::EPSILON;

    #[track_caller]
    fn check_returns<S, F, const N: usize>(system: S, start: Start<N>, scheme: impl Fn(f64) -> F, h: f64)
    where
        S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Clone,
        F: Scheme<S>,
    {
        let distance = there_and_back(system, scheme, start, h, 50);
        assert!(distance <= ROUND_OFF, "misses the start by {distance:e}");
    }

    #[test]
    fn a_step_back_undoes_a_step() {
        let (system, start) = swing();
        check_returns(system, start, Galerkin::<2>::new, 0.02);
        check_returns(system, start, Galerkin::<5>::new, 0.02);
        check_returns(system, start, Galerkin::<8>::new, 0.05);
        check_returns(system, start, |h| Galerkin::<1>::new(h).frequency(3.13), 0.02);
        check_returns(system, start, |h| Galerkin::<3>::new(h).frequency(3.13), 0.02);
        let angles = DoublePendulumInAngles::UNEQUAL;
        check_returns(angles, DoublePendulumInAngles::MODERATE, Galerkin::<4>::new, 0.02);
        let charged = ChargedSphericalPendulum::STANDARD;
        check_returns(charged, charged.one_radian(), Galerkin::<3>::new, 0.02);
        let bead = RelativisticBead::STANDARD;
        check_returns(bead, RelativisticBead::at_angle(1.0, -2.0), Galerkin::<3>::new, 0.02);
        let moving = KapitzaPendulum::STANDARD;
        check_returns(moving, moving.near_inverted(), Galerkin::<3>::new, 0.002);
    }

    #[test]
    fn constraints_and_angular_momentum() {
        const STEPS: usize = 10_000;
        /// Momenta of size 4 on an arm of 1, rounded at random in each of 10⁴ steps: `ε · 4 · √10⁴`.
        const LONG_ROUND_OFF: f64 = 4.0 * 100.0 * f64::EPSILON;
        let system = SphericalPendulum::UNIT;
        let start = system.one_radian();
        let polynomial = Galerkin::<3>::new(0.05);
        let mixed = Galerkin::<2>::new(0.05).frequency(2.0);
        for change in [
            largest_change(system, polynomial, start, STEPS, |q, p| angular_momentum(q, p, 0)),
            largest_change(system, mixed, start, STEPS, |q, p| angular_momentum(q, p, 0)),
        ] {
            assert!(change <= LONG_ROUND_OFF, "angular momentum changes by {change:e}");
        }
        let (double, swing) = swing();
        for [constraint, hidden] in [
            largest_residuals(system, polynomial, start, STEPS),
            largest_residuals(system, mixed, start, STEPS),
            largest_residuals(double, polynomial, swing, STEPS),
            largest_residuals(double, Galerkin::<5>::new(0.05), swing, STEPS),
        ] {
            // 5 ε and 0.9 ε measured.
            assert!(constraint <= 8.0 * f64::EPSILON, "φ: {constraint:e}");
            assert!(hidden <= 4.0 * f64::EPSILON, "G v: {hidden:e}");
        }
    }

    /// Constants are among the curves from two intervals on, whatever the frequency.
    #[test]
    fn linear_momentum_of_a_free_dumbbell() {
        /// Momenta of size 6, rounded at random in each of 200 steps: `ε · 6 · √200`.
        const ROUND_OFF: f64 = 6.0 * 14.2 * f64::EPSILON;
        #[track_caller]
        fn change<F: Scheme<Dumbbell> + Copy>(scheme: F) -> f64 {
            let system = Dumbbell::STANDARD;
            let along = |i: usize| {
                let momentum = move |_: &[f64], p: &[f64]| p[i] + p[2 + i];
                largest_change(system, scheme, system.turning(), 200, momentum)
            };
            along(0).max(along(1))
        }
        assert!(change(Galerkin::<1>::new(0.05)) <= ROUND_OFF);
        assert!(change(Galerkin::<3>::new(0.05)) <= ROUND_OFF);
        assert!(change(Galerkin::<8>::new(0.05)) <= ROUND_OFF);
        assert!(change(Galerkin::<2>::new(0.05).frequency(3.0)) <= ROUND_OFF);
        assert!(change(Galerkin::<3>::new(0.05).frequency(3.0)) <= ROUND_OFF);
        assert!(change(Galerkin::<4>::new(0.05).frequency(Frequency::Hyperbolic(3.0))) <= ROUND_OFF);
        // Known property of one interval: cos and sin alone contain no constant.
        let lost = change(Galerkin::<1>::new(0.05).frequency(3.0));
        assert!(lost > 0.1, "changes by {lost:e} only");
    }

    /// One step against an action of the test's own, and the form under its derivative; `P` nodes for `K` intervals.
    #[track_caller]
    fn check_symplectic<S, F, const K: usize, const P: usize, const N: usize>(
        system: S,
        scheme: Galerkin<K, F>,
        frequencies: [f64; N],
        start: Start<N>,
    ) where
        S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + GenericSystem + Clone,
        F: NodalCurves<S> + Clone,
    {
        let action = GalerkinAction::new::<P, N>(frequencies, scheme.step_size());
        let mut run = Simulation::new(system.clone(), scheme).start(start.q, start.v).expect("a start");
        let before = TangentSpace::at(&system, run.state()).momentum;
        let mut after = before.clone();
        for _ in 0..3 {
            let state = run.state().clone();
            let end = run.advance().expect("a step");
            let step = action.step(&system, &state, end);
            let difference = largest_difference(&step.q, end.q());
            println!("{}: off by {difference:e}", core::panic::Location::caller());
            // Newton's iteration of two programs: 3 ε measured; from the raw functions of three intervals 50 ε.
            assert!(difference <= 128.0 * f64::EPSILON, "{difference:e}");
            after = step.tangent_map * after;
        }
        let roundings = symplectic_defect(&before, &after);
        // 15 measured, where the mass depends on the configuration.
        assert!(roundings <= 32.0, "the form changes by {roundings:.0} roundings");
    }

    #[test]
    fn the_symplectic_form() {
        const H: f64 = 0.05;
        let (system, start) = swing();
        check_symplectic::<_, _, 1, 2, 4>(system, Galerkin::new(H), [0.0; 4], start);
        check_symplectic::<_, _, 2, 3, 4>(system, Galerkin::new(H), [0.0; 4], start);
        check_symplectic::<_, _, 3, 4, 4>(system, Galerkin::new(H), [0.0; 4], start);
        check_symplectic::<_, _, 1, 2, 4>(system, Galerkin::new(H).frequency(3.13), [3.13; 4], start);
        // Phases of about 1: for smaller ones the raw functions of the test lose digits.
        let curves = [20.0, 0.0, 25.0, 30.0];
        let frequencies = curves.map(Frequency::Trigonometric);
        check_symplectic::<_, _, 2, 3, 4>(system, Galerkin::new(H).frequencies(frequencies), curves, start);
        check_symplectic::<_, _, 3, 4, 4>(system, Galerkin::new(H).frequencies(frequencies), curves, start);
        let charged = ChargedSphericalPendulum::STANDARD;
        check_symplectic::<_, _, 2, 3, 3>(charged, Galerkin::new(H), [0.0; 3], charged.one_radian());
        let angles = DoublePendulumInAngles::UNEQUAL;
        let moderate = DoublePendulumInAngles::MODERATE;
        check_symplectic::<_, _, 3, 4, 2>(angles, Galerkin::new(H), [0.0; 2], moderate);
    }
}

mod frequencies {
    use super::*;

    /// The distance to the polynomial result is `c u²`, from `u = 0.01` down to where round-off hides it: a table with 0/0 in it
    /// would show as noise.
    #[track_caller]
    fn check_continuity<const K: usize>(frequency: fn(f64) -> Frequency) {
        const H: f64 = 0.1;
        let (system, start) = swing();
        let end = |omega: f64| {
            let scheme = Galerkin::<K>::new(H).frequency(frequency(omega));
            let mut run = Simulation::new(system, scheme).start(start.q, start.v).expect("a start");
            let state = run.advance_to(1.0).expect("every step");
            [*state.q(), *state.v()].concat()
        };
        let mut run =
            Simulation::new(system, Galerkin::<K>::new(H)).start(start.q, start.v).expect("a start");
        let state = run.advance_to(1.0).expect("every step");
        let limit = [*state.q(), *state.v()].concat();
        let constant = distance(&end(1e-2 / H), &limit) / 1e-4;
        println!("K = {K}: {constant:e} u²");
        assert!(constant > 1e-7, "vacuous: the frequency has no effect");
        for exponent in 2..=12 {
            let u = 10.0_f64.powi(-exponent);
            let deviation = (distance(&end(u / H), &limit) - constant * u * u).abs();
            // The term of order u⁴, and the round-off of two runs.
            let allowed = 0.01 * constant * u * u + 3e-14;
            assert!(deviation <= allowed, "at u = {u:e} off by {deviation:e}");
        }
    }

    #[test]
    fn small_frequencies_tend_to_polynomials_without_noise() {
        check_continuity::<1>(Frequency::Trigonometric);
        check_continuity::<2>(Frequency::Trigonometric);
        check_continuity::<3>(Frequency::Trigonometric);
        check_continuity::<3>(Frequency::Hyperbolic);
    }

    fn refusal<const K: usize>(scheme: Galerkin<K, Frequency>) -> SchemeError {
        let (system, start) = swing();
        match Simulation::new(system, scheme).start(start.q, start.v) {
            Err(StartError::Scheme(error)) => error,
            Err(error) => panic!("{error}"),
            Ok(_) => panic!("accepted"),
        }
    }

    #[test]
    fn that_define_no_step_are_refused() {
        const PI: f64 = core::f64::consts::PI;
        let scheme = |u: f64| Galerkin::<1>::new(0.1).frequency(u / 0.1);
        for (u, name) in
            [(PI, "determinant"), (0.5 * PI, "inertia"), (6.0, "limit"), (-1.0, "sign"), (f64::NAN, "NaN")]
        {
            let error = refusal(scheme(u));
            println!("{error}");
            let expected = match name {
                "determinant" => {
                    matches!(error, SchemeError::IndeterminateCurve { coordinate: 0, determinant, .. } if determinant.abs() < 1e-15)
                }
                "inertia" => {
                    matches!(error, SchemeError::VanishingInertia { kinetic_coefficient, .. } if kinetic_coefficient.abs() < 1e-15)
                }
                "limit" => matches!(error, SchemeError::UnresolvedFrequency { .. }),
                _ => matches!(error, SchemeError::Frequency { .. }),
            };
            assert!(expected, "{name}: {error}");
        }
        // With inner points the same frequencies define steps.
        let (system, start) = swing();
        for u in [0.5 * PI, PI] {
            let scheme = Galerkin::<3>::new(0.1).frequency(u / 0.1);
            assert!(Simulation::new(system, scheme).start(start.q, start.v).is_ok());
        }
    }
}

#[test]
fn a_step_without_solution_leaves_the_state() {
    let system = DoublePendulum::UNIT;
    let Start { q, v } = system.horizontal();
    let mut run = Simulation::new(system, Galerkin::<3>::new(0.4)).start(q, v).expect("a start");
    let mut last = run.state().clone();
    let failure = loop {
        match run.advance() {
            Ok(state) => last = state.clone(),
            Err(failure) => break failure,
        }
        assert!(run.steps() < 1_000, "vacuous: every step has a solution");
    };
    println!("after {} steps: {failure}", run.steps());
    assert!(matches!(failure, StepError::NoSolution { .. }), "{failure}");
    assert_eq!(*run.state(), last);
    let again = run.advance().expect_err("nothing has changed");
    assert_eq!(again.to_string(), failure.to_string());
}

/// Positions and velocities against certified digits, on the two scenes of the test set.
mod certified {
    use super::*;

    #[track_caller]
    fn check<S, F, const N: usize>(system: S, start: Start<N>, end: Certified, scheme: F, bound: f64)
    where
        S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
        F: Scheme<S>,
    {
        let mut run =
            Simulation::new(system, scheme).start_projected(0.0, start.q, start.v).expect("a start");
        let state = run.advance_to(end.t).expect("every step").clone();
        let at_end = run.mechanics().acceleration(end.t, state.q(), state.v()).expect("a regular end");
        let [constraint, hidden] =
            [run.mechanics().constraint_residual(&state), run.mechanics().hidden_constraint_residual(&state)]
                .map(|residuals| residuals.as_ref().iter().fold(0.0_f64, |largest, x| largest.max(x.abs())));
        let relative =
            |x: &[f64], exact: &[f64]| distance(x, exact) / distance(exact, &vec![0.0; exact.len()]);
        let errors = [
            relative(state.q(), end.q),
            relative(state.v(), end.v),
            relative(at_end.multipliers.as_ref(), end.multipliers),
        ];
        println!(
            "{}: after {}: {errors:?}, φ {constraint:e}, G v {hidden:e}",
            core::panic::Location::caller(),
            end.t
        );
        assert!(errors.iter().all(|error| *error <= bound), "{errors:?}");
        // Squares of coordinates of size 1: 2 ε measured. The hidden constraints of the car axis feel a rounding of the time at the
        // end, 2 ε, times the accelerations of its road, where the stages of a composition end beside it: 9 ε measured.
        assert!(
            constraint <= 4.0 * f64::EPSILON && hidden <= 16.0 * f64::EPSILON,
            "{constraint:e}, {hidden:e}"
        );
    }

    #[test]
    fn car_axis() {
        let (system, start) = (CarAxis::STANDARD, CarAxis::STANDARD.standard_start());
        for end in references::CAR_AXIS {
            check(system, start, end, Galerkin::<3>::new(0.0025), 1e-9);
            check(system, start, end, Galerkin::<5>::new(0.01), 1e-9);
            check(system, start, end, Evi::midpoint(0.005).composed(Composition::kahan_li_8()), 1e-9);
        }
    }

    #[test]
    fn andrews_squeezer() {
        let (system, start) = (AndrewsSqueezer::STANDARD, AndrewsSqueezer::STANDARD.standard_start());
        for end in references::ANDREWS_SQUEEZER {
            check(system, start, end, Galerkin::<4>::new(5e-5), 1e-12);
            check(system, start, end, Evi::midpoint(5e-5).composed(Composition::kahan_li_8()), 1e-12);
        }
    }
}
