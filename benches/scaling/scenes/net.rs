//! A square net in space, hung by two of its corners, let go from a horizontal waffle: its pattern has no narrow band.

use evi_core::prelude::*;
use evi_examples::GRAVITY;

use crate::specimen::Specimen;

/// Point masses along a side.
const M: usize = 20;
const N: usize = 400;

/// Mass `M i + j` in row `i` and column `j`, z upwards.
#[derive(MechanicalSystem, Clone, Debug)]
#[evi(
    coordinates(p: [N, 3]),
    kinetic = 0.5 * m * sum(0..N, |i| der(p[i]).norm_squared()),
    potential = m * g * sum(0..N, |i| p[i][2]),
    constraint(near: (p[0] - [0.0, 0.0, hanger]).norm_squared() == hanger.powi(2)),
    constraint(far: (p[M - 1] - [0.0, width, rise + hanger]).norm_squared() == hanger.powi(2)),
    constraint(along[i in 0..M, j in 1..M]: (p[M * i + j] - p[M * i + j - 1]).norm_squared() == l.powi(2)),
    constraint(across[i in 1..M, j in 0..M]: (p[M * i + j] - p[M * i + j - M]).norm_squared() == l.powi(2)),
)]
pub(crate) struct Net {
    m: f64,
    l: f64,
    /// Length of the rods on which the corners hang.
    hanger: f64,
    /// Where the second pivot is, seen from the first, along the side of the net.
    width: f64,
    /// And upwards.
    rise: f64,
    g: f64,
}

/// At rest; neighbours lie 0.06 apart in height, so that no row is stretched out.
pub(crate) fn specimen() -> Specimen<Net> {
    const SPACING: f64 = 0.05;
    const RISE: f64 = 0.06;
    let place = |k: usize| {
        let (row, column) = (k / M, k % M);
        let height = if (row + column) % 2 == 0 { 0.0 } else { RISE };
        [SPACING * row as f64, SPACING * column as f64, height]
    };
    let (l, hanger) = (SPACING.hypot(RISE), 0.2);
    let system =
        Net { m: 1.0 / N as f64, l, hanger, width: SPACING * (M - 1) as f64, rise: RISE, g: GRAVITY };
    Specimen::at_rest("net", N, l, system, (0..N).flat_map(place).collect())
}
