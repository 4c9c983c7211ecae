//! Names that are taken or reserved.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x),
    lagrangian = m * der(x).powi(2),
    input(m, x, t, u, u),
    force(x: u),
    observe(height: x),
    observe(height: 2.0 * x),
    let u = x,
)]
struct Taken {
    m: f64,
}

fn main() {}
