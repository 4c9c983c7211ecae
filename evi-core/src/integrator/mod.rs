//! One-step maps `(q, p) → (q, p)` and runs of many steps.
//!
//! A [`Scheme`] is what a user writes down (nodes, frequency, step size). Prepared for a scene, it is a
//! [`OneStep`] map that holds everything that is constant for the run. A [`Simulation`] joins a scene with a scheme;
//! a [`Run`] is a simulation at a state.

#[cfg(feature = "std")]
mod checkpoint;
mod compensated;
mod composition;
mod curves;
mod evi;
#[cfg(feature = "std")]
mod galerkin;
#[cfg(feature = "std")]
mod gauss;
mod matrix_evi;
mod multipliers;
mod of_rank;
mod positions;
#[cfg(feature = "std")]
mod proposal;
mod rank_check;
mod rescue;
mod run;
mod simulation;
#[cfg(feature = "std")]
mod trajectory;

#[cfg(feature = "generic")]
pub(crate) use crate::mechanics::CONSISTENCY;
pub use crate::newton::{Diagnostics, Fallbacks, Statistics, Tally, Worst};
#[cfg(feature = "std")]
pub use checkpoint::{Checkpoint, ResumeError};
#[cfg(feature = "std")]
pub(crate) use checkpoint::{Fingerprint, recall, recorded, without_paths};
pub use compensated::{Compensable, CompensableStep, Compensated, CompensatedStep};
pub use composition::{Composed, ComposedStep, Composition, Symmetric};
pub use evi::{Evi, EviStep};
#[cfg(feature = "std")]
pub use galerkin::{Galerkin, GalerkinStep, Iteration};
#[cfg(feature = "std")]
pub(crate) use galerkin::{NewtonSolve, ROUGH};
#[cfg(feature = "std")]
pub(crate) use gauss::GaussNewton;
#[cfg(feature = "std")]
pub use gauss::{Gauss, GaussStep};
#[cfg(feature = "std")]
pub(crate) use matrix_evi::Form;
pub use matrix_evi::{
    LinearisedAlong, LinearisedAt, MatrixEvi, MatrixEviStep, QuadraticModel, StepMode, Stiffness,
};
#[cfg(feature = "std")]
pub(crate) use multipliers::{MultiplierStep, TRUSTED};
pub use of_rank::OfRank;
#[cfg(feature = "std")]
pub use proposal::{LONGEST_TRIAL, Member, PASSES_OF_NEWTON, Proposal, ProposalError, propose};
pub use rescue::{Rescued, RescuedStep, Rescues};
#[cfg(feature = "std")]
pub(crate) use rescue::{depends_on_length, n_parts};
pub use run::Run;
#[cfg(feature = "std")]
pub(crate) use run::steps_between;
#[cfg(feature = "std")]
pub(crate) use simulation::consistent_start;
pub use simulation::{ConstraintLabel, Simulation, StartError};
#[cfg(feature = "std")]
pub use trajectory::{Interrupted, Trajectory};

use crate::linear::SingularMatrix;
use crate::mechanics::{Mechanics, NOTHING, ProjectionError, State};
use crate::memory::Memory;
use crate::newton::NotConverged;
use crate::scheme::SchemeError;
use crate::system::MechanicalSystem;

/// A recipe for steps, independent of the scene.
pub trait Scheme<S: MechanicalSystem> {
    /// The one-step map of this scheme for `S`.
    type Step: OneStep<S>;

    /// Folds everything that is constant for a run into the one-step map.
    ///
    /// # Errors
    /// [`SchemeError`] for a scheme that defines no step for this scene.
    fn prepare(&self, mechanics: Mechanics<S>) -> Result<Self::Step, SchemeError>;
}

/// A map from the state at `t` to the state at `t + h`, with a [`Memory`] of the steps before.
pub trait OneStep<S: MechanicalSystem>: Memory {
    /// Step size; negative for a map that goes back in time.
    fn h(&self) -> f64;

    /// The scene that moves.
    fn mechanics(&self) -> &Mechanics<S>;

    /// Overwrites `state` with the state one step later, and tells `tally` what has happened on the way.
    ///
    /// # Errors
    /// [`StepError`] when there is no such state or it is not found; `state` has not changed then.
    fn advance(&mut self, state: &mut State<S>, tally: &mut impl Tally) -> Result<(), StepError>;
}

/// A step that could not be taken. The state before the step stands.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepError {
    /// Newton's iteration found no end point: the step equations may have none near the start.
    #[error(
        "no solution of the step found from t = {t:?}: after {corrections} corrections the last one is \
         {last_correction:e} of the configuration, the residual of the constraints {constraint_residual:e}, \
         the smallest pivot ratio {smallest_pivot_ratio:e}. Try a smaller step size"
    )]
    NoSolution {
        /// Time at the start of the step.
        t: f64,
        /// Number of Newton corrections.
        corrections: usize,
        /// Length of the last one relative to the configuration; not finite if the iteration diverged.
        last_correction: f64,
        /// Largest constraint residual at the last iterate.
        constraint_residual: f64,
        /// Smallest ratio of pivots met on the way; of the last matrix where only multipliers are iterated.
        smallest_pivot_ratio: f64,
    },
    /// The matrix of the step equations is singular: the constraints are dependent at this configuration, or the
    /// mass matrix does not determine the motion.
    #[error("singular step equations from t = {t:?}, correction {correction}: {matrix}")]
    Singular {
        /// Time at the start of the step.
        t: f64,
        /// Number of the Newton correction.
        correction: usize,
        /// The numbers of the matrix.
        matrix: SingularMatrix,
    },
    /// The momentum at the end of the step could not be projected on the constraints.
    #[error("the velocity at t = {t:?} cannot be projected on the constraints: {cause}")]
    Projection {
        /// Time at the end of the step.
        t: f64,
        /// Why.
        cause: ProjectionError,
    },
    /// An input is not finite.
    #[error("the input `{name}` of the step is {value:?}")]
    Input {
        /// The input.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The time to move to is no number of steps away: not finite, or farther than a float counts steps.
    #[error("t = {target:?} cannot be reached in steps of h = {h:?}")]
    UnreachableTime {
        /// The time to move to.
        target: f64,
        /// Step size.
        h: f64,
    },
    /// The time to move to lies on the other side of where steps of this sign lead.
    #[error("t = {target:?} is not ahead of t = {t:?} in steps of h = {h:?}: with h = {:?} it is", -.h)]
    OppositeTime {
        /// The time reached.
        t: f64,
        /// The time to move to.
        target: f64,
        /// Step size.
        h: f64,
    },
    /// At the end of the step constraints contradict each other, of which some were stated to follow from the others
    /// ([`OfRank`]).
    #[error(
        "constraints contradict each other at t = {t:?}: where as many hold as are independent, constraint {constraint} has the residual \
         {residual:e}, allowed {allowed:e}"
    )]
    ContradictoryConstraints {
        /// Time at the end of the step.
        t: f64,
        /// A constraint that does not hold.
        constraint: ConstraintLabel,
        /// Its residual.
        residual: f64,
        /// Largest residual that passes.
        allowed: f64,
    },
    /// The end of the step is not finite.
    #[error("the state at t = {t:?} is not finite")]
    NotFinite {
        /// Time at the end of the step.
        t: f64,
    },
}

/// Why a Newton iteration inside a step ended, before the numbers that explain it are gathered.
pub(crate) enum IterationFailure {
    Singular { correction: usize, matrix: SingularMatrix },
    NotConverged(NotConverged),
}

impl From<NotConverged> for IterationFailure {
    fn from(failure: NotConverged) -> Self {
        Self::NotConverged(failure)
    }
}

impl IterationFailure {
    /// The step error of this failure, with the numbers at the last iterate.
    pub(crate) fn at(self, t: f64, constraint_residual: f64, smallest_pivot_ratio: f64) -> StepError {
        match self {
            Self::Singular { correction, matrix } => StepError::Singular { t, correction, matrix },
            Self::NotConverged(NotConverged { corrections, last_correction }) => StepError::NoSolution {
                t,
                corrections,
                last_correction,
                constraint_residual,
                smallest_pivot_ratio,
            },
        }
    }
}

impl<S: MechanicalSystem> State<S> {
    /// Overwrites the state but for the inputs, if every number of the new one is finite.
    #[inline]
    pub(crate) fn replace(
        &mut self,
        t: f64,
        q: S::PerCoordinate<f64>,
        v: S::PerCoordinate<f64>,
        p: S::PerCoordinate<f64>,
    ) -> Result<(), StepError> {
        // A sum is finite only if all of its terms are; only numbers near the largest one overflow together.
        let mut sum = NOTHING;
        for i in 0..S::N_COORDINATES {
            sum += q[i] + v[i] + p[i];
        }
        // Written so that a NaN is refused; `is_finite` takes twice the instructions.
        let is_finite = sum.abs() < f64::INFINITY;
        if !is_finite {
            return Err(StepError::NotFinite { t });
        }
        (self.t, self.q, self.v, self.p) = (t, q, v, p);
        Ok(())
    }
}
