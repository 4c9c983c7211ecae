//! Methods that the grammar does not have.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential = x.sinn())]
struct Similar;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential = x.gamma())]
struct Unlike;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential = x.norm())]
struct OfVectors;

fn main() {}
