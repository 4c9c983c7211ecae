//! What may not stand in a force, a dissipation, a frequency, an observed quantity; and where inputs may not.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x),
    kinetic = 0.5 * m * der(x).powi(2),
    potential = k * x.powi(2),
    dissipation = c * der(x).powi(2),
    force(x: d * x),
    observe(energy: e),
    frequency(x: (k / mm).sqrt()),
)]
struct Undeclared {
    m: f64,
    k: f64,
}

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y, z, s),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2) + der(z).powi(2) + der(s).powi(2)),
    potential = 0.0,
    let rate = der(x) / m,
    let constant = m.sqrt(),
    frequency(x: der(x)),
    frequency(y: x * constant),
    frequency(z: rate),
    frequency(s: t),
)]
struct FrequenciesThatVary {
    m: f64,
}

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    input(u),
    let power = u * der(x),
    kinetic = 0.5 * u * der(x).powi(2) + der(y).powi(2),
    potential = power,
    dissipation = u * der(x).powi(2),
    constraint(slider: x == u),
    constraint(other: y == power),
    frequency(x: u),
    force(x: der(u)),
)]
struct InputsElsewhere;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x),
    lagrangian = der(x).powi(2),
    dissipation = x.powi(2),
)]
struct DissipationWithoutVelocity;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x),
    lagrangian = der(x).powi(2),
    input(u, w),
    force(x: u),
)]
struct UnusedInput;

fn main() {}
