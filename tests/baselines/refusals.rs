//! What each method refuses.

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
    check_refused(DoublePendulumInAngles::UNEQUAL, Shake::new(0.01), "SHAKE needs a constant mass matrix");
    check_refused(PushedDumbbell::STANDARD, Shake::new(0.01), "do not depend on velocities");
}
