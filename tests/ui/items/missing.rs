//! What is not there.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
struct NoAttribute { m: f64 }

#[derive(MechanicalSystem)]
#[evi]
struct NoList;

#[derive(MechanicalSystem)]
#[evi = "x"]
struct Value;

#[derive(MechanicalSystem)]
#[evi()]
struct Empty;

#[derive(MechanicalSystem)]
#[evi(let a = 1.0)]
struct Everything;

#[derive(MechanicalSystem)]
#[evi(coordinates(x))]
struct Lagrangian;

#[derive(MechanicalSystem)]
#[evi(kinetic = 0.5 * m * der(x).powi(2), potential = m * x)]
struct Coordinates { m: f64 }

#[derive(MechanicalSystem)]
#[evi(coordinates(), kinetic = 0.5 * m * der(x).powi(2), potential = m * x)]
struct NoCoordinate { m: f64 }

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2))]
struct Potential;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), potential = x)]
struct Kinetic;

fn main() {}
