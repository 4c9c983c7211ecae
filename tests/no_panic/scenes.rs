//! A scene for the kind of step that the gallery has none for.

use evi_core::prelude::*;

/// A rod whose pivot moves, with friction and a motor.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = m * g * y,
    constraint(rod: (x - 0.1 * (w * t).sin()).powi(2) + y.powi(2) == l.powi(2)),
    dissipation = 0.5 * c * (der(x).powi(2) + der(y).powi(2)),
    input(push),
    force(x: push),
)]
pub struct CarriedPendulum {
    pub m: f64,
    pub l: f64,
    pub c: f64,
    pub w: f64,
    pub g: f64,
}
