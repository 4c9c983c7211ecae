//! Velocities in a holonomic constraint.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    lagrangian = 0.5 * (der(x).powi(2) + der(y).powi(2)),
    constraint(rolling: der(x) == radius * der(y)),
)]
struct Direct { radius: f64 }

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    let speed = der(x) - der(y),
    let twice = 2.0 * speed,
    lagrangian = 0.5 * (der(x).powi(2) + der(y).powi(2)),
    constraint(rolling: x + twice == 0.0),
)]
struct ThroughLets;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    lagrangian = 0.5 * (der(x).powi(2) + der(y).powi(2)),
    constraint(rolling: { let speed = der(x); x + speed } == 0.0),
)]
struct ThroughBlock;

fn main() {}
