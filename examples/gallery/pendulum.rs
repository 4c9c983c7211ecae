//! Plane pendulum in its angle: the simplest nonlinear scene, without constraints. Energy is conserved.

use evi_core::prelude::*;

/// A point mass on a massless rod; SI units.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(theta),
    kinetic = 0.5 * m * l.powi(2) * der(theta).powi(2),
    potential = -m * g * l * theta.cos(),
)]
pub struct Pendulum {
    /// Mass.
    pub m: f64,
    /// Length of the rod.
    pub l: f64,
    /// Gravitational acceleration.
    pub g: f64,
}
