//! Parameters that are not f64.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x),
    kinetic = 0.5 * mass * der(x).powi(2) + mass,
    potential = counts * x + lengths,
    constraint(wall: x == position),
)]
struct Types { mass: f32, counts: usize, lengths: Vec<f64>, position: &'static str }

fn main() {}
