//! Quotients of integers.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 1/2 * der(x).powi(2), potential = 3 / (2) * x + -1/4 + (1 + 2) / 4)]
struct Integers;

fn main() {}
