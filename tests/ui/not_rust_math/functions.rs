//! Functions called as in other languages.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x),
    kinetic = 0.5 * pow(der(x), 2),
    potential = sin(x) + cos(2.0 * y) + f64::sqrt(x) + atan2(x, 1.0) + x.sin + powi(x, 2),
)]
struct Calls;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential = sum(0..3, |i| x))]
struct Sum;

fn main() {}
