//! Budgets of a run: energy, constraints, steps, time.

use core::ops::ControlFlow;
#[cfg(feature = "std")]
use std::time::{Duration, Instant};

use super::watched::is_within;
use super::{Observer, Watched};

/// Stops a run that leaves its budgets. One that is not set costs nothing.
///
/// A quantity that is not a number is beyond every budget.
///
/// ```
/// use evi_core::prelude::*;
/// use evi_core::watch::{Ended, Limits, Stopped};
/// # #[derive(MechanicalSystem)]
/// # #[evi(coordinates(theta), kinetic = 0.5 * der(theta).powi(2), potential = -rate.powi(2) * theta.cos())]
/// # struct Pendulum { rate: f64 }
/// let mut run = Simulation::new(Pendulum { rate: 3.0 }, Evi::midpoint(0.1)).start([2.0], [0.0])?;
/// let mut limits = Limits::of(&run).energy_change(1e-2).wall_time(std::time::Duration::from_secs(60));
/// match run.advance_observed(10.0, &mut limits) {
///     Err(Ended::Stopped(Stopped::Energy { change, budget, .. })) => assert!(change.abs() > budget),
///     other => panic!("{other:?}"),
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    start_energy: f64,
    start_steps: u64,
    energy: Option<f64>,
    constraint: Option<f64>,
    hidden_constraint: Option<f64>,
    steps: Option<u64>,
    #[cfg(feature = "std")]
    begun: Instant,
    #[cfg(feature = "std")]
    wall_time: Option<Duration>,
}

/// Which budget a run has left, and by how much. The run stands at the state that these numbers belong to. Constraints of scenes of many bodies have
/// names that are put together: `Stopped<String>`.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Stopped<N = &'static str> {
    /// The energy has changed by more than its budget.
    #[error("at t = {t:?} the energy has changed by {change:e}, its budget is {budget:e}")]
    Energy {
        /// Time of the state.
        t: f64,
        /// `H − H₀`.
        change: f64,
        /// The largest change that passes.
        budget: f64,
    },
    /// A constraint is violated by more than its budget.
    #[error("at t = {t:?} constraint `{constraint}` is violated by {residual:e}, its budget is {budget:e}")]
    Constraint {
        /// Time of the state.
        t: f64,
        /// Name of the constraint.
        constraint: N,
        /// `φ`, in the units of the constraint as written.
        residual: f64,
        /// The largest magnitude that passes.
        budget: f64,
    },
    /// The velocity leaves a constraint by more than its budget.
    #[error(
        "at t = {t:?} the velocity leaves constraint `{constraint}`: G v + ∂φ/∂t is {residual:e} of its terms, its budget is \
         {budget:e}"
    )]
    HiddenConstraint {
        /// Time of the state.
        t: f64,
        /// Name of the constraint.
        constraint: N,
        /// `|G v + ∂φ/∂t| / (‖G‖ ‖v‖ + |∂φ/∂t|)`.
        residual: f64,
        /// The largest that passes.
        budget: f64,
    },
    /// The run has taken its steps.
    #[error("{steps} steps have been taken")]
    Steps {
        /// Number of steps since the limits were set.
        steps: u64,
    },
    /// The run has taken its time.
    #[cfg(feature = "std")]
    #[error("{elapsed:?} have passed, the budget is {budget:?}")]
    WallTime {
        /// Time since the limits were set.
        elapsed: Duration,
        /// The time that the run may take.
        budget: Duration,
    },
}

impl Limits {
    /// No limits yet, for a run from where it stands: its energy is the one that changes are counted from, and time runs from now.
    pub fn of<R: Watched>(run: &R) -> Self {
        Self {
            start_energy: run.total_energy(),
            start_steps: run.n_steps(),
            energy: None,
            constraint: None,
            hidden_constraint: None,
            steps: None,
            #[cfg(feature = "std")]
            begun: Instant::now(),
            #[cfg(feature = "std")]
            wall_time: None,
        }
    }

    /// The energy may change by so much, in its own unit.
    #[must_use]
    pub const fn energy_change(self, budget: f64) -> Self {
        Self { energy: Some(budget), ..self }
    }

    /// The energy may change by this fraction of its magnitude at the start. Where that is 0, or far from the energies that the motion exchanges, an
    /// [`energy_change`](Self::energy_change) says more.
    #[must_use]
    pub const fn relative_energy_change(self, fraction: f64) -> Self {
        Self { energy: Some(fraction * self.start_energy.abs()), ..self }
    }

    /// Every `|φ|` may be so large, in the units of the constraints as written.
    #[must_use]
    pub const fn constraint(self, budget: f64) -> Self {
        Self { constraint: Some(budget), ..self }
    }

    /// Every `|G v + ∂φ/∂t|` may be this fraction of its terms; see
    /// [`hidden_constraint_residual`](crate::mechanics::Mechanics::hidden_constraint_residual).
    #[must_use]
    pub const fn hidden_constraint(self, budget: f64) -> Self {
        Self { hidden_constraint: Some(budget), ..self }
    }

    /// The run may take so many steps from here.
    #[must_use]
    pub const fn steps(self, steps: u64) -> Self {
        Self { steps: Some(steps), ..self }
    }

    /// The run may take so much time from here. The clock is read after every step: where a step takes nanoseconds, rather by
    /// [`every`](super::every)`(1000, limits)`.
    #[cfg(feature = "std")]
    #[must_use]
    pub const fn wall_time(self, budget: Duration) -> Self {
        Self { wall_time: Some(budget), ..self }
    }

    /// What the run has left, if anything.
    fn left<R: Watched>(&self, run: &R) -> Option<Stopped<R::Name>> {
        let t = run.time();
        if let Some(budget) = self.energy {
            let change = run.total_energy() - self.start_energy;
            if !is_within(change, budget) {
                return Some(Stopped::Energy { t, change, budget });
            }
        }
        if let Some(budget) = self.constraint
            && let Some((constraint, residual)) = run.constraint_beyond(budget)
        {
            return Some(Stopped::Constraint { t, constraint, residual, budget });
        }
        if let Some(budget) = self.hidden_constraint
            && let Some((constraint, residual)) = run.hidden_constraint_beyond(budget)
        {
            return Some(Stopped::HiddenConstraint { t, constraint, residual, budget });
        }
        // A run that was resumed may stand before the one that the limits were made for.
        let steps = run.n_steps().saturating_sub(self.start_steps);
        if self.steps.is_some_and(|budget| steps >= budget) {
            return Some(Stopped::Steps { steps });
        }
        #[cfg(feature = "std")]
        if let Some(budget) = self.wall_time {
            let elapsed = self.begun.elapsed();
            if elapsed >= budget {
                return Some(Stopped::WallTime { elapsed, budget });
            }
        }
        None
    }
}

impl<R: Watched> Observer<R> for Limits {
    type Reason = Stopped<R::Name>;

    #[inline]
    fn see(&mut self, run: &R) -> ControlFlow<Stopped<R::Name>> {
        match self.left(run) {
            Some(stopped) => ControlFlow::Break(stopped),
            None => ControlFlow::Continue(()),
        }
    }
}
