//! Runs under observation: every step is looked at and checked, within budgets.

use evi_benches::external::Dop853Error;
use evi_core::comparison::{Failure, Solver};
use evi_core::integrator::StepError;

use crate::check::{Check, Snapshot};
use crate::specimen::Specimen;
use crate::verdict::DIVERGED;

/// A run to observe.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Course {
    pub(crate) h: f64,
    pub(crate) steps: u64,
    /// Every so many steps one is looked at and checked.
    pub(crate) steps_per_sample: u64,
    /// Period of the slowest oscillation.
    pub(crate) period: f64,
    /// Steps after which a method that chooses its own is not followed further.
    pub(crate) most_steps: u64,
}

/// What a state shows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) step: u64,
    /// `(H − H₀)` in units of the energy that the motion exchanges.
    pub(crate) energy: f64,
    /// Largest `|φ| / ‖G‖‖q‖`.
    pub(crate) constraint: f64,
    /// Largest `|G v + ∂φ/∂t|` relative to its terms.
    pub(crate) hidden: f64,
    /// Largest change of a conserved momentum, relative to `‖q‖ ‖p‖`.
    pub(crate) momentum: f64,
    /// `‖q‖ / ‖q₀‖`.
    pub(crate) size: f64,
}

/// How a run ended.
#[derive(Clone, Debug)]
pub(crate) enum Ending {
    Complete,
    NotStarted {
        reason: String,
    },
    /// The step of this number was not found.
    Failed {
        step: u64,
        residual: Option<f64>,
        pivot: Option<f64>,
        reason: String,
    },
    /// The step of this number left the numbers.
    NotFinite {
        step: u64,
    },
    /// The budget of steps was spent before this one.
    OutOfSteps {
        step: u64,
    },
}

/// What was observed of a run.
#[derive(Clone, Debug)]
pub(crate) struct Observation {
    pub(crate) samples: Vec<Sample>,
    pub(crate) steps_per_sample: u64,
    /// Steps of the course that were taken.
    pub(crate) steps: u64,
    /// Steps that the method took for them: more where it chooses its own.
    pub(crate) taken: u64,
    /// Periods of the slowest oscillation in the whole run.
    pub(crate) periods: f64,
    /// Largest `‖q‖ / ‖q₀‖` that the motion itself has.
    pub(crate) largest_size: f64,
    pub(crate) ending: Ending,
    pub(crate) check: Check,
    /// The last state.
    pub(crate) end: Option<Snapshot>,
}

/// Energy errors beyond which a run is not followed further.
const HOPELESS: f64 = 1e12;

/// Runs a method on a specimen.
pub(crate) fn observe(specimen: &dyn Specimen, method: &str, course: Course) -> Observation {
    let mut seen = Observation::nothing();
    seen.steps_per_sample = course.steps_per_sample;
    seen.largest_size = specimen.largest_size();
    seen.periods = (course.h * course.steps as f64).abs() / course.period;
    let mut solver = match specimen.start(method, course.h) {
        Ok(solver) => solver,
        Err(failure) => {
            seen.ending = Ending::NotStarted { reason: failure.to_string() };
            return seen;
        }
    };
    let start = Snapshot::of(&*solver);
    let mut step = 0;
    while step < course.steps {
        let last = (step + course.steps_per_sample).min(course.steps);
        let at = |step: u64| start.t + step as f64 * course.h;
        let mut before = Snapshot::of(&*solver);
        let outcome = solver.advance_to(at(last - 1)).and_then(|()| {
            before = Snapshot::of(&*solver);
            solver.advance_to(at(last))
        });
        seen.taken = solver.steps();
        if let Err(failure) = outcome {
            seen.ending = ending(&*solver, &failure);
            break;
        }
        step = last;
        seen.steps = step;
        let after = Snapshot::of(&*solver);
        let sample = specimen.look(&start, &after, step);
        let residual = specimen.check(method, course.h, &before, &after, seen.check.steps);
        seen.check.add(step, residual);
        // Written so that a NaN is not.
        let is_near = sample.energy.abs() <= HOPELESS && sample.size <= DIVERGED * seen.largest_size;
        seen.samples.push(sample);
        if !is_near {
            break;
        }
        if seen.taken > course.most_steps {
            seen.ending = Ending::OutOfSteps { step };
            break;
        }
    }
    seen.end = Some(Snapshot::of(&*solver));
    seen
}

fn ending(solver: &dyn Solver, failure: &Failure) -> Ending {
    let step = solver.steps() + 1;
    let reason = failure.to_string();
    match failure.downcast_ref::<StepError>() {
        Some(StepError::NotFinite { .. }) => Ending::NotFinite { step },
        Some(StepError::NoSolution { constraint_residual, smallest_pivot_ratio, .. }) => {
            let (residual, pivot) = (Some(*constraint_residual), Some(*smallest_pivot_ratio));
            Ending::Failed { step, residual, pivot, reason }
        }
        Some(StepError::Singular { matrix, .. }) => {
            Ending::Failed { step, residual: None, pivot: Some(matrix.pivot_ratio), reason }
        }
        _ if matches!(failure.downcast_ref(), Some(Dop853Error::TooManySteps { .. })) => {
            Ending::OutOfSteps { step }
        }
        _ => Ending::Failed { step, residual: None, pivot: None, reason },
    }
}

impl Observation {
    /// Of a run without steps.
    pub(crate) fn nothing() -> Self {
        Self {
            samples: Vec::new(),
            steps_per_sample: 1,
            steps: 0,
            taken: 0,
            periods: 0.0,
            largest_size: 1.0,
            ending: Ending::Complete,
            check: Check::default(),
            end: None,
        }
    }

    /// Whether the budget ended it.
    pub(crate) const fn is_out_of_steps(&self) -> bool {
        matches!(self.ending, Ending::OutOfSteps { .. })
    }

    /// Largest value of a quantity.
    pub(crate) fn largest(&self, quantity: impl Fn(&Sample) -> f64) -> Option<f64> {
        self.samples.iter().map(quantity).map(f64::abs).filter(|value| value.is_finite()).reduce(f64::max)
    }
}

#[cfg(test)]
impl Sample {
    /// Of a state that is as it began.
    pub(crate) const fn at_rest() -> Self {
        Self { step: 0, energy: 0.0, constraint: 0.0, hidden: 0.0, momentum: 0.0, size: 1.0 }
    }
}
