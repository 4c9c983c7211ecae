//! Derivatives of compositions: those of their stages, one after the other.

use super::{Backwards, DerivativeError, Differentiable, StateGradient, StateTangent};
use crate::integrator::{ComposedStep, Tally};
use crate::mechanics::State;
use crate::system::MechanicalSystem;

impl<S: MechanicalSystem, M: Differentiable<S>, const N: usize> Differentiable<S> for ComposedStep<S, M, N> {
    /// One per stage.
    type Taken = [Option<M::Taken>; N];
    type Workspace = [M::Workspace; N];

    fn check_parameters(&self) -> Result<(), DerivativeError> {
        self.stages().iter().try_for_each(M::check_parameters)
    }

    fn workspace(&self) -> Self::Workspace {
        core::array::from_fn(|stage| self.stages()[stage].workspace())
    }

    fn advance_taking_notes(
        &mut self,
        workspace: &mut Self::Workspace,
        state: &mut State<S>,
        tally: &mut impl Tally,
    ) -> Result<Self::Taken, DerivativeError> {
        let mut taken = [const { None }; N];
        let mut notes = taken.iter_mut().zip(workspace);
        self.take_stages(state, |stage, reached| {
            if let Some((note, workspace)) = notes.next() {
                *note = Some(stage.advance_taking_notes(workspace, reached, tally)?);
            }
            Ok::<_, DerivativeError>(())
        })?;
        Ok(taken)
    }

    fn push_forward(
        &self,
        workspace: &mut Self::Workspace,
        taken: &Self::Taken,
        tangents: &mut [StateTangent<S>],
    ) -> Result<(), DerivativeError> {
        for ((stage, workspace), taken) in self.stages().iter().zip(workspace).zip(taken) {
            if let Some(taken) = taken {
                stage.push_forward(workspace, taken, tangents)?;
            }
        }
        Ok(())
    }

    fn pull_back(
        &self,
        workspace: &mut Self::Workspace,
        taken: &Self::Taken,
        backwards: &Backwards<'_, S>,
        gradient: &mut StateGradient<S>,
    ) -> Result<(), DerivativeError> {
        for ((stage, workspace), taken) in self.stages().iter().zip(workspace).zip(taken).rev() {
            if let Some(taken) = taken {
                stage.pull_back(workspace, taken, backwards, gradient)?;
            }
        }
        Ok(())
    }
}
