//! Coordinates without mass.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(coordinates(x, y, z), kinetic = 0.5 * der(x).powi(2), potential = y + z)]
struct Kinetic;

#[derive(MechanicalSystem)]
#[evi(coordinates(x, y), lagrangian = 0.5 * der(y).powi(2) - x)]
struct Lagrangian;

fn main() {}
