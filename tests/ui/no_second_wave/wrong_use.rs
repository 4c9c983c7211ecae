//! The uses of a mistaken system are checked: what is wrong in them by itself is reported, too.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(coordinates(x, y), kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)), potential = z)]
struct UnknownName { m: f64 }

fn main() {
    let _: [f64; 3] = [0.0; UnknownName::N_COORDINATES];
}
