//! Gram matrices `G M⁻¹ Gᵀ` of eight nodes at once, a node per lane: factored without pivoting, within their envelope.

use crate::array::Array;
use crate::scalar::Lanes;
use crate::system::MechanicalSystem;

/// `S = L D Lᵀ` by rows: `L` below the diagonal, `1/D` on it (Golub & Van Loan, Matrix Computations, 4th ed., sec. 4.1.2).
///
/// Nothing is left of the first nonzero of a row, nor does elimination put anything there (ibid., sec. 4.3): on a chain of constraints the
/// cost is proportional to their number. A singular matrix gives numbers that are not finite: the caller's iteration does not
/// converge then.
pub(crate) struct LaneGram<S: MechanicalSystem> {
    rows: S::PerConstraint<S::PerConstraint<Lanes>>,
    /// Column of the first nonzero of every row.
    first: S::PerConstraint<usize>,
}

impl<S: MechanicalSystem> LaneGram<S> {
    /// Up to here elimination is unrolled, and a matrix is full.
    const UNROLLED: bool = S::N_CONSTRAINTS <= 4;

    /// For matrices that couple constraints which share a coordinate, or all if the mass matrix couples coordinates.
    pub(crate) fn new(couples_all: bool) -> Self {
        let mut first = S::PerConstraint::<usize>::from_fn(|row| if couples_all { 0 } else { row });
        for &(smaller, larger) in S::STRUCTURE.constraint_graph {
            first[larger] = first[larger].min(smaller);
        }
        Self { rows: Array::from_fn(|_| Array::from_fn(|_| Lanes::ZERO)), first }
    }

    #[inline(always)]
    fn first(&self, row: usize) -> usize {
        if Self::UNROLLED { 0 } else { self.first[row] }
    }

    /// Sets the matrix to zero.
    #[inline(always)]
    pub(crate) fn clear(&mut self) {
        for row in 0..S::N_CONSTRAINTS {
            for col in self.first(row)..=row {
                self.rows[row][col] = Lanes::ZERO;
            }
        }
    }

    /// Adds `a · b` to the entry at `(row, col)`, `row ≥ col`.
    #[inline(always)]
    pub(crate) fn add_product<const FUSED: bool>(&mut self, row: usize, col: usize, a: Lanes, b: Lanes) {
        self.rows[row][col] = a.times_plus::<FUSED>(b, self.rows[row][col]);
    }

    /// Overwrites the matrix with its factors.
    #[inline(always)]
    pub(crate) fn factor<const FUSED: bool>(&mut self) {
        for row in 0..S::N_CONSTRAINTS {
            let start = self.first(row);
            for col in start..row {
                let mut entry = self.rows[row][col];
                for k in start.max(self.first(col))..col {
                    entry = (-self.rows[row][k]).times_plus::<FUSED>(self.rows[col][k], entry);
                }
                self.rows[row][col] = entry;
            }
            let mut pivot = self.rows[row][row];
            for col in start..row {
                let entry = self.rows[row][col];
                let multiplier = entry * self.rows[col][col];
                pivot = (-multiplier).times_plus::<FUSED>(entry, pivot);
                self.rows[row][col] = multiplier;
            }
            self.rows[row][row] = Lanes::splat(1.0) / pivot;
        }
    }

    /// Overwrites the right-hand sides with the solutions.
    #[inline(always)]
    pub(crate) fn solve<const FUSED: bool>(&self, rhs: &mut S::PerConstraint<Lanes>) {
        for row in 0..S::N_CONSTRAINTS {
            for col in self.first(row)..row {
                rhs[row] = (-self.rows[row][col]).times_plus::<FUSED>(rhs[col], rhs[row]);
            }
        }
        for row in 0..S::N_CONSTRAINTS {
            rhs[row] = rhs[row] * self.rows[row][row];
        }
        for row in (0..S::N_CONSTRAINTS).rev() {
            for col in self.first(row)..row {
                rhs[col] = (-self.rows[row][col]).times_plus::<FUSED>(rhs[row], rhs[col]);
            }
        }
    }
}
