//! Similar to a coordinate, to a field, to nothing; twice in one equation.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(coordinates(theta), kinetic = 0.5 * mass * der(thetta).powi(2), potential = 0.0)]
struct Coordinate { mass: f64 }

#[derive(MechanicalSystem)]
#[evi(coordinates(theta), kinetic = 0.5 * masss * der(theta).powi(2) + masss, potential = 0.0)]
struct Field { mass: f64 }

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * u * der(x).powi(2), potential = 0.0)]
struct Nothing { m: f64 }

fn main() {}
