//! Forces and frequencies belong to coordinates, at most one each.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(theta, x),
    lagrangian = der(theta).powi(2) + m * der(x).powi(2),
    let swing = m * x,
    force(thetta: 1.0),
    force(m: 1.0),
    force(swing: 1.0),
    force(t: 1.0),
    frequency(thetta: 1.0),
    frequency(x, m: 1.0),
)]
struct Unknown {
    m: f64,
}

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    lagrangian = der(x).powi(2) + der(y).powi(2),
    input(u),
    force(u: 1.0),
    force(x: u),
    force(x: -der(x)),
    frequency(x: 1.0),
    frequency(y, x: 2.0),
    dissipation = der(x).powi(2),
    dissipation = der(y).powi(2),
)]
struct Twice;

fn main() {}
