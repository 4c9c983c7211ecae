//! Steps that are not found, and times that no steps lead to.

use super::*;

/// The double pendulum from the horizontal at a step that is too large: the equations of the step lose their
/// solution (two quadratics in two multipliers without a common root), after a number of steps that is the
/// motion's own.
#[track_caller]
fn check_no_solution(scheme: impl Scheme<DoublePendulum>, steps: u64) {
    let horizontal = DOUBLE.horizontal();
    let (run, error) = failed_run(DOUBLE, scheme, horizontal.q, horizontal.v, steps + 1);
    assert_eq!(run.steps(), steps);
    let StepError::NoSolution { t, corrections, last_correction, constraint_residual, smallest_pivot_ratio } =
        error
    else {
        panic!("{error:?}");
    };
    assert_eq!(t, run.state().t());
    assert_eq!(corrections, 30);
    // Far from any solution, and finite: the iteration wandered, it neither converged nor escaped.
    assert!(last_correction.is_finite() && last_correction > 1e-4, "{error:?}");
    assert!(constraint_residual.is_finite() && constraint_residual > 1e-4, "{error:?}");
    assert!(smallest_pivot_ratio > 0.0 && smallest_pivot_ratio <= 1.0, "{error:?}");
    check_text(&error, &["no solution", "30 corrections", "constraints", "pivot", "smaller step size"]);

    // The state before it is a good start for smaller steps.
    let (t, q, v) = (run.state().t(), *run.state().q(), *run.state().v());
    let smaller = Simulation::new(DOUBLE, Evi::midpoint(0.001));
    let mut run = smaller.start_at(t, q, v).expect("the state satisfies the constraints");
    run.advance_to(t + 1.0).expect("small steps have a solution");
    assert_eq!(run.steps(), 1_000);
}

#[test]
fn a_step_without_solution_is_reported_with_the_numbers_of_the_iteration() {
    check_no_solution(Evi::midpoint(0.1).frequency(GRAVITY.sqrt()), 65);
    check_no_solution(Evi::midpoint(0.1).frequency(2.397), 65);
    check_no_solution(Evi::simpson(0.1).frequency(GRAVITY.sqrt()), 21);
    check_no_solution(Evi::simpson(0.1).frequency(2.397), 65);
    check_no_solution(Evi::midpoint(0.3), 2);
    check_no_solution(Rattle::new(0.3), 2);
}

#[test]
fn with_linear_interpolation_the_same_motion_has_every_step() {
    let horizontal = DOUBLE.horizontal();
    for scheme in [Evi::midpoint(0.1), Evi::midpoint(0.01)] {
        let mut run = Simulation::new(DOUBLE, scheme).start(horizontal.q, horizontal.v).unwrap();
        assert!(run.advance_to(10.0).is_ok());
    }
}

#[test]
fn a_recording_that_is_interrupted_keeps_what_it_has() {
    let scheme = Evi::simpson(0.1).frequency(GRAVITY.sqrt());
    let horizontal = DOUBLE.horizontal();
    let mut run = Simulation::new(DOUBLE, scheme).start(horizontal.q, horizontal.v).unwrap();
    let interrupted = run.integrate(10.0).expect_err("no solution after 2.1");
    check_text(&interrupted, &["stopped after 21 steps", "no solution"]);
    assert_eq!(format!("{interrupted:?}"), interrupted.to_string());
    assert!(interrupted.source().is_some_and(|source| source.is::<StepError>()));
    let Interrupted { error, trajectory } = interrupted;
    assert_error!(error, StepError::NoSolution { corrections: 30, .. });
    assert_eq!(trajectory.states().len(), 22);
    assert_eq!(trajectory.last(), run.state());
    for (k, state) in trajectory.states().iter().enumerate() {
        assert_eq!(state.t(), k as f64 * 0.1);
    }
}

/// The step equation of the midpoint for an oscillator is `(m + h² k / 4) d = ...`.
#[test]
fn a_step_whose_matrix_vanishes_is_singular() {
    let inverted = HarmonicOscillator { m: 1.0, k: -16.0 };
    let (_, error) = failed_run(inverted, Evi::midpoint(0.5), [1.0], [0.0], 1);
    let matrix = SingularMatrix { pivot_ratio: 0.0 };
    check_equal(error, StepError::Singular { t: 0.0, correction: 1, matrix });
    check_text(&error, &["singular step equations", "t = 0", "correction 1", "pivot"]);
    // Half the step is regular.
    let mut run = Simulation::new(inverted, Evi::midpoint(0.25)).start([1.0], [0.0]).unwrap();
    assert!(run.advance().is_ok());
}

#[test]
fn rattle_reports_a_guess_without_constraint_gradient_as_singular() {
    // Free fall from the top, for the time in which it covers the length of the rod.
    let system = SphericalPendulum { g: 2.0, ..SPHERICAL };
    let (_, error) = failed_run(system, Rattle::new(1.0), [0.0, 0.0, 1.0], [0.0; 3], 1);
    let matrix = SingularMatrix { pivot_ratio: 0.0 };
    check_equal(error, StepError::Singular { t: 0.0, correction: 1, matrix });
}

#[test]
fn an_end_without_mass_cannot_be_projected() {
    // Binary fractions: the step ends at time 1 exactly.
    let (run, error) = failed_run(Melting { end: 1.0 }, Evi::midpoint(0.125), [0.0], [1.0], 8);
    assert_eq!(run.state().t(), 0.875);
    let cause = ProjectionError::Singular(SingularMatrix { pivot_ratio: 0.0 });
    check_equal(error, StepError::Projection { t: 1.0, cause });
    check_text(&error, &["velocity at t = 1", "projected on the constraints", "mass matrix"]);
    // An explicit method meets the same mass in a stage.
    let (_, error) = failed_run(Melting { end: 1.0 }, Rk4::new(0.125), [0.0], [1.0], 8);
    let matrix = SingularMatrix { pivot_ratio: 0.0 };
    check_equal(error, StepError::Singular { t: 1.0, correction: 0, matrix });
}

#[test]
fn an_end_momentum_without_velocity_is_reported() {
    // Half the impulse leaves a velocity at the midpoint, the whole impulse none at the end.
    let (_, error) = failed_run(OneWay { force: 1.5 }, Evi::midpoint(1.0), [0.0], [1.0], 1);
    let StepError::Projection { t, cause: ProjectionError::NotConverged { corrections, last_correction } } =
        error
    else {
        panic!("{error:?}");
    };
    assert_eq!((t, corrections), (1.0, 30));
    assert!(last_correction.is_finite() && last_correction > 1e-4, "{error:?}");
    check_text(&error, &["t = 1", "did not converge", "after 30"]);
}

#[test]
fn growth_beyond_the_largest_number_is_reported() {
    // Far outside its region of stability, Kutta's method multiplies the oscillation by 376 at every step.
    let (run, error) = failed_run(OSCILLATOR, Rk4::new(10.0), [1.0], [0.0], 200);
    check_equal(error, StepError::NotFinite { t: run.state().t() + 10.0 });
    check_text(&error, &["state at t =", "not finite"]);
    assert!(run.steps() > 100, "{}", run.steps());
}

/// A velocity that leaves the rod a million times behind in one step: no solution, or a matrix that is lost
/// in round-off, but never a state.
#[test]
fn velocities_beyond_any_step_are_refused() {
    for speed in [1e5, 1e50, 1e76, 1e100, 1e150] {
        let q = [1.0, 0.0, 0.0];
        let (_, implicit) = failed_run(SPHERICAL, Evi::midpoint(0.01), q, [0.0, speed, 0.0], 1);
        let (_, rattle) = failed_run(SPHERICAL, Rattle::new(0.01), q, [0.0, speed, 0.0], 1);
        for error in [implicit, rattle] {
            assert_error!(error, StepError::NoSolution { .. } | StepError::Singular { .. });
        }
    }
}

/// Momenta are sums of terms that are `|h| ω` times as large: beyond, an oscillator gained 28 orders of magnitude of energy in a step.
#[test]
fn steps_that_leave_momenta_round_off_are_refused_with_their_phase() {
    for h in [1e13, -1e16, 1e44, 1e100] {
        let error = start_error(OSCILLATOR, Evi::midpoint(h), [1.0], [0.5]);
        check_equal(error, StartError::Phase { h, phase: h.abs(), limit: 1e12 });
        check_text(&error, &["a step of", "times 1/ω", "momenta are round-off"]);
    }
    let stiff = HarmonicOscillator { m: 1e-4, k: 1e26 };
    assert_error!(start_error(stiff, Evi::midpoint(0.01), [1.0], [0.5]), StartError::Phase { .. });
    // Of a thousand million periods per step four digits are left, as they should be.
    let mut run = Simulation::new(OSCILLATOR, Evi::midpoint(1e10)).start([1.0], [0.5]).unwrap();
    let energy = run.energy();
    run.advance().expect("solvable");
    assert!((run.energy() / energy - 1.0).abs() < 1e-3, "{}", run.energy());
    // Without a potential that bends, nothing cancels.
    assert!(Simulation::new(SPHERICAL, Evi::midpoint(1e44)).start([0.0, 0.0, -1.0], [0.0; 3]).is_ok());
}

/// A mass that is nothing beside the magnetic force: the elimination loses all digits, and no step ends beside the rod.
#[test]
fn steps_whose_matrix_has_lost_its_digits_are_refused() {
    let mut bits = 1_u64;
    let mut random = || {
        bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (bits >> 11) as f64 / (1_u64 << 51) as f64 - 2.0
    };
    let (mut accepted, mut refused) = (0, 0);
    for m in [1e-40, 1e-80] {
        let system = ChargedSphericalPendulum { m, l: 0.2, g: 0.2, b: 0.2 };
        for _ in 0..100 {
            let (q, v) = ([random(), random(), random()], [random(), random(), random()]);
            let simulation = Simulation::new(system, Evi::trapezoid(0.00785));
            let Ok(mut run) = simulation.start_projected(0.0, q, v) else { continue };
            match run.advance().cloned() {
                Ok(state) => {
                    let [rod] = run.mechanics().constraint_residual(&state);
                    assert!(rod.abs() < 1e-16, "{rod:e}");
                    accepted += 1;
                }
                Err(error) => {
                    assert_error!(error, StepError::NoSolution { .. } | StepError::Singular { .. });
                    refused += 1;
                }
            }
        }
    }
    println!("{accepted} accepted, {refused} refused");
    assert!(accepted > 10 && refused > 10, "{accepted} {refused}");
}

/// Steps back do not lead ahead: that takes the other sign, and nothing happens until then.
#[test]
fn a_time_on_the_other_side_is_refused_with_the_sign_that_leads_there() {
    for (h, target) in [(-0.01, 1.0), (0.01, -1.0)] {
        let mut run = Simulation::new(OSCILLATOR, Evi::midpoint(h)).start([1.0], [0.0]).expect("consistent");
        let error = run.advance_to(target).map(|_| ()).expect_err("the other side");
        check_text(&error, &["is not ahead", &format!("h = {h:?}: with h = {:?}", -h)]);
        assert!(matches!(error, StepError::OppositeTime { t: 0.0, .. }), "{error:?}");
        assert_eq!(run.integrate(target).expect_err("the other side").error, error);
        assert_eq!(run.steps(), 0);
        // Where it is, within a step, is near enough.
        assert!(run.advance_to(-0.9 * h).is_ok());
        assert!(run.advance_to(-target).is_ok());
        assert_eq!(run.steps(), 100);
    }
}

#[test]
fn a_time_that_no_number_of_steps_reaches_is_refused() {
    let mut run = Simulation::new(OSCILLATOR, Evi::midpoint(0.01)).start([1.0], [0.0]).expect("consistent");
    let before = run.state().clone();
    for (target, text) in [
        (f64::INFINITY, "t = inf "),
        (f64::NEG_INFINITY, "t = -inf "),
        (f64::NAN, "t = NaN "),
        (1e300, "t = 1e300 "),
    ] {
        let error = run.advance_to(target).map(|_| ()).expect_err("out of reach");
        check_text(&error, &[text, "cannot be reached", "h = 0.01"]);
        assert!(matches!(error, StepError::UnreachableTime { h: 0.01, .. }));
        let interrupted = run.integrate(target).expect_err("out of reach");
        assert_eq!(interrupted.trajectory.states(), std::slice::from_ref(&before));
    }
    assert_eq!((run.state(), run.steps()), (&before, 0));
}
