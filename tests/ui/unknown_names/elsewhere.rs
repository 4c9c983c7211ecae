//! In every place that holds an equation.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(coordinates(theta), lagrangian = 0.5 * der(theta).powi(2) + thetta.cos())]
struct Lagrangian;

#[derive(MechanicalSystem)]
#[evi(coordinates(theta), kinetic = 0.5 * der(theta).powi(2), potential = -gravty * theta.cos())]
struct Potential { gravity: f64 }

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    lagrangian = 0.5 * (der(x).powi(2) + der(y).powi(2)),
    constraint(rod: x.powi(2) + z.powi(2) == lenght.powi(2)),
)]
struct Constraint { length: f64 }

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x),
    let speed = der(x) + velocity,
    lagrangian = 0.5 * speed.powi(2),
)]
struct Let { wind: f64 }

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x),
    let speed = der(x),
    lagrangian = { let twice = 2.0 * sped; 0.25 * twise * twice },
)]
struct Block;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x),
    kinetic = 0.5 * speed.powi(2),
    let speed = der(x),
    let sum = sum + 1.0,
    potential = x,
)]
struct DefinedBelow;

fn main() {}
