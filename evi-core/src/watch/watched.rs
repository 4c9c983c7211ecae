//! What observers of every kind of run ask it.

use core::fmt;

use crate::integrator::{OneStep, Run, Tally};
use crate::system::MechanicalSystem;

/// A run as an observer sees it: a [`Run`], or an [`AssembledRun`](crate::assembled::AssembledRun).
pub trait Watched {
    /// The name of a constraint.
    type Name: Clone + fmt::Debug + fmt::Display;

    /// Time of the state reached.
    fn time(&self) -> f64;

    /// Number of steps taken.
    fn n_steps(&self) -> u64;

    /// Energy of the state reached.
    fn total_energy(&self) -> f64;

    /// The first constraint with a residual beyond `budget`, or none that is a number, and its `φ`.
    fn constraint_beyond(&self, budget: f64) -> Option<(Self::Name, f64)>;

    /// The same for hidden constraints, and `|G v + ∂φ/∂t| / (‖G‖ ‖v‖ + |∂φ/∂t|)`.
    fn hidden_constraint_beyond(&self, budget: f64) -> Option<(Self::Name, f64)>;
}

impl<S: MechanicalSystem, M: OneStep<S>, T: Tally> Watched for Run<S, M, T> {
    type Name = &'static str;

    #[inline]
    fn time(&self) -> f64 {
        self.state().t()
    }

    #[inline]
    fn n_steps(&self) -> u64 {
        self.steps()
    }

    #[inline]
    fn total_energy(&self) -> f64 {
        self.energy()
    }

    fn constraint_beyond(&self, budget: f64) -> Option<(&'static str, f64)> {
        let residuals = self.mechanics().constraint_residual(self.state());
        first_beyond(residuals.as_ref(), budget).map(|(c, residual)| (S::CONSTRAINTS[c], residual))
    }

    fn hidden_constraint_beyond(&self, budget: f64) -> Option<(&'static str, f64)> {
        let residuals = self.mechanics().hidden_constraint_residual(self.state());
        first_beyond(residuals.as_ref(), budget).map(|(c, residual)| (S::CONSTRAINTS[c], residual))
    }
}

/// The first residual that is beyond the budget, and its index.
pub(super) fn first_beyond(residuals: &[f64], budget: f64) -> Option<(usize, f64)> {
    residuals.iter().copied().enumerate().find(|(_, residual)| !is_within(*residual, budget))
}

/// Written so that a NaN is not.
pub(super) fn is_within(x: f64, budget: f64) -> bool {
    x.abs() <= budget
}
