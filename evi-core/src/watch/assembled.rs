//! Observers of runs of many bodies.

use std::ops::ControlFlow;
use std::string::String;

use super::watched::first_beyond;
use super::{Ended, Observer, Watched};
use crate::assembled::{AssembledRun, AssembledState, AssembledStep, AssembledSystem};
use crate::integrator::Tally;

impl<S: AssembledSystem, M: AssembledStep, T: Tally> Watched for AssembledRun<S, M, T> {
    type Name = String;

    fn time(&self) -> f64 {
        self.state().t()
    }

    fn n_steps(&self) -> u64 {
        self.steps()
    }

    fn total_energy(&self) -> f64 {
        self.energy()
    }

    fn constraint_beyond(&self, budget: f64) -> Option<(String, f64)> {
        let (c, residual) = first_beyond(&self.constraint_residual(), budget)?;
        Some((self.system().constraint_name(c), residual))
    }

    fn hidden_constraint_beyond(&self, budget: f64) -> Option<(String, f64)> {
        let (c, residual) = first_beyond(&self.hidden_constraint_residual(), budget)?;
        Some((self.system().constraint_name(c), residual))
    }
}

impl<S: AssembledSystem, M: AssembledStep, T: Tally> AssembledRun<S, M, T> {
    /// As [`advance_to`](Self::advance_to), under the eyes of an observer: [`Limits`](super::Limits), a bar that shows how far a long run is, a closure.
    /// [`steps_to`](Self::steps_to) says how many steps it will see.
    ///
    /// # Errors
    /// [`Ended::Failed`] as `advance_to` fails; the run stands before the step. [`Ended::Stopped`] with the observer's reason; the run stands at the
    /// state that the observer has seen, and can go on from there.
    pub fn advance_observed<O: Observer<Self>>(
        &mut self,
        t: f64,
        observer: &mut O,
    ) -> Result<&AssembledState, Ended<O::Reason>> {
        for _ in 0..self.steps_to(t)? {
            self.advance()?;
            if let ControlFlow::Break(reason) = observer.see(self) {
                return Err(Ended::Stopped(reason));
            }
        }
        Ok(self.state())
    }
}
