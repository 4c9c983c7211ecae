//! The tables of a Galerkin step on polynomials in impulses, one node per lane: symplectic to the last bit.
//!
//! With the impulses `kⱼ = h bⱼ Fⱼ` of the nodes and the ways `yⱼ = h M⁻¹ kⱼ` that they go in a step, the step of [`super::lane_tables`] is
//!
//! ```text
//! qᵢ = q₀ + cᵢ h M⁻¹ p₀ + Σⱼ sᵢⱼ yⱼ        p₁ = p₀ + Σⱼ kⱼ        sᵢⱼ = Bᵢⱼ / bⱼ,   i = 1 .. K,   j = 0 .. K
//! ```
//!
//! It is symplectic, and keeps angular momentum, if `sᵢⱼ − sⱼᵢ = cᵢ − cⱼ` (Suris, Zh. Vychisl. Mat. Mat. Fiz. 29 (1989) 202, for Nyström methods), whatever the
//! weights are; it is symmetric if `s_{K−i,K−j} = sⱼᵢ`. Rounded tables miss the first by 1e-17, always in the same direction: a drift. Here `c` and `s` are
//! whole multiples of `2⁻⁵³`, below 1: so are their differences, without rounding, and both equations hold exactly.

use super::lane_tables::{Columns, LaneTables, PAST, accelerated, columns, lanes};
use super::nodal::{LobattoNodes, MOST_INTERVALS};
use crate::scalar::Lanes;

/// Whole multiples of `2⁻⁵³`: one number per pair of nodes.
type Shares = [[f64; MOST_INTERVALS + 1]; MOST_INTERVALS + 1];

/// The tables for one step size.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ImpulseTables {
    /// `c₁ .. c_K`.
    pub(crate) fractions: Lanes,
    /// `h c₁ .. h c_K`.
    pub(crate) nodes: Lanes,
    /// `h b₁ .. h b_{K−1}, h b₀`.
    pub(crate) weights: Lanes,
    /// `h b_K`.
    pub(crate) last_weight: f64,
    /// `1 / h`.
    pub(crate) per_step: f64,
    /// 1 at the nodes within the step, 0 at its end.
    pub(crate) inner: Lanes,
    /// `s`: differences `qᵢ − q₀` per way.
    pub(crate) shares: Columns,
    /// `b B⁻¹ / h`: from displacements to impulses of the constraints.
    pub(crate) impulses: Columns,
    /// `Â / (h b)`, without its last row: velocities per way.
    pub(crate) velocities: Columns,
    /// The last row of it.
    pub(crate) end_velocity: Lanes,
    /// Ways of a step per way of the last step, and of the one before.
    pub(crate) prediction: [Columns; PAST],
}

impl ImpulseTables {
    /// The tables of `K` intervals for steps of size `h`.
    pub(crate) fn new<const K: usize>(h: f64) -> Self {
        let unit = LaneTables::new::<K>(1.0);
        let fractions = fractions::<K>();
        let shares = shares::<K>(&unit, &fractions);
        let weights = unit.weights.to_array();
        // Columns of what is multiplied by impulses, rows of what gives them.
        let per_weight = |columns: &Columns, factor: f64| -> Columns {
            core::array::from_fn(|col| {
                if col < K { columns[col] * Lanes::splat(factor / weights[col]) } else { Lanes::ZERO }
            })
        };
        let weighted = |columns: &Columns| columns.map(|column| column * unit.weights);
        Self {
            fractions: lanes::<K>(|lane| fractions[lane + 1]),
            nodes: unit.nodes * Lanes::splat(h),
            weights: unit.weights * Lanes::splat(h),
            last_weight: unit.last_weight * h,
            per_step: 1.0 / h,
            inner: lanes::<K>(|lane| if lane + 1 < K { 1.0 } else { 0.0 }),
            shares: columns::<K>(|row, col| shares[row + 1][accelerated::<K>(col)]),
            impulses: weighted(&unit.accelerations).map(|column| column * Lanes::splat(1.0 / h)),
            velocities: per_weight(&unit.velocities, 1.0 / h),
            end_velocity: lanes::<K>(|lane| unit.end_velocity.to_array()[lane] / weights[lane] / h),
            prediction: unit.prediction.map(|old| weighted(&per_weight(&old, 1.0))),
        }
    }
}

/// `x` as a whole multiple of `2⁻⁵³`.
fn on_grid(x: f64) -> f64 {
    const PER_UNIT: f64 = (1_u64 << 53) as f64;
    (x * PER_UNIT).round() / PER_UNIT
}

/// `cⱼ`, symmetric about ½.
fn fractions<const K: usize>() -> [f64; MOST_INTERVALS + 1] {
    let lobatto = LobattoNodes::<K>::new();
    core::array::from_fn(|j| match j {
        _ if j > K => 0.0,
        _ if 2 * j > K => 1.0 - on_grid(lobatto.node(K - j)),
        _ => on_grid(lobatto.node(j)),
    })
}

/// `sᵢⱼ` of all nodes: one of each four that their equations bind is rounded, the others follow from it.
fn shares<const K: usize>(unit: &LaneTables, fractions: &[f64; MOST_INTERVALS + 1]) -> Shares {
    let weights = unit.weights.to_array();
    let rounded = |i: usize, j: usize| on_grid(unit.positions[j - 1].to_array()[i - 1] / weights[j - 1]);
    let share = |i: usize, j: usize| match (i, j) {
        _ if i > K || j > K || i == 0 || j == K => 0.0,
        (_, 0) => fractions[i],
        _ if i == K => 1.0 - fractions[j],
        _ => {
            // What `sᵢⱼ` and, of the reversed step, `s_{K−j,K−i}` are.
            let earlier = |i: usize, j: usize| {
                let (i, j) = (i, j).min((K - j, K - i));
                rounded(i, j)
            };
            if i <= j { earlier(i, j) } else { earlier(j, i) + (fractions[i] - fractions[j]) }
        }
    };
    core::array::from_fn(|i| core::array::from_fn(|j| share(i, j)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check<const K: usize>() {
        let fractions = fractions::<K>();
        let unit = LaneTables::new::<K>(1.0);
        let s = shares::<K>(&unit, &fractions);
        let exact =
            |i: usize, j: usize| unit.positions[j - 1].to_array()[i - 1] / unit.weights.to_array()[j - 1];
        for i in 0..=K {
            for j in 0..=K {
                // Equality of bits: what keeps a step symplectic, and what makes it symmetric.
                assert_eq!(s[i][j] - s[j][i], fractions[i] - fractions[j], "K = {K}: {i}, {j}");
                assert_eq!(s[K - i][K - j], s[j][i], "K = {K}: {i}, {j}");
                assert_eq!((s[i][j] * 2.0_f64.powi(53)).fract(), 0.0);
                if (1..=K).contains(&i) && (1..K).contains(&j) {
                    // Three roundings of numbers below 1: the grid, a quotient, a difference.
                    assert!((s[i][j] - exact(i, j)).abs() <= 3.0 * f64::EPSILON, "K = {K}: {i}, {j}");
                }
            }
        }
    }

    #[test]
    fn tables_are_symplectic_and_symmetric_to_the_last_bit() {
        check::<1>();
        check::<2>();
        check::<3>();
        check::<4>();
        check::<5>();
        check::<6>();
        check::<7>();
        check::<8>();
    }
}
