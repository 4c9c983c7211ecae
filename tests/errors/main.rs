//! Every error of a run, provoked: its numbers, its text, and that nothing has changed when it comes.

mod schemes;
mod starts;
mod steps;

use std::error::Error;
use std::fmt::Debug;

use evi_core::baseline::{Rattle, Rk4};
use evi_core::integrator::{ConstraintLabel, Interrupted};
use evi_core::linear::{DenseLu, Factorization, SingularMatrix};
use evi_core::mechanics::ProjectionError;
use evi_core::prelude::*;
use evi_core::scheme::{LinearisationError, QuadratureError};
use evi_examples::{DoublePendulum, GRAVITY, HarmonicOscillator, SphericalPendulum};
use evi_tests::scenes::{ChargedSphericalPendulum, DoublePendulumInAngles};

const DOUBLE: DoublePendulum = DoublePendulum::UNIT;
const SPHERICAL: SphericalPendulum = SphericalPendulum::UNIT;
const OSCILLATOR: HarmonicOscillator = HarmonicOscillator { m: 1.0, k: 1.0 };
const HANGING: [f64; 4] = [0.0, -1.0, 0.0, -2.0];

/// A bead on an ellipse; without a solution for a negative size, a point for size 0.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * (der(x).powi(2) + der(y).powi(2)),
    potential = y,
    constraint(ellipse: 0.25 * x.powi(2) + y.powi(2) == size),
)]
struct Bead {
    size: f64,
}

/// One rod, written down twice.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = m * y,
    constraint(rod: x.powi(2) + y.powi(2) == 1.0),
    constraint(again: x.powi(2) + y.powi(2) == 1.0),
)]
struct HeldTwice {
    m: f64,
}

/// A block whose mass is gone at time `end`.
#[derive(MechanicalSystem)]
#[evi(coordinates(x), lagrangian = 0.5 * (end - t) * der(x).powi(2))]
struct Melting {
    end: f64,
}

/// Momentum `p = v²`: no velocity has a negative one.
#[derive(MechanicalSystem)]
#[evi(coordinates(x), lagrangian = der(x).powi(3) / 3.0 - force * x)]
struct OneWay {
    force: f64,
}

/// The text of an error holds what a user needs.
#[track_caller]
fn check_text(error: &dyn Error, words: &[&str]) {
    let text = error.to_string();
    for word in words {
        assert!(text.contains(word), "`{word}` is missing in: {text}");
    }
}

/// The error of a start that must fail.
#[track_caller]
fn start_error<S, F, const N: usize>(system: S, scheme: F, q: [f64; N], v: [f64; N]) -> StartError
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S>,
{
    match Simulation::new(system, scheme).start(q, v) {
        Ok(run) => panic!("started at {:?}", run.state()),
        Err(error) => error,
    }
}

/// The error of a scheme that must be refused.
#[track_caller]
fn scheme_error<S, F, const N: usize>(system: S, scheme: F) -> SchemeError
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S>,
{
    // The scheme is refused before the start is looked at.
    match start_error(system, scheme, [f64::NAN; N], [0.0; N]) {
        StartError::Scheme(error) => error,
        error => panic!("not the scheme is refused: {error:?}"),
    }
}

/// A run at its first step that fails, at most `steps` steps from the start, and the error.
///
/// The step fails twice alike and leaves the run as it was.
#[track_caller]
fn failed_run<S, F, const N: usize>(
    system: S,
    scheme: F,
    q: [f64; N],
    v: [f64; N],
    steps: u64,
) -> (Run<S, F::Step>, StepError)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S>,
{
    let mut run = Simulation::new(system, scheme).start(q, v).expect("the start is consistent");
    loop {
        assert!(run.steps() < steps, "no step failed");
        let (before, steps_before) = (run.state().clone(), run.steps());
        if let Err(error) = run.advance() {
            check_unchanged(&mut run, &before, steps_before, error);
            return (run, error);
        }
    }
}

#[track_caller]
fn check_unchanged<S: MechanicalSystem, M: OneStep<S>>(
    run: &mut Run<S, M>,
    before: &State<S>,
    steps: u64,
    error: StepError,
) {
    // Equality of every bit.
    assert_eq!(run.state(), before);
    assert_eq!(run.steps(), steps);
    assert!(before.q().as_ref().iter().chain(before.v().as_ref()).all(|number| number.is_finite()));
    let again = run.advance().expect_err("the same step fails again");
    assert_eq!(format!("{again:?}"), format!("{error:?}"));
    assert_eq!(run.state(), before);
}

/// Asserts the variant and a condition on its numbers.
macro_rules! assert_error {
    ($error:expr, $pattern:pat $(if $condition:expr)?) => {{
        let error = $error;
        assert!(matches!(error, $pattern $(if $condition)?), "{error:?}");
    }};
}
use assert_error;

#[track_caller]
fn check_equal<E: PartialEq + Debug>(error: E, expected: E) -> E {
    assert_eq!(error, expected);
    error
}
