//! What every integrator of the generic path works with, whatever the equations of its steps.

use super::GenericSystem;
use super::derivatives::Derivatives;
use super::kkt::Kkt;
use crate::newton::Statistics;

/// A system with its derivatives, a saddle-point matrix, and buffers.
pub(super) struct Workspace<S> {
    pub(super) derivatives: Derivatives<S>,
    pub(super) kkt: Kkt,
    /// Right-hand side, then solution, of a linear solve: coordinates, then constraints.
    pub(super) unknowns: Vec<f64>,
    /// `Λ` of a step, then `N` of the projection.
    pub(super) impulse: Vec<f64>,
    /// `∂φ/∂t` at the end of the step.
    pub(super) time_rates: Vec<f64>,
    pub(super) statistics: Statistics,
}

impl<S: GenericSystem> Workspace<S> {
    pub(super) fn new(system: S) -> Self {
        let (n, m) = (system.n_coordinates(), system.n_constraints());
        Self {
            derivatives: Derivatives::new(system),
            kkt: Kkt::new(n, m),
            unknowns: vec![0.0; n + m],
            impulse: vec![0.0; m],
            time_rates: vec![0.0; m],
            statistics: Statistics::default(),
        }
    }
}
