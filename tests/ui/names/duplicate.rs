//! Names that are given twice.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(coordinates(x, y, x), kinetic = 0.5 * (der(x).powi(2) + der(y).powi(2)), potential = x)]
struct Coordinates;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential = x)]
struct CoordinateAndField { x: f64 }

#[derive(MechanicalSystem)]
#[evi(coordinates(x), let m = 2.0, let a = m, let a = x, kinetic = 0.5 * m * der(x).powi(2), potential = a)]
struct Lets { m: f64 }

fn main() {}
