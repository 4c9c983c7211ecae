//! `A = L D Lᵀ` for symmetric matrices.

use std::ops::Range;

use super::super::number::Number;
use super::elimination::Place;
use super::{Elimination, PivotShare};
use crate::linear::SingularMatrix;

/// A symmetric matrix, and after its factorisation the factors in its place: `1/D` on the diagonal, `L` below (Golub & Van Loan, Matrix
/// Computations, 4th ed., sec. 4.1.2).
pub(in super::super) struct Symmetric<T> {
    pub(super) diagonal: Vec<T>,
    pub(super) below: Vec<T>,
}

/// Where an entry of a symmetric matrix lies: on the diagonal, or behind it.
pub(in super::super) type SymmetricPlace = u32;

impl<T: Number> Symmetric<T> {
    /// Zero.
    pub(in super::super) fn zero(elimination: &Elimination) -> Self {
        Self {
            diagonal: vec![T::ZERO; elimination.n_unknowns()],
            below: vec![T::ZERO; elimination.n_below()],
        }
    }

    /// Where the entry of a row and a column lies, for [`add`](Self::add).
    pub(in super::super) fn place(elimination: &Elimination, row: usize, col: usize) -> SymmetricPlace {
        let place = match elimination.place(row, col) {
            Place::Diagonal(unknown) => unknown,
            Place::Below(index) | Place::Above(index) => elimination.n_unknowns() + index,
        };
        place as SymmetricPlace
    }

    /// Overwrites the matrix with zero.
    #[inline(always)]
    pub(in super::super) fn clear(&mut self) {
        self.diagonal.fill(T::ZERO);
        self.below.fill(T::ZERO);
    }

    /// The diagonal, unknown by unknown.
    pub(in super::super) fn diagonal(&self) -> &[T] {
        &self.diagonal
    }

    /// Adds `a · b` to an entry.
    #[inline(always)]
    pub(in super::super) fn add<const FUSED: bool>(&mut self, place: SymmetricPlace, a: T, b: T) {
        let (place, n_unknowns) = (place as usize, self.diagonal.len());
        let entry =
            if place < n_unknowns { &mut self.diagonal[place] } else { &mut self.below[place - n_unknowns] };
        *entry = entry.plus_product::<FUSED>(a, b);
    }

    /// Overwrites the matrix with its factors; calls `see(pivot, peak)` for every pivot before, with its unknown and the diagonal entry as it was in the beginning.
    #[inline(always)]
    fn eliminate<const FUSED: bool>(&mut self, elimination: &Elimination, mut see: impl FnMut(usize, T)) {
        let mut targets = elimination.targets.iter();
        for (column, &pivot) in elimination.pivots.iter().enumerate() {
            let range = elimination.range(column);
            let value = self.diagonal[pivot as usize];
            see(pivot as usize, value);
            let inverse = T::from_f64(1.0) / value;
            self.diagonal[pivot as usize] = inverse;
            for b in range.clone() {
                let entry = self.below[b];
                let factor = T::ZERO - entry * inverse;
                let row = elimination.rows[b] as usize;
                self.diagonal[row] = self.diagonal[row].plus_product::<FUSED>(factor, entry);
                for (a, &target) in (b + 1..range.end).zip(&mut targets) {
                    let target = target as usize;
                    self.below[target] = self.below[target].plus_product::<FUSED>(factor, self.below[a]);
                }
            }
            for b in range {
                self.below[b] = self.below[b] * inverse;
            }
        }
    }

    /// Overwrites the right-hand side with the solution; the matrix is factored.
    #[inline(always)]
    pub(in super::super) fn solve<const FUSED: bool>(&self, elimination: &Elimination, rhs: &mut [T]) {
        let columns = 0..elimination.n_unknowns();
        self.solve_forward::<FUSED>(elimination, columns.clone(), rhs);
        self.solve_backward::<FUSED>(elimination, columns, rhs);
    }

    /// The first half of [`solve`](Self::solve), for some columns; those before them are done.
    #[inline(always)]
    pub(in super::super) fn solve_forward<const FUSED: bool>(
        &self,
        elimination: &Elimination,
        columns: Range<usize>,
        rhs: &mut [T],
    ) {
        for column in columns {
            let value = T::ZERO - rhs[elimination.pivots[column] as usize];
            for entry in elimination.range(column) {
                let row = elimination.rows[entry] as usize;
                rhs[row] = rhs[row].plus_product::<FUSED>(self.below[entry], value);
            }
        }
    }

    /// The second half of [`solve`](Self::solve), for some columns; those behind them are done.
    #[inline(always)]
    pub(in super::super) fn solve_backward<const FUSED: bool>(
        &self,
        elimination: &Elimination,
        columns: Range<usize>,
        rhs: &mut [T],
    ) {
        for column in columns.rev() {
            let mut sum = T::ZERO;
            for entry in elimination.range(column) {
                sum = sum.plus_product::<FUSED>(self.below[entry], rhs[elimination.rows[entry] as usize]);
            }
            let pivot = elimination.pivots[column] as usize;
            rhs[pivot] = rhs[pivot] * self.diagonal[pivot] - sum;
        }
    }

    /// Overwrites the matrices of all lanes with their factors. A singular one gives numbers that are not finite.
    #[inline(always)]
    pub(in super::super) fn factor_unchecked<const FUSED: bool>(&mut self, elimination: &Elimination) {
        self.eliminate::<FUSED>(elimination, |_, _| ());
    }
}

impl Symmetric<f64> {
    /// Overwrites a matrix with a positive diagonal with its factors; `peaks` holds the diagonal as it was. Returns the smallest pivot as a share
    /// of what stood in its place, and its unknown.
    ///
    /// # Errors
    /// [`SingularMatrix`] when a pivot is round-off, with its unknown.
    pub(in super::super) fn factor(
        &mut self,
        elimination: &Elimination,
        peaks: &mut [f64],
    ) -> Result<f64, (usize, SingularMatrix)> {
        peaks.copy_from_slice(&self.diagonal);
        let (mut share, mut smallest) = (PivotShare::NONE, 0);
        self.eliminate::<false>(elimination, |unknown, pivot| {
            let before = share.0;
            // A pivot of the other sign is worse than a small one.
            share.see(pivot.max(0.0), peaks[unknown]);
            if share.0.to_bits() != before.to_bits() {
                smallest = unknown;
            }
        });
        share.checked().map_err(|singular| (smallest, singular))
    }
}
