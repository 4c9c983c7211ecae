//! Steps of systems that are random themselves: as data by the generic path, and written by the build script, with a kernel of their own.

use std::fmt::Debug;

use evi_core::comparison::Solver;
use evi_core::generic::{GenericEvi, GenericGalerkin, GenericRun, GenericScheme, GenericSystem};
use evi_core::integrator::Tally;
use evi_core::prelude::*;

use crate::equations::{Equations, Snapshot, constraints, hidden_constraints};
use crate::expressions::RandomSystem;
use crate::inner_points::InnerPoints;
use crate::numbers::{number, parameter, step_size};
use crate::random_choices::{Choices, check};
use crate::{EQUATIONS_ROUND_OFFS, Outcome, ROUND_OFFS, STACK, largest, summary};

/// Systems of the build script, of 2 and 3 coordinates.
mod written {
    use evi_core::array::Array;
    use evi_core::prelude::*;

    use super::{Choices, Outcome, number, parameter, steps_of};

    include!(concat!(env!("OUT_DIR"), "/random_scenes.rs"));
}

/// Which equations of a step are looked at.
#[derive(Clone)]
enum Action {
    /// Those of its action, and the constraints at the end.
    Of(Equations),
    /// The constraints at the end alone: the states between the parts of the step are not known.
    Unknown,
    /// None.
    Lost,
}

impl Action {
    const MIDPOINT: Self = Self::Of(Equations::Midpoint);

    /// Of `Galerkin` with so many intervals.
    fn galerkin(intervals: usize) -> Self {
        Self::Of(Equations::Points(InnerPoints::lobatto(intervals)))
    }

    /// Of `Gauss` with so many nodes.
    fn gauss(nodes: usize) -> Self {
        Self::Of(Equations::Points(InnerPoints::gauss(nodes)))
    }

    /// On curves of this frequency: a phase of 100 has lost its digits.
    fn on_curves(h: f64, frequency: f64) -> Self {
        if (h * frequency).abs() < 100.0 { Self::Unknown } else { Self::Lost }
    }
}

/// A run whose inputs change from step to step.
trait Driven: Solver {
    fn inputs_mut(&mut self) -> &mut [f64];
}

impl<S: GenericSystem> Driven for GenericRun<S> {
    fn inputs_mut(&mut self) -> &mut [f64] {
        self.inputs_mut()
    }
}

impl<S: MechanicalSystem, M: OneStep<S>, T: Tally> Driven for Run<S, M, T> {
    fn inputs_mut(&mut self) -> &mut [f64] {
        self.inputs_mut().as_mut()
    }
}

/// States of this size are finite, and nothing else is asked of them.
const LARGEST_JUDGED: f64 = 1e6;
/// Configurations that are smaller, but not zero, are less than the round-off of the ways that forces and constraints make of opposite sign.
const SMALLEST_JUDGED: f64 = 1e-12;

/// A few steps of size `h` from where the solver stands; the terms of the constraints are of the size of `terms`.
fn followed<S: GenericSystem>(
    system: &S,
    solver: &mut dyn Driven,
    (h, terms): (f64, f64),
    action: &Action,
    choices: &mut Choices,
) -> Result<Outcome, String> {
    let mut outcome = Outcome { is_started: true, ..Outcome::default() };
    let mut speed = largest(solver.v());
    for _ in 0..=choices.below(4) {
        solver.inputs_mut().iter_mut().for_each(|input| *input = number(choices));
        let inputs = solver.inputs_mut().to_vec();
        let before = Snapshot::of(solver);
        let taken = solver.steps();
        // Momenta are differences of positions over `h`, and velocities what is left of them on the constraints.
        speed = speed.max(largest(&before.v)).max(largest(&before.q) / h.abs());
        let step = solver.advance_to(before.t + h);
        let after = Snapshot::of(solver);
        if let Err(error) = step {
            let bits = |state: &Snapshot| state.numbers().iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            if bits(&before) != bits(&after) {
                return Err(format!("`{error}` has changed the state {before:?}"));
            }
            outcome.refused += 1;
            continue;
        }
        if !after.numbers().iter().all(|number| number.is_finite()) {
            return Err(format!("accepts {after:?}"));
        }
        // Where a step is less than the round-off of the time, none is asked for; where it is little more, it is another one.
        let is_one_step = solver.steps() == taken + 1 && (after.t - before.t - h).abs() <= 1e-6 * h.abs();
        outcome.accepted += 1;
        // Sines and powers of larger numbers have hardly a digit left.
        let has_digits = |state: &Snapshot| {
            let size = largest(&state.q);
            size.max(state.t.abs()) < LARGEST_JUDGED && (size == 0.0 || size > SMALLEST_JUDGED)
        };
        let has_digits = has_digits(&before) && has_digits(&after);
        if !is_one_step || !has_digits || matches!(action, Action::Lost) {
            continue;
        }
        let mut seen = Outcome {
            constraints: constraints(system, &after, terms),
            hidden_constraints: hidden_constraints(system, &after, speed.max(largest(&after.v))),
            ..Outcome::default()
        };
        if let Action::Of(equations) = action
            && let Some(residual) = equations.residual(system, (h, &inputs), &before, &after)
        {
            (seen.action, seen.actions) = (residual, 1);
        }
        outcome = outcome.or(seen);
        let are_kept = seen.constraints <= EQUATIONS_ROUND_OFFS
            && seen.hidden_constraints <= ROUND_OFFS
            && seen.action <= EQUATIONS_ROUND_OFFS;
        if !are_kept {
            return Err(format!("{seen:?} from {before:?} to {after:?}"));
        }
    }
    Ok(outcome)
}

fn of_data(choices: &mut Choices) -> Result<Outcome, String> {
    let system = RandomSystem::random(choices);
    let n = system.n_coordinates();
    let (h, frequency) = (step_size(choices), number(choices));
    let t = if choices.once_in(8) { number(choices) } else { 0.0 };
    let [q, v] = [(); 2].map(|()| (0..n).map(|_| number(choices)).collect::<Vec<_>>());
    let system = system.through(t, &q);
    let start = (t, &q[..], &v[..]);
    match choices.below(6) {
        0..=2 => data_steps(&system, GenericEvi::midpoint(h), start, Action::MIDPOINT, choices),
        3 => {
            let scheme = GenericEvi::simpson(h).frequency(frequency);
            data_steps(&system, scheme, start, Action::on_curves(h, frequency), choices)
        }
        4 => data_steps(
            &system,
            GenericEvi::midpoint(h).composed(Composition::suzuki_4()),
            start,
            Action::Unknown,
            choices,
        ),
        _ => {
            let intervals = 1 + choices.below(4);
            let scheme = GenericGalerkin::new(intervals, h);
            data_steps(&system, scheme, start, Action::galerkin(intervals), choices)
        }
    }
}

fn data_steps(
    system: &RandomSystem,
    scheme: impl GenericScheme + Debug,
    (t, q, v): (f64, &[f64], &[f64]),
    action: Action,
    choices: &mut Choices,
) -> Result<Outcome, String> {
    let h = scheme.step_size();
    let Ok(mut run) = scheme.start_projected(system.clone(), t, q, v) else { return Ok(Outcome::default()) };
    followed(system, &mut run, (h, system.largest_level()), &action, choices)
        .map_err(|error| format!("{system:?} by {scheme:?} from {q:?}, {v:?} at {t:?}: {error}"))
}

/// The equations of the action of every third step are looked at.
#[track_caller]
fn are_looked_into(outcomes: &[Outcome], kind: &str) {
    summary(kind, outcomes);
    let [accepted, actions] = [|outcome: &Outcome| outcome.accepted, |outcome: &Outcome| outcome.actions]
        .map(|of| outcomes.iter().map(of).sum::<usize>());
    assert!(3 * actions > accepted, "of {accepted} steps only {actions} are looked into");
}

#[test]
fn systems_that_are_data() {
    are_looked_into(&check(4000, STACK, of_data), "systems as data");
}

/// A few steps of a system that is written, by a scheme of every kind.
fn steps_of<S>(
    system: &S,
    (t, q, v): (f64, S::PerCoordinate<f64>, S::PerCoordinate<f64>),
    choices: &mut Choices,
) -> Result<Outcome, String>
where
    S: MechanicalSystem + GenericSystem + Clone + Debug + 'static,
{
    let (h, frequency) = (step_size(choices), number(choices));
    let start = (t, q, v);
    let midpoint = Evi::midpoint(h);
    match choices.below(7) {
        0 | 1 => written_steps(system, midpoint, start, Action::MIDPOINT, choices),
        2 => {
            let scheme = Evi::simpson(h).frequency(frequency);
            written_steps(system, scheme, start, Action::on_curves(h, frequency), choices)
        }
        3 | 4 => written_steps(system, Galerkin::<2>::new(h), start, Action::galerkin(2), choices),
        5 => written_steps(system, Gauss::<2>::new(h), start, Action::gauss(2), choices),
        _ => {
            let composed = midpoint.composed(Composition::triple_jump_4());
            written_steps(system, composed, start, Action::Unknown, choices)
        }
    }
}

fn written_steps<S, F>(
    system: &S,
    scheme: F,
    (t, q, v): (f64, S::PerCoordinate<f64>, S::PerCoordinate<f64>),
    action: Action,
    choices: &mut Choices,
) -> Result<Outcome, String>
where
    S: MechanicalSystem + GenericSystem + Clone + Debug + 'static,
    F: Scheme<S> + Debug,
{
    let description = format!("{system:?} by {scheme:?} from {:?}, {:?} at {t:?}", q.as_ref(), v.as_ref());
    let start = Simulation::new(system.clone(), scheme).start_projected(t, q, v);
    let Ok(mut run) = start else { return Ok(Outcome::default()) };
    let h = run.map().h();
    followed(system, &mut run, (h, 1.0), &action, choices).map_err(|error| format!("{description}: {error}"))
}

#[test]
fn systems_that_are_written() {
    are_looked_into(&check(3000, STACK, written::case), "systems as written");
}
