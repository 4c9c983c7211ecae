//! Steps that know their derivative.

use super::parameters::Seeds;
use super::{DerivativeError, StateGradient, StateTangent};
use crate::integrator::{OneStep, Tally};
use crate::mechanics::State;
use crate::system::MechanicalSystem;

/// What a gradient that goes back through a step needs beside the step: the constants of the scene with their rates by the chosen parameters.
pub struct Backwards<'a, S: MechanicalSystem>(pub(super) &'a Seeds<S>);

/// A one-step map with its derivative, by the implicit function theorem on the equations that the step has solved.
///
/// The derivative is that of the discrete map itself, not of the motion that it approximates: it is symplectic on the tangent space of the
/// constraint manifold as the step is, and gradients are those of the computed result to round-off.
#[diagnostic::on_unimplemented(
    message = "the steps of `{Self}` have no derivative",
    label = "not differentiable",
    note = "those of `Evi`, `MatrixEvi`, `Galerkin`, `Gauss` and of their compositions have one"
)]
pub trait Differentiable<S: MechanicalSystem>: OneStep<S> {
    /// A step that was taken.
    type Taken;
    /// Storage for the matrices of derivatives.
    type Workspace;

    /// Whether steps can be differentiated by parameters.
    ///
    /// # Errors
    /// [`DerivativeError::Parameters`] for schemes whose tables follow the parameters.
    fn check_parameters(&self) -> Result<(), DerivativeError> {
        Ok(())
    }

    /// The storage, made once per run.
    fn workspace(&self) -> Self::Workspace;

    /// Takes a step as [`OneStep::advance`] does, to the last bit, and keeps what its derivative is made of.
    ///
    /// # Errors
    /// [`DerivativeError`]; the state has not changed then.
    fn advance_taking_notes(
        &mut self,
        workspace: &mut Self::Workspace,
        state: &mut State<S>,
        tally: &mut impl Tally,
    ) -> Result<Self::Taken, DerivativeError>;

    /// Moves vectors at the start of the step to its end.
    ///
    /// # Errors
    /// [`DerivativeError::Singular`] where the equations of the step do not determine its derivative.
    fn push_forward(
        &self,
        workspace: &mut Self::Workspace,
        taken: &Self::Taken,
        tangents: &mut [StateTangent<S>],
    ) -> Result<(), DerivativeError>;

    /// Moves a gradient at the end of the step to its start, and adds to it what the parameters and the inputs of the step make of it.
    ///
    /// # Errors
    /// As for [`push_forward`](Self::push_forward).
    fn pull_back(
        &self,
        workspace: &mut Self::Workspace,
        taken: &Self::Taken,
        backwards: &Backwards<'_, S>,
        gradient: &mut StateGradient<S>,
    ) -> Result<(), DerivativeError>;
}
