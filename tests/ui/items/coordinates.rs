//! Coordinates that are not names.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(coordinates(r: (3), p: [], s: [f64; 2], n: [0]), kinetic = 0.5 * der(r).norm_squared(), potential = 0.0)]
struct Sizes;

#[derive(MechanicalSystem)]
#[evi(coordinates(x: f64), kinetic = 0.5 * der(x).powi(2), potential = 0.0)]
struct Typed;

#[derive(MechanicalSystem)]
#[evi(coordinates(x y), kinetic = 0.5 * (der(x).powi(2) + der(y).powi(2)), potential = 0.0)]
struct Comma;

#[derive(MechanicalSystem)]
#[evi(coordinates("x", 1.0, y = 2.0), kinetic = 0.5 * der(x).powi(2), potential = 0.0)]
struct Literals;

fn main() {}
