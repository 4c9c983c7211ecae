//! Recorded motions.

use std::fmt;

use super::StepError;
use crate::mechanics::State;
use crate::system::MechanicalSystem;

/// The states of consecutive steps, the start first, and what the scene observes at each.
pub struct Trajectory<S: MechanicalSystem> {
    states: Vec<State<S>>,
    observed: Vec<S::PerObservable<f64>>,
}

impl<S: MechanicalSystem> Trajectory<S> {
    pub(crate) fn expecting(steps: u64) -> Self {
        /// Beyond this, memory is asked for as the run goes on: an absurd duration must not abort the process.
        const LARGEST_RESERVATION: u64 = 1 << 20;
        let capacity = steps.min(LARGEST_RESERVATION) as usize + 1;
        Self { states: Vec::with_capacity(capacity), observed: Vec::with_capacity(capacity) }
    }

    pub(crate) fn push(&mut self, state: State<S>, observed: S::PerObservable<f64>) {
        self.states.push(state);
        self.observed.push(observed);
    }

    /// The states, in the order of time.
    pub fn states(&self) -> &[State<S>] {
        &self.states
    }

    /// The last state.
    pub fn last(&self) -> &State<S> {
        self.states.last().expect("a trajectory holds its start")
    }

    /// The observed quantities at every state, each in the order of [`OBSERVABLES`](MechanicalSystem::OBSERVABLES).
    pub fn observed(&self) -> &[S::PerObservable<f64>] {
        &self.observed
    }

    /// The values of one observed quantity at every state; `None` if the scene observes nothing of this name.
    pub fn series(&self, name: &str) -> Option<impl ExactSizeIterator<Item = f64> + '_> {
        let index = S::OBSERVABLES.iter().position(|observable| *observable == name)?;
        Some(self.observed.iter().map(move |values| values[index]))
    }
}

// Written out, since a derive would demand the same of `S`, which is a type-level name only.
impl<S: MechanicalSystem> Clone for Trajectory<S> {
    fn clone(&self) -> Self {
        Self { states: self.states.clone(), observed: self.observed.clone() }
    }
}

impl<S: MechanicalSystem> fmt::Debug for Trajectory<S> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let observed: Vec<&[f64]> = self.observed.iter().map(AsRef::as_ref).collect();
        formatter
            .debug_struct("Trajectory")
            .field("states", &self.states)
            .field("observed", &observed)
            .finish()
    }
}

/// A recording that ended before its time, with what had been recorded.
pub struct Interrupted<S: MechanicalSystem> {
    /// Why the next step failed.
    pub error: StepError,
    /// The states up to it.
    pub trajectory: Trajectory<S>,
}

impl<S: MechanicalSystem> fmt::Display for Interrupted<S> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "stopped after {} steps: {}", self.trajectory.states.len() - 1, self.error)
    }
}

impl<S: MechanicalSystem> fmt::Debug for Interrupted<S> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, formatter)
    }
}

impl<S: MechanicalSystem> std::error::Error for Interrupted<S> {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.error)
    }
}
