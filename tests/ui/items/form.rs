//! Items of a wrong form.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(coordinates(x) kinetic = 0.5 * der(x).powi(2) potential = x constraint(wall: x == 0.0))]
struct Commas;

#[derive(MechanicalSystem)]
#[evi(coordinates(x, y), lagrangian = 0.5 * (der(x).powi(2) + der(y).powi(2)) 2.0)]
struct Rest;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic: 0.5 * der(x).powi(2), potential(x))]
struct Signs;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), let k: f64 = 2.0, let, let (a, b) = x, let c, kinetic == der(x).powi(2), potential += k)]
struct Lets;

#[derive(MechanicalSystem)]
#[evi(coordinates = x, kinetic = 0.5 * der(x).powi(2), potential = x)]
struct Assigned;

fn main() {}
