//! Mistakes of different kinds in one struct: all at once, in the order of the source.

use evi_core::prelude::*;

/// A pendulum that does not swing.
#[derive(MechanicalSystem, Clone, Debug)]
#[evi(
    coordinates(x, y, x),
    let height = z + 1,
    kinetic   = 1/2 * mass * (der(x)^2 + der(y).powi(2)),
    potental = masss * height,
)]
#[evi(
    constraint(rod: x.powi(2) + y.powi(2) = length.powi(2)),
    constraint(rod: sin(x) == der(y)),
    constraint(wall: 1e999 == +),
    friction = 0.5,
)]
pub struct Pendulum {
    pub mass: f64,
    pub length: f32,
    pub t: f64,
}

fn main() {}
