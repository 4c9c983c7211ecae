//! A scene for every kind of step.

use evi_core::prelude::*;

/// Quadratic Lagrangian, two rods: folded steps.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(x1, y1, x2, y2),
    kinetic   = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2))
              + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2)),
    potential = g * (m1 * y1 + m2 * y2),
    constraint(rod1: x1.powi(2) + y1.powi(2) == l1.powi(2)),
    constraint(rod2: (x2 - x1).powi(2) + (y2 - y1).powi(2) == l2.powi(2)),
)]
pub struct DoublePendulum {
    pub m1: f64,
    pub m2: f64,
    pub l1: f64,
    pub l2: f64,
    pub g: f64,
}

/// A bob on a spring: a potential that is not quadratic, no constraint.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = m * g * y + 0.5 * k * ((x.powi(2) + y.powi(2)).sqrt() - l).powi(2),
)]
pub struct SpringPendulum {
    pub m: f64,
    pub l: f64,
    pub k: f64,
    pub g: f64,
}

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
pub struct DrivenPendulum {
    pub m: f64,
    pub l: f64,
    pub c: f64,
    pub w: f64,
    pub g: f64,
}
