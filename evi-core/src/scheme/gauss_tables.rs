//! The tables of a Gauss step, one node per lane: `Aᵢⱼ = ∫₀^cᵢ ℓⱼ` at the nodes of the Gauss rule (Hairer, Lubich, Wanner, Geometric Numerical
//! Integration, 2nd ed., sec. II.1.3).

use std::sync::OnceLock;

use super::Quadrature;
use super::lane_tables::{Columns, PAST, columns, lanes, prediction};
use super::nodal::MOST_INTERVALS;
use crate::scalar::Lanes;

/// The tables for one step size.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GaussTables {
    /// `h c`.
    pub(crate) nodes: Lanes,
    /// `h b`.
    pub(crate) weights: Lanes,
    /// `h A`.
    pub(crate) stages: Columns,
    /// Values at the nodes per value of the last step, and of the one before.
    pub(crate) prediction: [Columns; PAST],
}

impl GaussTables {
    /// The tables of `K` nodes for steps of size `h`.
    pub(crate) fn new<const K: usize>(h: f64) -> Self {
        const { assert!(1 <= K && K <= MOST_INTERVALS, "a Gauss integrator has 1 to 8 nodes") };
        static UNIT: [OnceLock<GaussTables>; MOST_INTERVALS] = [const { OnceLock::new() }; MOST_INTERVALS];
        let unit = UNIT[K - 1].get_or_init(Self::unit::<K>);
        let h = Lanes::splat(h);
        Self {
            nodes: unit.nodes * h,
            weights: unit.weights * h,
            stages: unit.stages.map(|column| column * h),
            prediction: unit.prediction,
        }
    }

    fn unit<const K: usize>() -> Self {
        let rule = Quadrature::<K>::gauss();
        let (offsets, weights) = (rule.offsets(), rule.weights());
        let basis = |j: usize, x: f64| -> f64 {
            let others = (0..K).filter(|&k| k != j);
            others.map(|k| (x - offsets[k]) / (offsets[j] - offsets[k])).product()
        };
        // `Aᵢⱼ / bⱼ`, by the rule itself on [0, cᵢ], where it is exact for the basis.
        let ratio = |i: usize, j: usize| -> f64 {
            let end = 0.5 + offsets[i];
            let at = |g: usize| basis(j, end * (0.5 + offsets[g]) - 0.5);
            (0..K).map(|g| weights[g] * end * at(g)).sum::<f64>() / weights[j]
        };
        // bᵢ Aᵢⱼ + bⱼ Aⱼᵢ = bᵢ bⱼ, to the rounding of one product: what makes the step symplectic.
        let stage = |i: usize, j: usize| weights[j] * (0.5 + 0.5 * (ratio(i, j) - ratio(j, i)));
        Self {
            nodes: lanes::<K>(|i| 0.5 + offsets[i]),
            weights: lanes::<K>(|i| weights[i]),
            stages: columns::<K>(stage),
            prediction: prediction::<K>(|i| 0.5 + offsets[i]),
        }
    }
}
