//! The tables of a Galerkin step on polynomials, one node per lane.
//!
//! On a constant mass matrix the step is the Lobatto IIIA-IIIB pair of `K + 1` stages. With the accelerations `aⱼ = M⁻¹ Fⱼ` of the total forces
//!
//! ```text
//! qᵢ = q₀ + h cᵢ v₀ + h² Σⱼ Bᵢⱼ aⱼ        vᵢ = v₀ + h Σⱼ Âᵢⱼ aⱼ        B = A Â,   i = 1 .. K,   j = 0 .. K−1
//! ```
//!
//! where `Aᵢⱼ = ∫₀^cᵢ ℓⱼ` and `Âᵢⱼ = bⱼ (1 − Aⱼᵢ / bᵢ)`, whose last column vanishes (Hairer, Lubich, Wanner, Geometric Numerical
//! Integration, 2nd ed., sec. II.1.4 and VI.4). Positions have node `i + 1` in lane `i`. Accelerations have the same nodes there, but for the last
//! lane, where the start of the step takes the place of its end: a step leads from one to the other by the exchange of one number.

use std::sync::OnceLock;

use super::Quadrature;
use super::nodal::{LobattoNodes, MOST_INTERVALS};
use crate::scalar::{LANES, Lanes};

/// Steps back from which the accelerations of the next one are predicted.
pub(crate) const PAST: usize = 2;

/// Width of the kernel of the prediction in steps, what damps it, and the degree up to which it is exact: widths of 0.5 to 1, dampings of 1e-10 to
/// 1e-14 and degrees of 4 to 6 differ by half a pass of seven (double pendulum from the horizontal and chain of 20, K = 8). Narrower kernels predict
/// worse, less damped ones amplify the round-off of the past, and higher degrees lose long steps.
const PREDICTION_WIDTH: f64 = 0.7;
const PREDICTION_DAMPING: f64 = 1e-12;
const LARGEST_TREND: usize = 5;

/// A matrix by columns: rows are lanes.
pub(crate) type Columns = [Lanes; LANES];

/// The tables for steps of size 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LaneTables {
    /// `c₁ .. c_K`.
    pub(crate) nodes: Lanes,
    /// `b₁ .. b_{K−1}, b₀`.
    pub(crate) weights: Lanes,
    /// `b_K`.
    pub(crate) last_weight: f64,
    /// `B`.
    pub(crate) positions: Columns,
    /// `B⁻¹`: from displacements to accelerations.
    pub(crate) accelerations: Columns,
    /// `Â`, without its last row.
    pub(crate) velocities: Columns,
    /// The last row of `Â`.
    pub(crate) end_velocity: Lanes,
    /// Accelerations of a step per acceleration of the last step, and of the one before.
    pub(crate) prediction: [Columns; PAST],
}

impl LaneTables {
    /// The tables of `K` intervals for steps of size `h`.
    pub(crate) fn new<const K: usize>(h: f64) -> Self {
        static UNIT: [OnceLock<LaneTables>; MOST_INTERVALS] = [const { OnceLock::new() }; MOST_INTERVALS];
        let unit = UNIT[K - 1].get_or_init(Self::unit::<K>);
        let scaled = |columns: &Columns, factor: f64| columns.map(|column| column * Lanes::splat(factor));
        Self {
            nodes: unit.nodes * Lanes::splat(h),
            weights: unit.weights * Lanes::splat(h),
            last_weight: unit.last_weight * h,
            positions: scaled(&unit.positions, h * h),
            accelerations: scaled(&unit.accelerations, 1.0 / (h * h)),
            velocities: scaled(&unit.velocities, h),
            end_velocity: unit.end_velocity * Lanes::splat(h),
            prediction: unit.prediction,
        }
    }

    fn unit<const K: usize>() -> Self {
        let lobatto = LobattoNodes::<K>::new();
        let node = |i: usize| lobatto.node(i);
        let weight = |i: usize| lobatto.weights[i];
        let integrals = integrals(&lobatto);
        let velocity = |i: usize, j: usize| weight(j) * (1.0 - integrals[j][i] / weight(i));
        let position = |i: usize, j: usize| {
            if i == K {
                // The same number, with one rounding.
                weight(j) * (0.5 - lobatto.offsets[j])
            } else {
                (0..=K).map(|k| integrals[i][k] * velocity(k, j)).sum()
            }
        };
        let positions = columns::<K>(|row, col| position(row + 1, accelerated::<K>(col)));
        Self {
            nodes: lanes::<K>(|lane| node(lane + 1)),
            weights: lanes::<K>(|lane| weight(accelerated::<K>(lane))),
            last_weight: weight(K),
            positions,
            accelerations: inverse::<K>(&positions),
            velocities: columns::<K>(|row, col| velocity(accelerated::<K>(row), accelerated::<K>(col))),
            end_velocity: lanes::<K>(|lane| velocity(K, accelerated::<K>(lane))),
            prediction: prediction::<K>(|lane| node(accelerated::<K>(lane))),
        }
    }
}

/// The node whose acceleration a lane holds.
pub(super) const fn accelerated<const K: usize>(lane: usize) -> usize {
    if lane + 1 < K { lane + 1 } else { 0 }
}

/// `Aᵢⱼ = ∫₀^cᵢ ℓⱼ(τ) dτ`, by a Gauss rule that is exact for `ℓⱼ`.
pub(super) fn integrals<const K: usize>(lobatto: &LobattoNodes<K>) -> [[f64; LANES + 1]; LANES + 1] {
    let gauss = Quadrature::<5>::gauss();
    core::array::from_fn(|i| {
        core::array::from_fn(|j| {
            if i > K || j > K {
                return 0.0;
            }
            let end = lobatto.node(i);
            let at = |x: f64| lobatto.lagrange(K, j, end * (0.5 + x) - 0.5);
            (0..5).map(|g| gauss.weights()[g] * end * at(gauss.offsets()[g])).sum()
        })
    })
}

/// What a step continues from the two before: weights of the old values for which polynomials of the degree of [`trend`] are exact, and what is
/// left of others is damped by a Gaussian kernel `G` (universal kriging: Cressie, Statistics for Spatial Data (1993), sec. 3.4),
///
/// ```text
/// [G(old, old) + δ I   P] [E]   [G(old, new)]
/// [Pᵀ                  0] [μ] = [P(new)ᵀ    ]
/// ```
pub(super) fn prediction<const K: usize>(node: impl Fn(usize) -> f64) -> [Columns; PAST] {
    const OLD: usize = PAST * LANES;
    const MOST: usize = OLD + LARGEST_TREND + 1;
    let n_old = PAST * K;
    let n = n_old + trend(K) + 1;
    let old: [f64; OLD] =
        core::array::from_fn(|j| if j < n_old { node(j % K) - 1.0 - (j / K) as f64 } else { 0.0 });
    let kernel = |x: f64, y: f64| {
        let distance = (x - y) / PREDICTION_WIDTH;
        (-0.5 * distance * distance).exp()
    };
    // About the middle of all values, old and new.
    let power = |x: f64, degree: usize| crate::scalar::Scalar::powi(x + 0.5, degree as i32);
    let matrix: [[f64; MOST]; MOST] = core::array::from_fn(|i| {
        core::array::from_fn(|j| match (i < n_old, j < n_old) {
            (true, true) => kernel(old[i], old[j]) + if i == j { PREDICTION_DAMPING } else { 0.0 },
            (true, false) => power(old[i], j - n_old),
            (false, true) => power(old[j], i - n_old),
            (false, false) => 0.0,
        })
    });
    let weights: [[f64; MOST]; K] = core::array::from_fn(|i| {
        let rhs = |j| if j < n_old { kernel(node(i), old[j]) } else { power(node(i), j - n_old) };
        solved(n, matrix, core::array::from_fn(rhs))
    });
    core::array::from_fn(|past| columns::<K>(|row, col| weights[row][past * K + col]))
}

/// The degree of the polynomials that a prediction from steps of `K` intervals is exact for.
const fn trend(intervals: usize) -> usize {
    let half = intervals / 2 + 1;
    if half < LARGEST_TREND { half } else { LARGEST_TREND }
}

/// The inverse of a matrix of `K` rows and columns.
fn inverse<const K: usize>(matrix: &Columns) -> Columns {
    let rows: [[f64; LANES]; LANES] =
        core::array::from_fn(|row| core::array::from_fn(|col| matrix[col].to_array()[row]));
    let unit = |col: usize| core::array::from_fn(|row| if row == col { 1.0 } else { 0.0 });
    let inverse: [[f64; LANES]; LANES] =
        core::array::from_fn(|col| if col < K { solved(K, rows, unit(col)) } else { [0.0; LANES] });
    inverse.map(Lanes::new)
}

/// Solves `matrix · x = rhs` in the first `n` rows and columns, with partial pivoting.
fn solved<const MOST: usize>(n: usize, mut matrix: [[f64; MOST]; MOST], mut rhs: [f64; MOST]) -> [f64; MOST] {
    for k in 0..n {
        let pivot =
            (k..n).fold(k, |best, i| if matrix[i][k].abs() > matrix[best][k].abs() { i } else { best });
        matrix.swap(k, pivot);
        rhs.swap(k, pivot);
        for row in k + 1..n {
            let factor = matrix[row][k] / matrix[k][k];
            for col in k..n {
                matrix[row][col] -= factor * matrix[k][col];
            }
            rhs[row] -= factor * rhs[k];
        }
    }
    for row in (0..n).rev() {
        let known: f64 = (row + 1..n).map(|col| matrix[row][col] * rhs[col]).sum();
        rhs[row] = (rhs[row] - known) / matrix[row][row];
    }
    rhs
}

/// One number per node, zero in lanes without one.
pub(super) fn lanes<const K: usize>(value: impl Fn(usize) -> f64) -> Lanes {
    Lanes::new(core::array::from_fn(|lane| if lane < K { value(lane) } else { 0.0 }))
}

/// A matrix of `K` rows and columns.
pub(super) fn columns<const K: usize>(entry: impl Fn(usize, usize) -> f64) -> Columns {
    core::array::from_fn(|col| if col < K { lanes::<K>(|row| entry(row, col)) } else { Lanes::ZERO })
}
