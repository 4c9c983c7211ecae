//! A name in capitals is a constant, which rustc looks up.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * MASS * der(x).powi(2), potential = 0.0)]
struct Capitals;

fn main() {}
