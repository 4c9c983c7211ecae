//! Every error of the generic path.

use super::*;

/// The error of a start that must fail.
#[track_caller]
fn start_error<S: GenericSystem>(scheme: GenericEvi, system: S, q: &[f64], v: &[f64]) -> StartError {
    match scheme.start(system, q, v) {
        Ok(run) => panic!("started at {:?}", run.q()),
        Err(error) => error,
    }
}

#[test]
fn vectors_of_another_length_are_refused() {
    let error = start_error(GenericEvi::midpoint(H), SPHERICAL, &[0.0; 2], &[0.0; 3]);
    assert_eq!(error, StartError::Length { quantity: "position", expected: 3, found: 2 });
    let error = start_error(GenericEvi::midpoint(H), SPHERICAL, &[0.0, 0.0, -1.0], &[0.0; 4]);
    assert_eq!(error, StartError::Length { quantity: "velocity", expected: 3, found: 4 });
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    let error = start_error(GenericEvi::midpoint(H), SPHERICAL, &[0.0, f64::NAN, -1.0], &[0.0; 3]);
    assert!(matches!(error, StartError::NotFinite { quantity: "position", index: 1, .. }), "{error:?}");
    let error = start_error(GenericEvi::midpoint(H), SPHERICAL, &[0.0, 0.0, -1.0], &[0.0, 0.0, 1e200]);
    assert!(matches!(error, StartError::NotFinite { quantity: "energy", .. }), "{error:?}");
}

#[test]
fn an_inconsistent_start_is_refused_by_the_place_of_its_constraint() {
    let chain = Chain::alternating(3);
    let mut q = chain.at_angle(0.2);
    let mut v = [0.0; 6];
    v[4] = 1.0;
    let error = start_error(GenericEvi::midpoint(H), chain.clone(), &q, &v);
    let StartError::InconsistentVelocity { constraint, residual, allowed } = error else {
        panic!("{error:?}")
    };
    // The last rod's gradient is (−sin, cos, sin, −cos) by the two ends.
    assert_eq!(constraint, ConstraintLabel::Index(2));
    assert!((residual - 0.2_f64.sin() / 2.0_f64.sqrt()).abs() < 1e-14 && allowed < 1e-10, "{residual}");
    assert!(error.to_string().contains("leaves constraint 2: "), "{error}");
    q[5] -= 0.1;
    let error = start_error(GenericEvi::midpoint(H), chain.clone(), &q, &[0.0; 6]);
    let StartError::InconsistentPosition { constraint, residual, .. } = error else { panic!("{error:?}") };
    assert_eq!(constraint, ConstraintLabel::Index(2));
    assert!(residual > 0.01);
    let run = GenericEvi::midpoint(H).start_projected(chain, 0.0, &q, &v).expect("near the chain");
    assert!(run.constraint_residual().iter().all(|residual| residual.abs() < 1e-15));
    assert!(run.hidden_constraint_residual().iter().all(|residual| *residual < 1e-15));
}

#[test]
fn schemes_that_define_no_step_are_refused() {
    let refused = |scheme: GenericEvi| {
        let Start { q, v } = SPHERICAL.one_radian();
        match start_error(scheme, SPHERICAL, &q, &v) {
            StartError::Scheme(error) => error,
            error => panic!("not the scheme is refused: {error:?}"),
        }
    };
    assert_eq!(refused(GenericEvi::midpoint(0.0)), SchemeError::StepSize { h: 0.0 });
    let negative = refused(GenericEvi::midpoint(H).frequency(-1.0));
    assert_eq!(negative, SchemeError::Frequency { coordinate: 0, value: -1.0 });
    let frequencies = [OMEGA, OMEGA, core::f64::consts::PI / H].map(Frequency::from);
    let resonant = refused(GenericEvi::midpoint(H).frequencies(frequencies));
    assert!(matches!(resonant, SchemeError::ResonantFrequency { coordinate: 2, .. }), "{resonant:?}");
    let blind = refused(GenericEvi::simpson(H).frequency(2.0 * core::f64::consts::FRAC_PI_3 / H));
    assert!(matches!(blind, SchemeError::VanishingInertia { coordinate: 0, .. }), "{blind:?}");
    let few = refused(GenericEvi::midpoint(H).frequencies([Frequency::ZERO; 2]));
    assert_eq!(few, SchemeError::FrequencyCount { frequencies: 2, coordinates: 3 });
    assert!(few.to_string().contains("2 frequencies for 3 coordinates"));
}

/// A mass that is gone at time `end`, on a circle whose squared radius shrinks at unit rate when `held`.
#[derive(Clone, Copy)]
struct Vanishing {
    end: f64,
    held: bool,
}

impl GenericSystem for Vanishing {
    fn n_coordinates(&self) -> usize {
        2
    }

    fn n_constraints(&self) -> usize {
        usize::from(self.held)
    }

    fn lagrangian<T: Scalar>(&self, t: T, _q: &[T], v: &[T]) -> T {
        (T::from_f64(self.end) - t) * (v[0].powi(2) + v[1].powi(2))
    }

    fn constraints<T: Scalar>(&self, t: T, q: &[T], residuals: &mut [T]) {
        if self.held {
            residuals[0] = q[0].powi(2) + q[1].powi(2) - (T::from_f64(1.0) - t);
        }
    }
}

/// The error of the first step that fails, at most `steps` from the start; it fails twice alike and changes nothing.
#[track_caller]
fn step_error<S: GenericSystem>(mut run: GenericRun<S>, steps: u64) -> StepError {
    loop {
        assert!(run.steps() < steps, "no step failed");
        let numbers = |run: &GenericRun<S>| {
            (run.t(), run.steps(), [run.q(), run.v(), run.p()].concat(), run.hidden_constraint_residual())
        };
        let before = numbers(&run);
        if let Err(error) = run.advance() {
            // Equality of every bit.
            assert_eq!(numbers(&run), before);
            let again = run.advance().expect_err("the same step fails again");
            assert_eq!(format!("{again:?}"), format!("{error:?}"));
            assert_eq!(numbers(&run), before);
            return error;
        }
    }
}

#[test]
fn a_step_without_a_solution_leaves_the_run_where_it_stands() {
    let shrinking = Vanishing { end: 10.0, held: true };
    let run = GenericEvi::midpoint(0.03).start(shrinking, &[1.0, 0.0], &[-0.5, 0.2]).expect("consistent");
    let error = step_error(run, 34);
    let StepError::NoSolution { t, constraint_residual, .. } = error else { panic!("{error:?}") };
    assert!(t < 1.0 && t > 0.9 && constraint_residual > 1e-3, "{error:?}");
}

#[test]
fn a_step_without_mass_is_singular() {
    let massless_at_the_node = Vanishing { end: 0.5 * H, held: false };
    let run = GenericEvi::midpoint(H).start(massless_at_the_node, &[1.0, 0.0], &[0.1, 0.2]).expect("free");
    let error = step_error(run, 1);
    assert!(matches!(error, StepError::Singular { t: 0.0, correction: 1, .. }), "{error:?}");
}

#[test]
fn an_end_without_mass_cannot_be_projected() {
    let massless_at_the_end = Vanishing { end: H, held: false };
    let run = GenericEvi::midpoint(H).start(massless_at_the_end, &[1.0, 0.0], &[0.1, 0.2]).expect("free");
    let error = step_error(run, 1);
    let StepError::Projection { t, cause: ProjectionError::Singular(matrix) } = error else {
        panic!("{error:?}")
    };
    assert_eq!((t, matrix.pivot_ratio), (H, 0.0));
}

#[test]
fn a_start_where_nothing_determines_the_motion_is_refused() {
    let error =
        start_error(GenericEvi::midpoint(H), Vanishing { end: 0.0, held: false }, &[1.0, 0.0], &[0.0; 2]);
    assert!(matches!(error, StartError::Projection(ProjectionError::Singular(_))), "{error:?}");
}

#[test]
fn a_time_that_is_no_number_of_steps_away_is_refused_before_any_step() {
    let mut run = Chain::alternating(2).run(&GenericEvi::midpoint(H));
    for target in [f64::NAN, f64::INFINITY, 1e30] {
        let error = run.advance_to(target).expect_err("unreachable");
        assert!(matches!(error, StepError::UnreachableTime { h: H, .. }), "{error:?}");
        assert_eq!(run.steps(), 0);
    }
}
