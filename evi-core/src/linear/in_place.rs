//! Elimination with partial pivoting in place, for matrices of a size known at run time.
//!
//! In: the entries of a square matrix by columns, in storage of the caller's. Out: its factors in the same place.

use super::pivoted::exchange;
use super::{SingularMatrix, checked_pivot_ratio};

/// Number of rows from which on it pays to look for a band.
const SMALLEST_BAND: usize = 24;

/// `P A = L U` by columns (Golub & Van Loan, Matrix Computations, 4th ed., alg. 3.4.1); what belongs to the factors beside their
/// entries.
///
/// Beyond the last nonzero of a row or a column nothing is computed: the cost of a band is proportional to its length (ibid., sec. 4.3).
///
/// Every index is in range by construction. Where the optimiser does not find that out, an access that would fail ends the elimination, so that steps
/// have no path to a panic.
pub(crate) struct InPlaceLu {
    columns: Vec<Column>,
    /// Behind the last nonzero of every row that is left.
    row_ends: Vec<usize>,
    pivot_ratio: f64,
}

/// What belongs to a column of the factors.
#[derive(Clone, Copy)]
struct Column {
    /// Row that was swapped with row `k` before column `k` was eliminated.
    swap: usize,
    /// Behind the last nonzero of the column of `L`; behind its last row where no band is looked for.
    end: usize,
    /// `1/Uₖₖ`: one division per column.
    inverse_pivot: f64,
}

impl InPlaceLu {
    /// For matrices of `dimension` rows.
    pub(crate) fn new(dimension: usize) -> Self {
        Self {
            columns: vec![Column { swap: 0, end: dimension, inverse_pivot: 1.0 }; dimension],
            row_ends: vec![0; dimension],
            pivot_ratio: 1.0,
        }
    }

    /// Number of rows; one where there is none, since nothing is cut into columns of no rows.
    #[inline]
    fn dimension(&self) -> usize {
        self.columns.len().max(1)
    }

    /// Overwrites the matrix with its factors.
    ///
    /// # Errors
    /// [`SingularMatrix`] when the smallest pivot is lost in the round-off of the largest.
    pub(crate) fn factor(&mut self, entries: &mut [f64]) -> Result<(), SingularMatrix> {
        let dimension = self.columns.len();
        if dimension < SMALLEST_BAND {
            self.eliminate(entries);
        } else {
            self.find_row_ends(entries)?;
            self.eliminate_within_band(entries);
        }
        let pivot = |i: usize| entries.get(i * (dimension + 1)).copied().unwrap_or(f64::NAN);
        self.pivot_ratio = checked_pivot_ratio(dimension, pivot)?;
        Ok(())
    }

    /// Eliminates every column.
    fn eliminate(&mut self, entries: &mut [f64]) {
        let dimension = self.dimension();
        let mut rest = entries;
        for (k, column) in self.columns.iter_mut().enumerate() {
            let Some((factors, behind)) = rest.split_at_mut_checked(dimension) else { return };
            let (pivot_row, pivot) = largest_entry(factors, k);
            column.swap = pivot_row;
            // Exact zero: nothing is left to eliminate in this column; the check of the pivots reports it.
            if pivot != 0.0 {
                column.inverse_pivot = 1.0 / pivot;
                column.eliminate(k, factors, behind, dimension);
            }
            rest = behind;
        }
    }

    /// Eliminates every column as far as it and the rows in it reach.
    fn eliminate_within_band(&mut self, entries: &mut [f64]) {
        let dimension = self.dimension();
        let mut rest = entries;
        for (k, column) in self.columns.iter_mut().enumerate() {
            let Some((factors, behind)) = rest.split_at_mut_checked(dimension) else { return };
            let last = factors.iter().rposition(|&entry| entry != 0.0);
            let end = last.map_or(k + 1, |row| (row + 1).max(k + 1));
            let (pivot_row, pivot) = largest_entry(factors.get(..end).unwrap_or_default(), k);
            (column.swap, column.end) = (pivot_row, end);
            // As above.
            if pivot != 0.0 {
                column.inverse_pivot = 1.0 / pivot;
                let row_ends = self.row_ends.get_mut(k..end).unwrap_or_default();
                let row_end = row_ends.iter().fold(k + 1, |end, &other| end.max(other));
                row_ends.fill(row_end);
                column.eliminate(k, factors, behind, row_end);
            }
            rest = behind;
        }
    }

    /// Overwrites `row_ends`, or refuses a matrix with an entry that is not finite: beside a band not every one reaches a pivot.
    fn find_row_ends(&mut self, entries: &[f64]) -> Result<(), SingularMatrix> {
        if !entries.iter().all(|entry| entry.is_finite()) {
            return Err(SingularMatrix { pivot_ratio: f64::NAN });
        }
        for (col, column) in entries.chunks_exact(self.dimension()).enumerate() {
            for (end, &entry) in self.row_ends.iter_mut().zip(column) {
                if entry != 0.0 {
                    *end = col + 1;
                }
            }
        }
        Ok(())
    }

    /// Overwrites the right-hand side with the solution; `entries` are the factors.
    pub(crate) fn solve(&self, entries: &[f64], rhs: &mut [f64]) {
        let columns = || self.columns.iter().zip(entries.chunks_exact(self.dimension())).enumerate();
        // The multipliers of a column stand in the rows of its own time: a swap comes right before their substitution.
        for (k, (column, factors)) in columns() {
            exchange(rhs, k, column.swap);
            let Some([value, below @ ..]) = rhs.get_mut(k..) else { return };
            for (entry, multiplier) in below.iter_mut().zip(column.multipliers(k, factors)) {
                *entry -= multiplier * *value;
            }
        }
        for (k, (column, factors)) in columns().rev() {
            let Some([above @ .., value]) = rhs.get_mut(..=k) else { return };
            *value *= column.inverse_pivot;
            for (entry, factor) in above.iter_mut().zip(factors) {
                *entry -= factor * *value;
            }
        }
    }

    /// Overwrites the right-hand side with the solution for the transposed matrix; `entries` are the factors.
    pub(crate) fn solve_transposed(&self, entries: &[f64], rhs: &mut [f64]) {
        let columns = || self.columns.iter().zip(entries.chunks_exact(self.dimension())).enumerate();
        for (k, (column, factors)) in columns() {
            let Some([above @ .., value]) = rhs.get_mut(..=k) else { return };
            let sum: f64 = factors.iter().zip(above).map(|(factor, value)| factor * *value).sum();
            *value = (*value - sum) * column.inverse_pivot;
        }
        for (k, (column, factors)) in columns().rev() {
            let Some([value, below @ ..]) = rhs.get_mut(k..) else { return };
            let multipliers = column.multipliers(k, factors);
            *value -= multipliers.iter().zip(below).map(|(factor, value)| factor * *value).sum::<f64>();
            exchange(rhs, k, column.swap);
        }
    }

    /// Smallest pivot over largest.
    pub(crate) const fn pivot_ratio(&self) -> f64 {
        self.pivot_ratio
    }
}

impl Column {
    /// Brings the pivot of this column, the `k`-th, up and eliminates what is below it from the columns `behind` up to `row_end`.
    fn eliminate(&self, k: usize, factors: &mut [f64], behind: &mut [f64], row_end: usize) {
        let dimension = factors.len().max(1);
        exchange(factors, k, self.swap);
        let Some([_, multipliers @ ..]) = factors.get_mut(k..self.end) else { return };
        for multiplier in multipliers.iter_mut() {
            *multiplier *= self.inverse_pivot;
        }
        for column in behind.chunks_exact_mut(dimension).take(row_end - (k + 1)) {
            exchange(column, k, self.swap);
            let Some([top, below @ ..]) = column.get_mut(k..self.end) else { return };
            // Where the matrix has blocks of zeros, half of the columns.
            if *top == 0.0 {
                continue;
            }
            for (entry, multiplier) in below.iter_mut().zip(multipliers.iter()) {
                *entry -= multiplier * *top;
            }
        }
    }

    /// The multipliers of this column, the `k`-th.
    #[inline]
    fn multipliers<'a>(&self, k: usize, factors: &'a [f64]) -> &'a [f64] {
        factors.get(k + 1..self.end).unwrap_or_default()
    }
}

/// Row and value of the largest entry of a column from row `first` on; a NaN counts as the largest, so that it reaches
/// the pivots.
fn largest_entry(column: &[f64], first: usize) -> (usize, f64) {
    let mut largest = (first, 0.0_f64);
    for (row, &entry) in column.iter().enumerate().skip(first) {
        let is_smaller = entry.abs() <= largest.1.abs();
        if !is_smaller && !largest.1.is_nan() {
            largest = (row, entry);
        }
    }
    largest
}
