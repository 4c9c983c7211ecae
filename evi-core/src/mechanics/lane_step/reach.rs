//! What a step is found to the round-off of.

use super::LaneStep;
use crate::mechanics::State;
use crate::scalar::Scalar;
use crate::system::MechanicalSystem;

impl<S: MechanicalSystem, const K: usize> LaneStep<S, K> {
    /// What a step from `start` is found to the round-off of, in the same metric.
    #[inline(always)]
    pub(super) fn reach(&self, start: &State<S>) -> f64 {
        let h = self.tables.nodes.to_array()[K - 1].abs();
        let (mut here, mut way) = (0.0, 0.0);
        for i in 0..S::N_COORDINATES {
            here = larger(self.units[i] * start.q[i].abs(), here);
            way = larger(self.units[i] * h * start.v[i].abs(), way);
        }
        reach(here, way)
    }
}

/// The length whose round-off the points of a step are found to: that of the configuration, less in steps that are short beside it, since what
/// points are off by, velocities are off by the `h`-th part of.
#[inline(always)]
pub(crate) fn reach(here: f64, way: f64) -> f64 {
    /// A step of an eighth of the configuration is not short.
    const LONG: f64 = 8.0;
    /// Points are sums of a configuration: closer is not to be had.
    const CLOSEST: f64 = 1.0 / 16.0;
    let here = here + way;
    let limited = if LONG * way < here { LONG * way } else { here };
    larger(limited, CLOSEST * here)
}

/// As the machine takes it: one instruction, where `f64::max` looks for a NaN.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// `√mass` as a power of two.
pub(super) fn unit(mass: f64) -> f64 {
    Scalar::sqrt(mass.abs()).log2().round().exp2()
}
