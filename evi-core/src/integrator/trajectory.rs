//! Recorded motions.

use std::fmt;

use super::StepError;
use crate::mechanics::State;
use crate::system::MechanicalSystem;

/// The states of consecutive steps, the start first.
#[derive(Debug, Clone)]
pub struct Trajectory<S: MechanicalSystem> {
    states: Vec<State<S>>,
}

impl<S: MechanicalSystem> Trajectory<S> {
    pub(crate) fn starting_at(state: State<S>, expected_steps: u64) -> Self {
        /// Beyond this, memory is asked for as the run goes on: an absurd duration must not abort the process.
        const LARGEST_RESERVATION: u64 = 1 << 20;
        let mut states = Vec::with_capacity(expected_steps.min(LARGEST_RESERVATION) as usize + 1);
        states.push(state);
        Self { states }
    }

    pub(crate) fn push(&mut self, state: State<S>) {
        self.states.push(state);
    }

    /// The states, in the order of time.
    pub fn states(&self) -> &[State<S>] {
        &self.states
    }

    /// The last state.
    pub fn last(&self) -> &State<S> {
        self.states.last().expect("a trajectory holds its start")
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
