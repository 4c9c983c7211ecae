//! `A = L U` for matrices whose pattern is symmetric, but not their values.

use super::elimination::Place;
use super::{Elimination, PivotShare};
use crate::linear::SingularMatrix;

/// A matrix, and after its factorisation the factors in its place.
pub(in super::super) struct General {
    /// The diagonal, then the entries below it by columns, then those above it by rows.
    entries: Vec<f64>,
    /// The largest number that stood in the place of every pivot.
    peaks: Vec<f64>,
}

impl General {
    /// Zero.
    pub(in super::super) fn zero(elimination: &Elimination) -> Self {
        let n_unknowns = elimination.n_unknowns();
        Self { entries: vec![0.0; n_unknowns + 2 * elimination.n_below()], peaks: vec![0.0; n_unknowns] }
    }

    /// Where the entry of a row and a column lies in [`entries_mut`](Self::entries_mut).
    pub(in super::super) fn place(elimination: &Elimination, row: usize, col: usize) -> u32 {
        let (n_unknowns, n_below) = (elimination.n_unknowns(), elimination.n_below());
        let place = match elimination.place(row, col) {
            Place::Diagonal(unknown) => unknown,
            Place::Below(index) => n_unknowns + index,
            Place::Above(index) => n_unknowns + n_below + index,
        };
        place as u32
    }

    /// The entries, to be written before a factorisation.
    #[inline(always)]
    pub(in super::super) fn entries_mut(&mut self) -> &mut [f64] {
        &mut self.entries
    }

    /// Overwrites the matrix with its factors; returns the smallest pivot as a share of the largest number that stood in its place.
    ///
    /// # Errors
    /// [`SingularMatrix`] when a pivot is round-off.
    pub(in super::super) fn factor(&mut self, elimination: &Elimination) -> Result<f64, SingularMatrix> {
        let (diagonal, beside) = self.entries.split_at_mut(elimination.n_unknowns());
        let (below, above) = beside.split_at_mut(elimination.n_below());
        for (peak, entry) in self.peaks.iter_mut().zip(diagonal.iter()) {
            *peak = entry.abs();
        }
        let mut share = PivotShare::NONE;
        let mut targets = elimination.targets.iter();
        for (column, &pivot) in elimination.pivots.iter().enumerate() {
            let range = elimination.range(column);
            let value = diagonal[pivot as usize];
            share.see(value, self.peaks[pivot as usize]);
            let inverse = 1.0 / value;
            diagonal[pivot as usize] = inverse;
            for entry in &mut below[range.clone()] {
                *entry *= inverse;
            }
            for b in range.clone() {
                let (left, top) = (below[b], above[b]);
                let row = elimination.rows[b] as usize;
                let entry = diagonal[row] - left * top;
                diagonal[row] = entry;
                if entry.abs() > self.peaks[row] {
                    self.peaks[row] = entry.abs();
                }
                for (a, &target) in (b + 1..range.end).zip(&mut targets) {
                    let target = target as usize;
                    below[target] -= below[a] * top;
                    above[target] -= left * above[a];
                }
            }
        }
        share.checked()
    }

    /// Overwrites the right-hand side with the solution; the matrix is factored.
    pub(in super::super) fn solve(&self, elimination: &Elimination, rhs: &mut [f64]) {
        let (diagonal, beside) = self.entries.split_at(elimination.n_unknowns());
        let (below, above) = beside.split_at(elimination.n_below());
        for (column, &pivot) in elimination.pivots.iter().enumerate() {
            let value = rhs[pivot as usize];
            for entry in elimination.range(column) {
                rhs[elimination.rows[entry] as usize] -= below[entry] * value;
            }
        }
        for (column, &pivot) in elimination.pivots.iter().enumerate().rev() {
            let mut value = rhs[pivot as usize];
            for entry in elimination.range(column) {
                value -= above[entry] * rhs[elimination.rows[entry] as usize];
            }
            rhs[pivot as usize] = value * diagonal[pivot as usize];
        }
    }
}
