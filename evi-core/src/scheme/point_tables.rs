//! The tables of a Galerkin step on polynomials whose unknowns are its points, one node per lane: for a momentum that is anything but a constant
//! mass times the velocity.
//!
//! Points, velocities and momenta have node `i + 1` in lane `i`; the start of the step stands apart. What is indexed by nodes before the last,
//! forces and multipliers, has the start in the last lane, as in [`super::lane_tables`], whose `A`, `Â` and `B` these are. The rates `D` of a
//! polynomial of degree `K` are blind to the Legendre polynomial `ψ` of that degree, to which they are orthogonal under the weights; the projection
//! `Π = 1 − ψ ψᵀ b` removes it from momenta, and `A Π` leads from there to the points.

use std::sync::OnceLock;

use super::NodalTable;
use super::lane_tables::{Columns, LaneTables, PAST, columns, integrals, lanes, prediction};
use super::nodal::{LobattoNodes, MOST_INTERVALS};
use crate::scalar::Lanes;

/// The tables for one step size.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointTables {
    /// `h c₁ .. h c_K`, the weights, `h² B` and `B⁻¹ / h²`.
    pub(crate) lobatto: LaneTables,
    /// `D / h`: velocities at the nodes `1 .. K` per difference `qₐ − q₀`.
    pub(crate) rates: Columns,
    /// The same at the start.
    pub(crate) start_rates: Lanes,
    /// `h A Π`: differences per momentum at the nodes `1 .. K`.
    pub(crate) momenta: Columns,
    /// The same per momentum at the start.
    pub(crate) start_momentum: Lanes,
    /// Differences per velocity at the nodes `1 .. K`: integrals of their polynomial of degree `K − 1`.
    pub(crate) ways: Columns,
    /// The velocity of that polynomial at the start.
    pub(crate) extrapolation: Lanes,
    /// Velocities at the nodes `1 .. K` of a step per velocity of the last step, and of the one before.
    pub(crate) prediction: [Columns; PAST],
}

impl PointTables {
    /// The tables of `K` intervals for steps of size `h`.
    pub(crate) fn new<const K: usize>(h: f64) -> Self {
        static UNIT: [OnceLock<PointTables>; MOST_INTERVALS] = [const { OnceLock::new() }; MOST_INTERVALS];
        let unit = UNIT[K - 1].get_or_init(Self::unit::<K>);
        let scaled = |columns: &Columns, factor: f64| columns.map(|column| column * Lanes::splat(factor));
        Self {
            lobatto: LaneTables::new::<K>(h),
            rates: scaled(&unit.rates, 1.0 / h),
            start_rates: unit.start_rates * Lanes::splat(1.0 / h),
            momenta: scaled(&unit.momenta, h),
            start_momentum: unit.start_momentum * Lanes::splat(h),
            ways: scaled(&unit.ways, h),
            extrapolation: unit.extrapolation,
            prediction: unit.prediction,
        }
    }

    fn unit<const K: usize>() -> Self {
        let lobatto = LobattoNodes::<K>::new();
        let integrals = integrals(&lobatto);
        let highest = highest_legendre(&lobatto);
        let momentum = |i: usize, j: usize| {
            let along: f64 = (0..=K).map(|k| integrals[i][k] * highest[k]).sum();
            integrals[i][j] - along * highest[j] * lobatto.weights[j]
        };
        // Orthogonal to `ψ`.
        let at_start = |j: usize| -(lobatto.weights[j] * highest[j]) / (lobatto.weights[0] * highest[0]);
        let rates = NodalTable::<K>::polynomial();
        let start_rates = rates.rates(0).differences;
        Self {
            lobatto: LaneTables::new::<K>(1.0),
            rates: columns::<K>(|row, col| rates.rates(row + 1).differences[col]),
            start_rates: lanes::<K>(|lane| start_rates[lane]),
            momenta: columns::<K>(|row, col| momentum(row + 1, col + 1)),
            start_momentum: lanes::<K>(|lane| momentum(lane + 1, 0)),
            ways: columns::<K>(|row, col| {
                integrals[row + 1][col + 1] + integrals[row + 1][0] * at_start(col + 1)
            }),
            extrapolation: lanes::<K>(|lane| at_start(lane + 1)),
            prediction: prediction::<K>(|lane| lobatto.node(lane + 1)),
        }
    }
}

/// The Legendre polynomial `ψ` of degree `K` at the nodes, with `Σ bⱼ ψⱼ² = 1`.
fn highest_legendre<const K: usize>(lobatto: &LobattoNodes<K>) -> [f64; MOST_INTERVALS + 1] {
    let value = |x: f64| {
        let (mut previous, mut value) = (0.0, 1.0);
        for k in 0..K {
            let k = k as f64;
            (previous, value) = (value, ((2.0 * k + 1.0) * x * value - k * previous) / (k + 1.0));
        }
        value
    };
    let values: [f64; MOST_INTERVALS + 1] =
        core::array::from_fn(|j| if j <= K { value(2.0 * lobatto.offsets[j]) } else { 0.0 });
    let square: f64 = (0..=K).map(|j| lobatto.weights[j] * values[j] * values[j]).sum();
    values.map(|value| value / crate::scalar::Scalar::sqrt(square))
}
