//! Orders of the methods to compare with.

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
