//! A net of springs between its knots, on an elastic ground with a fixed edge: neighbours along two indices, stiffness row by row. Waves run through it, fast
//! across its knots, and the ground holds every knot with a frequency of its own row.

use evi_core::prelude::*;

use crate::LoopScene;

/// Knots along a side.
const N: usize = 20;

/// Square net, knot `(i, j)` at height `z[i, j]`; the edge `j = 0` is held by rods of no length.
#[derive(MechanicalSystem, Clone, Debug)]
#[evi(
    coordinates(z: [N, N]),
    kinetic = 0.5 * m * sum(0..N, |i| sum(0..N, |j| der(z[i][j]).powi(2))),
    potential = 0.5 * sum(0..N, |i| ground[i] * sum(0..N, |j| z[i][j].powi(2)))
        + 0.25 * k * (sum(0..N, |i| sum(1..N, |j| (z[i][j] - z[i][j - 1]).powi(4)))
            + sum(1..N, |i| sum(0..N, |j| (z[i][j] - z[i - 1][j]).powi(4)))),
    constraint(edge[i in 0..N]: z[i][0] == 0.0),
    frequency(z[i in 0..N, j in 0..N]: (ground[i] / m).sqrt()),
    observe(middle: z[10][10]),
)]
pub struct Net {
    /// Mass of a knot, kg.
    pub m: f64,
    /// Stiffness of the springs between neighbours, N/m³.
    pub k: f64,
    /// Stiffness of the ground under every row, N/m.
    pub ground: [f64; N],
}

impl LoopScene for Net {
    const NAME: &'static str = "net";
    const SUMMARY: &'static str = "a net of 20 × 20 knots on an elastic ground, pushed in from one side";

    fn standard() -> (Self, Vec<f64>) {
        let heights = (0..N * N).map(|k| {
            let (row, column) = ((k / N) as f64, (k % N) as f64);
            0.1 * column * (-0.05 * (row - 6.0) * (row - 6.0)).exp()
        });
        let ground = std::array::from_fn(|i| 4.0 + 0.5 * i as f64);
        (Self { m: 0.1, k: 30.0, ground }, heights.collect())
    }
}
