//! Names that have a meaning.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential = t * x)]
struct Field { t: f64 }

#[derive(MechanicalSystem)]
#[evi(coordinates(t), kinetic = 0.5 * der(t).powi(2), potential = t)]
struct Coordinate;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), let der = 0.5, let t = x, kinetic = der * der(x).powi(2), potential = t)]
struct Let;

#[derive(MechanicalSystem)]
#[evi(coordinates(x, type, self), let mut = 0.5, kinetic = 0.5 * der(x).powi(2), potential = 0.0)]
struct Keywords;

fn main() {}
