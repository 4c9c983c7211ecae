//! Items that do not exist.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(coordinate(x), kinetik = 0.5 * der(x).powi(2), potental = x, constrain(wall: x = 0.0))]
struct Similar;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), T = 0.5 * der(x).powi(2), V = x)]
struct Unlike;

#[derive(MechanicalSystem)]
#[evi(0.5 * der(x).powi(2), (x), coordinates(x), lagrangian = der(x).powi(2))]
struct NoKeyword;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), lagrangian = 0.5 * m * der(x).powi(2))]
struct OnField { #[evi(default = 1.0)] m: f64 }

fn main() {}
