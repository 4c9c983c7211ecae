//! The methods to compare with: their orders, what they keep, what they share with each other, and what they refuse.

use evi_core::array::Array;
use evi_core::baseline::{Dense, GeneralizedAlpha, ImplicitMidpoint, Rattle, Shake};
use evi_core::generic::{GenericEvi, GenericScheme};
use evi_core::integrator::Statistics;
use evi_core::mechanics::Mechanics;
use evi_core::prelude::*;
use evi_examples::{DoublePendulum, HarmonicOscillator, Pendulum, Start};
use evi_tests::conservation::there_and_back;
use evi_tests::convergence::{check_orders, measure};
use evi_tests::motions::{
    Motion, charged_spherical_pendulum, damped_pendulum, double_pendulum, double_pendulum_in_angles,
    gentle_double_pendulum, kapitza_pendulum, long_double_pendulum_in_angles, modulated_pendulum, pendulum,
    relativistic_bead,
};
use evi_tests::scenes::{DoublePendulumInAngles, MotorisedDoublePendulum, PushedDumbbell};
use evi_tests::{distance, extrapolate_by_hand, largest_difference, observed_order};

/// The double pendulum of unequal masses and lengths, on a swing of moderate size.
fn swing() -> (DoublePendulum, Start<4>) {
    let angles = DoublePendulumInAngles::UNEQUAL;
    let Start { q, v } = DoublePendulumInAngles::MODERATE;
    (angles.constrained(), angles.cartesian(q, v))
}

mod order {
    use super::*;

    /// Slopes of errors over a factor of 16 in step size, at which the next terms of their expansion still show: 0.06 measured.
    const TOLERANCE: f64 = 0.1;

    #[track_caller]
    fn check_slope(quantity: &str, h: &[f64], errors: &[f64]) {
        let order = observed_order(h, errors);
        println!("{} {quantity}: {order:.3}, from {errors:?}", core::panic::Location::caller());
        assert!((order - 2.0).abs() <= TOLERANCE, "order of {quantity} is {order:.3}");
    }

    /// Positions and velocities.
    #[track_caller]
    fn check<S, F>(motion: &Motion<S>, scheme: impl Fn(f64) -> F)
    where
        S: MechanicalSystem + Clone,
        F: Scheme<S>,
    {
        let errors = measure(motion, scheme);
        check_slope("q", &errors.h, &errors.q);
        check_slope("v", &errors.h, &errors.v);
    }

    /// The multipliers of the method itself; those of `measure` are recovered from the states.
    #[track_caller]
    fn check_multipliers<S: MechanicalSystem + Clone>(motion: &Motion<S>, spectral_radius: f64) {
        let (mut h, mut errors) = (Vec::new(), Vec::new());
        for n in motion.steps {
            let step = motion.t / f64::from(n);
            let scheme = GeneralizedAlpha::new(step).spectral_radius(spectral_radius);
            let q = S::PerCoordinate::<f64>::from_fn(|i| motion.q0[i]);
            let v = S::PerCoordinate::<f64>::from_fn(|i| motion.v0[i]);
            let mut run = Simulation::new(motion.system.clone(), scheme).start(q, v).expect("consistent");
            (0..n).for_each(|_| assert!(run.advance().is_ok()));
            let multipliers = run.map().multipliers().expect("a step was taken");
            h.push(step);
            errors.push(distance(multipliers.as_ref(), &motion.multipliers));
        }
        check_slope("multipliers", &h, &errors);
    }

    #[test]
    fn shake() {
        check(&double_pendulum(), Shake::new);
        check(&kapitza_pendulum(), Shake::new);
        check(&modulated_pendulum(), Shake::new);
    }

    #[test]
    fn implicit_midpoint_with_constraints() {
        check(&double_pendulum(), ImplicitMidpoint::new);
        check(&charged_spherical_pendulum(), ImplicitMidpoint::new);
        check(&relativistic_bead(), ImplicitMidpoint::new);
        check(&kapitza_pendulum(), ImplicitMidpoint::new);
    }

    #[test]
    fn implicit_midpoint_without_constraints() {
        check(&pendulum(), ImplicitMidpoint::new);
        check(&double_pendulum_in_angles(), ImplicitMidpoint::new);
        check(&damped_pendulum(), ImplicitMidpoint::new);
        check(&motorised(), ImplicitMidpoint::new);
    }

    #[test]
    fn generalized_alpha_with_constraints() {
        check(&double_pendulum(), GeneralizedAlpha::new);
        check(&charged_spherical_pendulum(), GeneralizedAlpha::new);
        check(&relativistic_bead(), GeneralizedAlpha::new);
        check(&kapitza_pendulum(), GeneralizedAlpha::new);
    }

    #[test]
    fn generalized_alpha_without_constraints() {
        check(&pendulum(), GeneralizedAlpha::new);
        check(&double_pendulum_in_angles(), GeneralizedAlpha::new);
        check(&damped_pendulum(), GeneralizedAlpha::new);
        check(&motorised(), GeneralizedAlpha::new);
    }

    #[test]
    fn generalized_alpha_with_any_spectral_radius() {
        for spectral_radius in [0.0, 0.5, 0.9] {
            check(&finer(double_pendulum()), |h| GeneralizedAlpha::new(h).spectral_radius(spectral_radius));
        }
    }

    #[test]
    fn multipliers_of_generalized_alpha() {
        for spectral_radius in [0.0, 0.5, 0.8, 0.9] {
            check_multipliers(&finer(double_pendulum()), spectral_radius);
        }
        check_multipliers(&finer(charged_spherical_pendulum()), 0.8);
        check_multipliers(&finer(relativistic_bead()), 0.8);
        // In finer steps the round-off of positions, over h², is in the multipliers.
        check_multipliers(&kapitza_pendulum(), 0.8);
    }

    /// In steps a quarter as long: with strong dissipation, and in multipliers, coarse errors are too large to show a slope.
    fn finer<S>(motion: Motion<S>) -> Motion<S> {
        Motion { steps: motion.steps.map(|n| 4 * n), ..motion }
    }

    #[test]
    fn compositions_of_the_implicit_midpoint() {
        let suzuki = |h| ImplicitMidpoint::new(h).composed(Composition::suzuki_4());
        check_orders(&gentle_double_pendulum(), 10, suzuki, 4.0);
        check_orders(&long_double_pendulum_in_angles(), 20, suzuki, 4.0);
    }

    /// Friction and a motor: forces whose derivatives are not symmetric, and a mass that depends on the configuration.
    fn motorised() -> Motion<MotorisedDoublePendulum> {
        let system = MotorisedDoublePendulum::STANDARD;
        let start = DoublePendulumInAngles::MODERATE;
        let acceleration = |t, q: &[f64; 2], v: &[f64; 2]| system.acceleration(t, q, v);
        let (q, v) = extrapolate_by_hand(acceleration, (start.q, start.v), 1.0, 100);
        Motion::new(system, start, 1.0, (&q, &v), 50).without_energy()
    }
}

/// Both runs stay together over 100 steps, to so many roundings of positions and velocities.
#[track_caller]
fn check_same<S, E, F>(system: S, schemes: (E, F), start: Start<4>, positions: f64, velocities: f64)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; 4]> + Clone,
    E: Scheme<S>,
    F: Scheme<S>,
{
    let mut first = Simulation::new(system.clone(), schemes.0).start(start.q, start.v).expect("consistent");
    let mut second = Simulation::new(system, schemes.1).start(start.q, start.v).expect("consistent");
    let (mut q, mut v) = (0.0_f64, 0.0_f64);
    for _ in 0..100 {
        let (a, b) = (first.advance().expect("a step"), second.advance().expect("a step"));
        q = q.max(largest_difference(a.q(), b.q()) / f64::EPSILON);
        v = v.max(largest_difference(a.v(), b.v()) / f64::EPSILON);
    }
    println!("{}: {q:.0} ε in positions, {v:.0} ε in velocities", core::panic::Location::caller());
    assert!(largest_difference(first.state().q(), &start.q) > 0.1, "vacuous: nothing moves");
    assert!(q <= positions && v <= velocities, "{q:.0} ε, {v:.0} ε");
}

mod coincidences {
    use super::*;

    #[test]
    fn shake_has_the_positions_of_rattle_and_velocities_beside_the_constraints() {
        let (system, start) = swing();
        check_same(system, (Shake::new(0.01), Rattle::new(0.01)), start, 256.0, f64::INFINITY);
        // ½(v₋ + v₊) differs from the projected velocity by a multiple of M⁻¹Gᵀ alone, of second order.
        let differences = [0.02, 0.01, 0.005, 0.0025].map(|h| {
            let mut shake = Simulation::new(system, Shake::new(h)).start(start.q, start.v).unwrap();
            let mut rattle = Simulation::new(system, Rattle::new(h)).start(start.q, start.v).unwrap();
            shake.advance_to(0.4).unwrap();
            rattle.advance_to(0.4).unwrap();
            let hidden = shake.mechanics().hidden_constraint_residual(shake.state());
            assert!(hidden.iter().any(|residual| *residual > 1e-7), "{hidden:?}");
            largest_difference(shake.state().v(), rattle.state().v())
        });
        let order = observed_order(&[0.02, 0.01, 0.005, 0.0025], &differences);
        println!("{order:.3}: {differences:?}");
        assert!((order - 2.0).abs() <= 0.1, "{order}");
    }

    #[test]
    fn shake_from_any_state_starts_afresh() {
        let (system, start) = swing();
        let mut one = Simulation::new(system, Shake::new(0.01)).start(start.q, start.v).unwrap();
        one.advance_to(0.3).unwrap();
        let state = one.state().clone();
        let mut map = Shake::new(0.01).prepare(Mechanics::new(&system)).unwrap();
        let mut restarted = state.clone();
        map.advance(&mut restarted, &mut ()).unwrap();
        one.advance().unwrap();
        // The half kick brings back v₊, but for round-off.
        let difference = largest_difference(one.state().q(), restarted.q()) / f64::EPSILON;
        println!("{difference:.0} ε");
        assert!(difference <= 8.0, "{difference:.0} ε");
    }

    #[test]
    fn implicit_midpoint_is_the_variational_one_where_the_momentum_is_a_constant_mass_times_velocity() {
        let pendulum = Pendulum { m: 1.3, l: 0.9, g: 9.81 };
        let mut midpoint =
            Simulation::new(pendulum, ImplicitMidpoint::new(0.02)).start([1.0], [0.4]).unwrap();
        let mut variational = Simulation::new(pendulum, Evi::midpoint(0.02)).start([1.0], [0.4]).unwrap();
        let (a, b) = (midpoint.advance_to(2.0).unwrap(), variational.advance_to(2.0).unwrap());
        let difference =
            largest_difference(a.q(), b.q()).max(largest_difference(a.v(), b.v())) / f64::EPSILON;
        println!("{difference:.0} ε");
        assert!(difference <= 64.0, "{difference:.0} ε");
    }

    #[test]
    fn implicit_midpoint_differs_where_the_mass_depends_on_the_configuration() {
        let Start { q, v } = DoublePendulumInAngles::MODERATE;
        let system = DoublePendulumInAngles::UNEQUAL;
        let mut midpoint = Simulation::new(system, ImplicitMidpoint::new(0.01)).start(q, v).unwrap();
        let mut variational = Simulation::new(system, Evi::midpoint(0.01)).start(q, v).unwrap();
        let (a, b) = (midpoint.advance_to(1.0).unwrap(), variational.advance_to(1.0).unwrap());
        assert!(largest_difference(a.q(), b.q()) > 1e-6);
    }

    #[test]
    fn the_scenes_elimination_solves_what_the_dense_one_solves() {
        let (system, start) = swing();
        let mut own = Simulation::new(system, GeneralizedAlpha::new(0.01)).start(start.q, start.v).unwrap();
        let dense = Simulation::new(Dense(system), GeneralizedAlpha::new(0.01));
        let mut dense = dense.start(start.q, start.v).unwrap();
        let (a, b) = (own.advance_to(1.0).unwrap(), dense.advance_to(1.0).unwrap());
        let difference = largest_difference(a.q(), b.q()) / f64::EPSILON;
        println!("{difference:.0} ε");
        assert!(difference <= 1024.0, "{difference:.0} ε");
    }
}

mod kept {
    use super::*;

    /// Largest `|φ|` and `|G v|` along a run of 10 units of time.
    fn residuals<F: Scheme<DoublePendulum>>(scheme: F) -> [f64; 2] {
        let (system, start) = swing();
        let mut run = Simulation::new(system, scheme).start(start.q, start.v).unwrap();
        let mut largest = [0.0_f64; 2];
        while run.state().t() < 10.0 {
            run.advance().expect("a step");
            let (mechanics, state) = (run.mechanics(), run.state());
            let of = [mechanics.constraint_residual(state), mechanics.hidden_constraint_residual(state)];
            for (largest, residuals) in largest.iter_mut().zip(of) {
                *largest = residuals.iter().fold(*largest, |x, residual| x.max(residual.abs()));
            }
        }
        println!("{}: {largest:?}", core::any::type_name::<F>());
        largest
    }

    #[test]
    fn each_method_keeps_the_constraints_that_it_solves() {
        let [positions, velocities] = residuals(Shake::new(0.01));
        // Squares of coordinates up to 2, measured: 1.3e-15. The hidden constraints are off by O(h²).
        assert!(positions <= 4e-15 && (1e-5..1e-2).contains(&velocities));
        let [positions, velocities] = residuals(GeneralizedAlpha::new(0.01));
        assert!(positions <= 4e-15 && (1e-5..1e-2).contains(&velocities));
        // Quadratic constraints: G v is a quadratic first integral, kept but for the round-off of 1,000 steps; φ drifts.
        let [positions, velocities] = residuals(ImplicitMidpoint::new(0.01));
        assert!((1e-5..1e-1).contains(&positions) && velocities <= 1e-11);
    }

    #[test]
    fn implicit_midpoint_is_reversible() {
        let Start { q, v } = DoublePendulumInAngles::MODERATE;
        let angles = DoublePendulumInAngles::UNEQUAL;
        let distance = there_and_back(angles, ImplicitMidpoint::new, Start { q, v }, 0.01, 200);
        // The motion is chaotic: round-off of 400 steps, 1.1e-13 measured.
        assert!(distance <= 1e-12);
        // With constraints the turning point is no start, since φ has drifted: maps take the steps.
        let (system, start) = swing();
        let mut run = Simulation::new(system, ImplicitMidpoint::new(0.01)).start(start.q, start.v).unwrap();
        let first = run.state().clone();
        let mut state = run.advance_to(2.0).unwrap().clone();
        let mut back = ImplicitMidpoint::new(-0.01).prepare(Mechanics::new(&system)).unwrap();
        for _ in 0..run.steps() {
            back.advance(&mut state, &mut ()).expect("a step back");
        }
        let distance = largest_difference(state.q(), first.q()).max(largest_difference(state.v(), first.v()));
        println!("{distance:e}");
        assert!(distance <= 1e-12);
    }

    /// Largest position and velocity times h of an oscillator after steps that do not resolve it at all.
    fn unresolved<F: Scheme<HarmonicOscillator>>(scheme: F, h: f64, steps: usize) -> f64 {
        let oscillator = HarmonicOscillator { m: 2.0, k: 2e8 };
        let mut run = Simulation::new(oscillator, scheme).start([1.0], [0.0]).unwrap();
        (0..steps).for_each(|_| assert!(run.advance().is_ok()));
        run.state().q()[0].abs().max(h * run.state().v()[0].abs())
    }

    #[test]
    fn generalized_alpha_damps_what_it_does_not_resolve_by_its_spectral_radius() {
        // h ω = 1000.
        let h = 0.1;
        for radius in [0.5, 0.8] {
            let scheme = || GeneralizedAlpha::new(h).spectral_radius(radius);
            let (early, late) = (unresolved(scheme(), h, 40), unresolved(scheme(), h, 80));
            let rate = (late / early).powf(1.0 / 40.0);
            println!("{rate:.3} per step at ρ = {radius}");
            // Eigenvalues of −ρ that are defective: ρⁿ times a polynomial in n.
            assert!((rate / radius - 1.0).abs() <= 0.06, "{rate:.3} per step");
        }
        assert!(unresolved(ImplicitMidpoint::new(h), h, 80) > 0.5);
    }
}

mod efficiency {
    use super::*;

    /// Mean number of Newton corrections over a motion.
    #[track_caller]
    fn check<S, F>(motion: &Motion<S>, scheme: impl Fn(f64) -> F, bound: f64)
    where
        S: MechanicalSystem + Clone,
        F: Scheme<S>,
    {
        let n = motion.steps[2];
        let q = S::PerCoordinate::<f64>::from_fn(|i| motion.q0[i]);
        let v = S::PerCoordinate::<f64>::from_fn(|i| motion.v0[i]);
        let simulation = Simulation::new(motion.system.clone(), scheme(motion.t / f64::from(n)));
        let mut run = simulation.start(q, v).expect("consistent").with_tally(Statistics::default());
        (0..n).for_each(|_| assert!(run.advance().is_ok()));
        let mean = run.tally().corrections as f64 / f64::from(n);
        println!("{}: {mean:.2} in {n} steps", core::panic::Location::caller());
        assert!(mean <= bound, "{mean:.2} corrections per step");
    }

    #[test]
    fn two_or_three_corrections_do() {
        // From 2.0 to 3.0 measured: a wrong or missing derivative would take 5 or more.
        check(&double_pendulum(), Rattle::new, 2.1);
        check(&double_pendulum(), Shake::new, 2.1);
        check(&double_pendulum(), ImplicitMidpoint::new, 2.6);
        check(&charged_spherical_pendulum(), ImplicitMidpoint::new, 3.1);
        check(&relativistic_bead(), ImplicitMidpoint::new, 2.6);
        check(&double_pendulum_in_angles(), ImplicitMidpoint::new, 2.1);
        check(&damped_pendulum(), ImplicitMidpoint::new, 2.1);
        check(&double_pendulum(), GeneralizedAlpha::new, 2.6);
        check(&charged_spherical_pendulum(), GeneralizedAlpha::new, 3.1);
        check(&relativistic_bead(), GeneralizedAlpha::new, 2.6);
        check(&double_pendulum_in_angles(), GeneralizedAlpha::new, 2.1);
        check(&damped_pendulum(), GeneralizedAlpha::new, 2.1);
    }
}

mod refusals {
    use super::*;

    #[track_caller]
    fn check_step_fails_and_leaves_the_state<F: Scheme<DoublePendulum>>(scheme: F) {
        let pendulum = DoublePendulum::UNIT;
        let start = pendulum.horizontal();
        let mut run = Simulation::new(pendulum, scheme).start(start.q, start.v).unwrap();
        let error = loop {
            let before = run.state().clone();
            if let Err(error) = run.advance() {
                assert_eq!(*run.state(), before);
                assert!(run.advance().is_err(), "a step that failed fails again");
                break error;
            }
            assert!(run.steps() < 1_000, "never fails");
        };
        println!("{}: {error}", core::panic::Location::caller());
    }

    #[test]
    fn a_step_without_a_solution() {
        check_step_fails_and_leaves_the_state(Shake::new(0.4));
        // Finds some end of nearly every step; over one of 1e100 none is on the constraints.
        check_step_fails_and_leaves_the_state(GeneralizedAlpha::new(1e100));
        check_step_fails_and_leaves_the_state(ImplicitMidpoint::new(2.0));
    }

    #[track_caller]
    fn check_refused<S: MechanicalSystem, F: Scheme<S>>(system: S, scheme: F, message: &str) {
        match scheme.prepare(Mechanics::new(&system)) {
            Ok(_) => panic!("accepted"),
            Err(error) => assert!(error.to_string().contains(message), "{error}"),
        }
    }

    #[test]
    fn schemes() {
        for h in [0.0, f64::NAN, f64::INFINITY, 1e160, -1e-160] {
            check_refused(DoublePendulum::UNIT, Shake::new(h), "step size");
            check_refused(DoublePendulum::UNIT, ImplicitMidpoint::new(h), "step size");
            check_refused(DoublePendulum::UNIT, GeneralizedAlpha::new(h), "step size");
        }
        for radius in [1.0, -0.1, f64::NAN] {
            let scheme = GeneralizedAlpha::new(0.01).spectral_radius(radius);
            check_refused(DoublePendulum::UNIT, scheme, "in [0, 1)");
        }
        check_refused(
            DoublePendulumInAngles::UNEQUAL,
            Shake::new(0.01),
            "SHAKE needs a constant mass matrix",
        );
        check_refused(PushedDumbbell::STANDARD, Shake::new(0.01), "do not depend on velocities");
    }
}

mod generic {
    use super::*;

    /// The generic path takes the steps of the specialised one.
    #[track_caller]
    fn check<const N: usize>(composition: Composition<N>) {
        let (system, start) = swing();
        let scheme = GenericEvi::midpoint(0.05).composed(composition);
        let mut generic = scheme.start(system, &start.q, &start.v).expect("consistent");
        let scheme = Evi::midpoint(0.05).composed(composition);
        let mut specialised = Simulation::new(system, scheme).start(start.q, start.v).expect("consistent");
        assert_eq!(generic.h(), 0.05);
        generic.advance_to(2.0).expect("every stage");
        let state = specialised.advance_to(2.0).expect("every stage");
        assert_eq!((generic.t(), generic.steps()), (state.t(), 40));
        let difference =
            largest_difference(generic.q(), state.q()).max(largest_difference(generic.v(), state.v()));
        println!("{}: {:.0} ε", core::panic::Location::caller(), difference / f64::EPSILON);
        assert!(difference <= 1024.0 * f64::EPSILON, "{difference:e}");
        // Another scheme than the stages' own.
        assert!(largest_difference(state.q(), &start.q) > 0.1);
    }

    #[test]
    fn compositions_are_those_of_the_specialised_path() {
        check(Composition::suzuki_4());
        check(Composition::yoshida_6());
        check(Composition::kahan_li_8());
    }

    #[test]
    fn a_stage_that_fails_leaves_the_run_where_it_stood() {
        let pendulum = DoublePendulum::UNIT;
        let start = pendulum.horizontal();
        let scheme = GenericEvi::midpoint(1.0).composed(Composition::triple_jump_4());
        let mut run = scheme.start(pendulum, &start.q, &start.v).expect("consistent");
        let error = loop {
            let before = (run.t(), run.q().to_vec(), run.v().to_vec(), run.steps());
            if let Err(error) = run.advance() {
                assert_eq!(before, (run.t(), run.q().to_vec(), run.v().to_vec(), run.steps()));
                break error;
            }
            assert!(run.steps() < 1_000, "never fails");
        };
        assert!(matches!(error, StepError::NoSolution { .. }), "{error}");
    }

    #[test]
    fn nodes_that_do_not_mirror_each_other_are_refused() {
        let left = Quadrature::interpolatory([0.0]).expect("a rule");
        let start = DoublePendulum::UNIT.horizontal();
        let refused = |scheme: GenericEvi| scheme.start(DoublePendulum::UNIT, &start.q, &start.v).err();
        assert_eq!(refused(GenericEvi::new(&left, 0.01)), None);
        let composed = GenericEvi::new(&left, 0.01).composed(Composition::suzuki_4());
        let error = refused(composed);
        assert!(
            matches!(error, Some(StartError::Scheme(SchemeError::AsymmetricNodes { node: 0, .. }))),
            "{error:?}"
        );
    }
}
