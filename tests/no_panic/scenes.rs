//! Scenes for the kinds of steps that the gallery has none for.

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

/// A bead on a circle beside the origin, in polar coordinates: a constraint, and a mass that depends on where it is.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(r, phi),
    kinetic = 0.5 * m * (der(r).powi(2) + r.powi(2) * der(phi).powi(2)),
    potential = m * g * r * phi.sin(),
    constraint(circle: r.powi(2) - 2.0 * r * c * phi.cos() + c.powi(2) == l.powi(2)),
)]
pub struct PolarBead {
    pub m: f64,
    pub c: f64,
    pub l: f64,
    pub g: f64,
}
