//! One step of the generic path, by whatever integrator.

use super::GenericSystem;
use super::evi_step::EviStages;
use super::galerkin_step::GalerkinPoints;
use super::state::GenericState;
use super::workspace::Workspace;
use crate::integrator::StepError;

/// The equations of a step, prepared for a system.
pub enum Equations {
    /// Of an exponential variational integrator, or of a composition.
    Evi(Box<EviStages>),
    /// Of a Galerkin variational integrator.
    Galerkin(Box<GalerkinPoints>),
}

/// The one-step map with every buffer that it needs.
pub(super) struct GenericStep<S> {
    pub(super) work: Workspace<S>,
    pub(super) equations: Equations,
}

impl<S: GenericSystem> GenericStep<S> {
    /// Overwrites `next` with the state one step after `state`; after an error `next` means nothing.
    pub(super) fn step(&mut self, state: &GenericState, next: &mut GenericState) -> Result<(), StepError> {
        match &mut self.equations {
            Equations::Evi(stages) => stages.step(&mut self.work, state, next),
            Equations::Galerkin(points) => points.step(&mut self.work, state, next),
        }
    }
}
