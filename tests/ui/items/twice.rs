//! What is there too often.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), kinetic = der(x).powi(2), potential = 0.0, potential = x)]
struct Energies;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), coordinates(y), lagrangian = der(x).powi(2), lagrangian = der(x).powi(2))]
struct Coordinates;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), lagrangian = der(x).powi(2) - x, kinetic = der(x).powi(2))]
struct Both;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), lagrangian = der(x).powi(2) - x, potential = x)]
struct LagrangianAndPotential;

fn main() {}
