//! Items that are not written as they must be.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y, z),
    lagrangian = der(x).powi(2) + der(y).powi(2) + der(z).powi(2),
    force = 1.0,
    force(1.0),
    force(x, y: 1.0),
    force(z:),
    force(y x: 1.0),
    dissipation(der(x).powi(2)),
    frequency(2.0),
    frequency(x = 2.0),
    observe(x + y),
    observe(sum, difference: x + y),
    input(),
    input(u = 1.0),
    input(fn),
    forse(w: 1.0),
)]
struct Forms;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x),
    lagrangian = der(x).powi(2)
    force(x: u)
    input(u)
    dissipation = der(x).powi(2)
    observe(height: x)
    frequency(x: 1.0)
)]
struct NoCommas;

fn main() {}
