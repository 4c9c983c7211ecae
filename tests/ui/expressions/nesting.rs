//! Expressions that nest deeper than the compiler recurses safely.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x),
    kinetic = 0.5 * der(x).powi(2),
    potential = ((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((x)))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))),
)]
struct Parentheses;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x),
    kinetic = 0.5 * der(x).powi(2),
    potential = ----------------------------------------------------------------x,
)]
struct Signs;

fn main() {}
