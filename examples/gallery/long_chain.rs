//! A hanging chain of a thousand links: point masses in a line, joined by rods without mass, the first on a pivot at the origin, y upwards; let go from the
//! horizontal. Where it has swung down it is taut, and a kink runs along it.

use evi_core::prelude::*;

use crate::{GRAVITY, LoopScene};

/// Number of links.
const N: usize = 1_000;

/// Chain of equal links.
#[derive(MechanicalSystem, Clone, Debug)]
#[evi(
    coordinates(p: [N, 2]),
    kinetic = 0.5 * m * sum(0..N, |i| der(p[i]).norm_squared()),
    potential = m * g * sum(0..N, |i| p[i][1]),
    constraint(first: p[0].norm_squared() == l.powi(2)),
    constraint(link[i in 1..N]: (p[i] - p[i - 1]).norm_squared() == l.powi(2)),
)]
pub struct LongChain {
    /// Mass of a link, kg.
    pub m: f64,
    /// Length of a link, m.
    pub l: f64,
    /// Gravitational acceleration, m/s².
    pub g: f64,
}

impl LoopScene for LongChain {
    const NAME: &'static str = "long_chain";
    const SUMMARY: &'static str = "a hanging chain of a thousand links, let go from the horizontal";

    fn standard() -> (Self, Vec<f64>) {
        let share = 1.0 / N as f64;
        let places = (1..=N).flat_map(|i| [i as f64 * share, 0.0]).collect();
        (Self { m: share, l: share, g: GRAVITY }, places)
    }
}
