//! A closed ring of rods that hangs from a pivot by one more rod, let go as a circle.

use std::f64::consts::{PI, TAU};

use evi_core::prelude::*;
use evi_examples::GRAVITY;

use crate::specimen::Specimen;

const N: usize = 100;

/// Point masses on a circle of circumference 1, the first at its top.
#[derive(MechanicalSystem, Clone, Debug)]
#[evi(
    coordinates(p: [N, 2]),
    kinetic = 0.5 * m * sum(0..N, |i| der(p[i]).norm_squared()),
    potential = m * g * sum(0..N, |i| p[i][1]),
    constraint(hanger: p[0].norm_squared() == hanger.powi(2)),
    constraint(link[i in 1..N]: (p[i] - p[i - 1]).norm_squared() == l.powi(2)),
    constraint(closing: (p[0] - p[N - 1]).norm_squared() == l.powi(2)),
)]
pub(crate) struct Ring {
    m: f64,
    l: f64,
    hanger: f64,
    g: f64,
}

/// At rest, the hanger a little off the vertical: neither symmetry nor a stretched-out rod.
pub(crate) fn specimen() -> Specimen<Ring> {
    let l = 1.0 / N as f64;
    let radius = 0.5 * l / (PI / N as f64).sin();
    let system = Ring { m: l, l, hanger: 0.05, g: GRAVITY };
    let top = [0.03, -0.04];
    let place = |i: usize| {
        let (sin, cos) = (TAU * i as f64 / N as f64).sin_cos();
        [top[0] + radius * sin, top[1] - radius * (1.0 - cos)]
    };
    Specimen::at_rest("ring", N, l, system, (0..N).flat_map(place).collect())
}
