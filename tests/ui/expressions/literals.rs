//! Wrong numbers.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5f32 * der(x).powi(2), potential = "x" + 1e999 + 2_u8 + 'a' + true)]
struct Literals;

fn main() {}
