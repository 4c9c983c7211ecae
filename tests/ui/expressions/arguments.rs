//! Wrong arguments of functions.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(n), potential = x.powi(1.5) + x.powi(1 + 1) + x.powi(2u8))]
struct Exponents { n: f64 }

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(), potential = x.sin(2.0 * x) + x.atan2() + x.powf(1.0, 2.0))]
struct Counts;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential = x.powi(99999999999) + x.powi(-(3000000000)))]
struct LargeExponents;

fn main() {}
