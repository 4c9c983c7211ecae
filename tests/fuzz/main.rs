//! Random scenes, parameters, states, step sizes and schemes, among them what is zero, huge, tiny or no number: a step is taken as its
//! equations say, or refused with an error that leaves the state as it was.
//!
//! Many cases: `EVI_FUZZ_CASES=100000 cargo test --release -p evi-tests --test fuzz -- --nocapture`, with `EVI_FUZZ_SEED=N` from case
//! `N` on. A failure names its case, made as small as it goes.

mod equations;
mod expressions;
#[path = "../../benches/stability/inner_points.rs"]
mod inner_points;
mod numbers;
#[path = "../random_choices/mod.rs"]
mod random_choices;
mod scenes;
#[path = "../random_expressions/splitmix.rs"]
mod splitmix;
mod systems;

use std::fmt::Debug;

use evi_core::array::Array;
use evi_core::baseline::{GeneralizedAlpha, ImplicitMidpoint, Rattle, Rk4, Shake};
use evi_core::mechanics::Mechanics;
use evi_core::prelude::*;
use numbers::{number, step_size};
use random_choices::{Choices, check};
use scenes::Random;

const STACK: usize = 2 * 1024 * 1024;

/// What became of a case.
#[derive(Clone, Copy, Debug, Default)]
struct Outcome {
    /// Whether it began at all.
    is_started: bool,
    accepted: usize,
    refused: usize,
    /// The largest residuals of accepted states, in units of the round-off of their terms.
    constraints: f64,
    hidden_constraints: f64,
    /// Those of the equations of the action, in the same units, where they are looked at.
    action: f64,
    /// Of so many steps.
    actions: usize,
}

impl Outcome {
    fn or(self, other: Self) -> Self {
        Self {
            is_started: self.is_started || other.is_started,
            accepted: self.accepted + other.accepted,
            refused: self.refused + other.refused,
            constraints: self.constraints.max(other.constraints),
            hidden_constraints: self.hidden_constraints.max(other.hidden_constraints),
            action: self.action.max(other.action),
            actions: self.actions + other.actions,
        }
    }
}

/// What a scheme promises of the states that it reaches.
#[derive(Clone, Copy, PartialEq)]
enum Keeps {
    /// Positions and velocities on the constraints.
    Both,
    /// Positions alone.
    Positions,
    /// Positions, as far as the cancellation of what is added up to them allows.
    PositionsButForCancellation,
    /// Finite numbers.
    Nothing,
}

impl Keeps {
    /// What is left of it over such a step, of any size: a phase of 100 has lost its digits, what it is worth nothing tells.
    fn over(self, h: f64, frequency: f64) -> Self {
        if (h * frequency).abs() < 100.0 { self } else { Self::Nothing }
    }

    /// What is left of it at such a time: a clock of ten digits leaves six to the step.
    fn at(self, t: f64) -> Self {
        if t.abs() < 1e6 { self } else { Self::Nothing }
    }
}

fn case<S: Random>(choices: &mut Choices) -> Result<Outcome, String> {
    let system = S::random(choices);
    let h = step_size(choices);
    let evi = Evi::midpoint(h);
    let frequency = number(choices);
    match choices.below(10) {
        0 => steps(system, evi, Keeps::Both.over(h, 0.0), choices),
        1 => steps(system, Evi::simpson(h).frequency(frequency), Keeps::Both.over(h, frequency), choices),
        2 => steps(system, Evi::trapezoid(h), Keeps::Both.over(h, 0.0), choices),
        3 => steps(system, evi.composed(Composition::suzuki_4()), Keeps::Both.over(h, 0.0), choices),
        4 => steps(system, evi.compensated(), Keeps::Both.over(h, 0.0), choices),
        5 => steps(system, Rattle::new(h), Keeps::Both.over(h, 0.0), choices),
        6 => steps(system, Rk4::new(h), Keeps::Nothing, choices),
        7 => steps(system, Shake::new(h), Keeps::Positions.over(h, 0.0), choices),
        8 => {
            steps(system, GeneralizedAlpha::new(h), Keeps::PositionsButForCancellation.over(h, 0.0), choices)
        }
        _ => steps(system, ImplicitMidpoint::new(h), Keeps::Nothing, choices),
    }
}

/// A few steps from a random start.
fn steps<S: Random, F: Scheme<S> + Debug>(
    system: S,
    scheme: F,
    keeps: Keeps,
    choices: &mut Choices,
) -> Result<Outcome, String> {
    let description = format!("{system:?} by {scheme:?}");
    steps_described(system, scheme, keeps, choices).map_err(|error| format!("{description}: {error}"))
}

fn steps_described<S: Random, F: Scheme<S>>(
    system: S,
    scheme: F,
    keeps: Keeps,
    choices: &mut Choices,
) -> Result<Outcome, String> {
    let mut outcome = Outcome::default();
    let t = if choices.once_in(8) { number(choices) } else { 0.0 };
    let q = S::PerCoordinate::<f64>::from_fn(|_| number(choices));
    let v = S::PerCoordinate::<f64>::from_fn(|_| number(choices));
    // Round-off of a velocity is relative to the largest that it has come from.
    let mut speed = largest(v.as_ref());
    let Ok(mut run) = Simulation::new(system, scheme).start_projected(t, q, v) else { return Ok(outcome) };
    outcome.is_started = true;
    outcome = outcome.or(looked_at(run.mechanics(), run.state(), speed, Keeps::Both.at(t))?);
    let keeps = keeps.at(t);
    for _ in 0..=choices.below(4) {
        run.inputs_mut().as_mut().iter_mut().for_each(|input| *input = number(choices));
        let before = run.state().clone();
        // A step over which the motion is less than the round-off of the positions knows velocities to the quotient of both.
        let of_round_off = f64::EPSILON * largest(before.q().as_ref()) / run.map().h().abs();
        speed = speed.max(largest(before.v().as_ref())).max(of_round_off);
        match run.advance().err() {
            None => {
                outcome.accepted += 1;
                outcome = outcome.or(looked_at(run.mechanics(), run.state(), speed, keeps)?);
            }
            Some(_) if bits(&before) == bits(run.state()) => outcome.refused += 1,
            Some(error) => return Err(format!("`{error}` has changed the state {before:?}")),
        }
    }
    Ok(outcome)
}

/// The largest absolute value; NaN if one is.
fn largest(values: &[f64]) -> f64 {
    values.iter().map(|x| x.abs()).fold(0.0, |largest, x| if x <= largest { largest } else { x })
}

fn bits<S: MechanicalSystem>(state: &State<S>) -> Vec<u64> {
    let numbers = [state.q().as_ref(), state.v().as_ref(), state.p().as_ref(), &[state.t()]].concat();
    numbers.into_iter().map(f64::to_bits).collect()
}

/// Looks at an accepted state: its numbers are finite, and it satisfies what the scheme promises.
fn looked_at<S: MechanicalSystem>(
    mechanics: &Mechanics<S>,
    state: &State<S>,
    speed: f64,
    keeps: Keeps,
) -> Result<Outcome, String> {
    let numbers = [state.q().as_ref(), state.v().as_ref(), state.p().as_ref(), &[state.t()]].concat();
    if !numbers.iter().all(|number| number.is_finite()) {
        return Err(format!("accepts {state:?}"));
    }
    let mut outcome = Outcome::default();
    if matches!(keeps, Keeps::Both | Keeps::Positions) {
        outcome.constraints = constraint_error(mechanics, state);
    } else if keeps == Keeps::PositionsButForCancellation && constraint_error(mechanics, state) > CANCELLATION
    {
        return Err(format!("beside the constraints at {state:?}"));
    }
    if keeps == Keeps::Both {
        let of_speed = (largest(state.v().as_ref()) / speed).min(1.0);
        // What is below the round-off of the larger velocity has no direction, nor has what squares to nothing.
        let is_measured = of_speed > f64::EPSILON && largest(state.v().as_ref()) > 1e-140;
        if is_measured || of_speed.is_nan() && speed > 0.0 {
            let residuals = mechanics.hidden_constraint_residual(state);
            outcome.hidden_constraints = largest(residuals.as_ref()) * of_speed / f64::EPSILON;
        }
    }
    let are_kept = outcome.constraints <= ROUND_OFFS && outcome.hidden_constraints <= ROUND_OFFS;
    if are_kept { Ok(outcome) } else { Err(format!("{outcome:?} at {state:?}")) }
}

/// What the equations of an accepted state may be off by, in units of the round-off of their terms: parameters of random sign make
/// indefinite masses, whose projections lose digits. With ordinary parameters it is 7 at most.
const ROUND_OFFS: f64 = 1e6;

/// The same of random systems, of the constraints and of the equations of the action: 1,100 and 3,700 measured in 60,000 cases.
const EQUATIONS_ROUND_OFFS: f64 = 1e4;

/// The same after a cancellation of seven digits.
const CANCELLATION: f64 = 1e8;

/// Residuals of the constraints against what a displacement by the round-off of the configuration makes of them, by differences
/// of the constraints themselves.
fn constraint_error<S: MechanicalSystem>(mechanics: &Mechanics<S>, state: &State<S>) -> f64 {
    let residuals = mechanics.constraint_residual(state);
    let size = largest(state.q().as_ref());
    // A thousand roundings of the largest coordinate, in every direction.
    let displacement = 1e3 * f64::EPSILON * size;
    let mut allowed = vec![0.0_f64; S::N_CONSTRAINTS];
    // And of the time, whose last digit a run and a step may round differently.
    let later = state.t() * (1.0 + 1e3 * f64::EPSILON);
    let moved = mechanics.constraint_residual_at(later, state.q());
    for c in 0..S::N_CONSTRAINTS {
        allowed[c] = (moved[c] - residuals[c]).abs();
    }
    for i in 0..S::N_COORDINATES {
        for sign in [-1.0, 1.0] {
            let mut q = state.q().clone();
            q[i] += sign * displacement;
            let moved = mechanics.constraint_residual_at(state.t(), &q);
            for c in 0..S::N_CONSTRAINTS {
                allowed[c] = allowed[c].max((moved[c] - residuals[c]).abs());
            }
        }
    }
    // In units of one rounding.
    let ratio = |c: usize| if residuals[c] == 0.0 { 0.0 } else { 1e3 * residuals[c].abs() / allowed[c] };
    largest(&(0..S::N_CONSTRAINTS).map(ratio).collect::<Vec<_>>())
}

/// Runs the cases of a scene, and prints what became of them.
fn steps_are_taken_as_their_equations_say_or_refused<S: Random>() {
    let outcomes = check(800, STACK, case::<S>);
    summary(std::any::type_name::<S>(), &outcomes);
}

/// Prints what became of the cases, and whether that is enough of everything.
#[track_caller]
fn summary(kind: &str, outcomes: &[Outcome]) {
    let started = outcomes.iter().filter(|outcome| outcome.is_started).count();
    let all = outcomes.iter().copied().fold(Outcome::default(), Outcome::or);
    println!(
        "{kind}: {} cases, {started} started, {} steps accepted, {} refused; residuals in round-offs: constraints {:.1}, \
         hidden constraints {:.1}, action {:.1} of {} steps",
        outcomes.len(),
        all.accepted,
        all.refused,
        all.constraints,
        all.hidden_constraints,
        all.action,
        all.actions
    );
    assert!(all.accepted > outcomes.len() / 10, "too few steps are accepted");
    assert!(all.refused > 0 || started < outcomes.len(), "neither a start nor a step is refused");
}
