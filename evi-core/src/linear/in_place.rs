//! Elimination with partial pivoting in place, for matrices of a size known at run time.
//!
//! In: the entries of a square matrix by columns, in storage of the caller's. Out: its factors in the same place.

use super::{SingularMatrix, checked_pivot_ratio};

/// Number of rows from which on it pays to look for a band.
const SMALLEST_BAND: usize = 24;

/// `P A = L U` by columns (Golub & Van Loan, Matrix Computations, 4th ed., alg. 3.4.1); what belongs to the factors beside their
/// entries.
///
/// Beyond the last nonzero of a row or a column nothing is computed: the cost of a band is proportional to its length (ibid., sec. 4.3).
pub(crate) struct InPlaceLu {
    /// Row that was swapped with row `k` before column `k` was eliminated.
    swaps: Vec<usize>,
    /// `1/Uₖₖ`: one division per column.
    inverse_pivots: Vec<f64>,
    /// Behind the last nonzero of every column of `L`; behind its last row where no band is looked for.
    column_ends: Vec<usize>,
    /// Behind the last nonzero of every row that is left.
    row_ends: Vec<usize>,
    pivot_ratio: f64,
}

impl InPlaceLu {
    /// For matrices of `dimension` rows.
    pub(crate) fn new(dimension: usize) -> Self {
        Self {
            swaps: vec![0; dimension],
            inverse_pivots: vec![1.0; dimension],
            column_ends: vec![dimension; dimension],
            row_ends: vec![0; dimension],
            pivot_ratio: 1.0,
        }
    }

    /// Overwrites the matrix with its factors.
    ///
    /// # Errors
    /// [`SingularMatrix`] when the smallest pivot is lost in the round-off of the largest.
    pub(crate) fn factor(&mut self, entries: &mut [f64]) -> Result<(), SingularMatrix> {
        let dimension = self.swaps.len();
        if dimension < SMALLEST_BAND {
            self.eliminate(entries);
        } else {
            self.find_row_ends(entries)?;
            self.eliminate_within_band(entries);
        }
        self.pivot_ratio = checked_pivot_ratio(dimension, |i| entries[i * dimension + i])?;
        Ok(())
    }

    /// Eliminates every column.
    fn eliminate(&mut self, entries: &mut [f64]) {
        let dimension = self.swaps.len();
        for k in 0..dimension {
            let (pivot_row, pivot) = largest_entry(&entries[k * dimension..(k + 1) * dimension], k);
            self.swaps[k] = pivot_row;
            // Exact zero: nothing is left to eliminate in this column; the check of the pivots reports it.
            if pivot != 0.0 {
                self.inverse_pivots[k] = 1.0 / pivot;
                self.eliminate_column(entries, k, dimension, dimension);
            }
        }
    }

    /// Eliminates every column as far as it and the rows in it reach.
    fn eliminate_within_band(&mut self, entries: &mut [f64]) {
        let dimension = self.swaps.len();
        for k in 0..dimension {
            let column = &entries[k * dimension..(k + 1) * dimension];
            let end =
                column.iter().rposition(|&entry| entry != 0.0).map_or(k + 1, |row| (row + 1).max(k + 1));
            let (pivot_row, pivot) = largest_entry(&column[..end], k);
            self.swaps[k] = pivot_row;
            self.column_ends[k] = end;
            // As above.
            if pivot != 0.0 {
                self.inverse_pivots[k] = 1.0 / pivot;
                let row_end = self.row_ends[k..end].iter().fold(k + 1, |end, &other| end.max(other));
                self.row_ends[k..end].fill(row_end);
                self.eliminate_column(entries, k, end, row_end);
            }
        }
    }

    /// Brings the pivot of column `k` up and eliminates what is below it, up to row `end`, from the columns up to `row_end`.
    fn eliminate_column(&self, entries: &mut [f64], k: usize, end: usize, row_end: usize) {
        let (dimension, pivot_row, inverse_pivot) = (self.swaps.len(), self.swaps[k], self.inverse_pivots[k]);
        let (head, tail) = entries.split_at_mut((k + 1) * dimension);
        let pivots = &mut head[k * dimension..][..end];
        pivots.swap(k, pivot_row);
        let multipliers = &mut pivots[k + 1..];
        for multiplier in multipliers.iter_mut() {
            *multiplier *= inverse_pivot;
        }
        for column in tail.chunks_exact_mut(dimension).take(row_end - (k + 1)) {
            let column = &mut column[..end];
            column.swap(k, pivot_row);
            let top = column[k];
            // Where the matrix has blocks of zeros, half of the columns.
            if top == 0.0 {
                continue;
            }
            for (entry, multiplier) in column[k + 1..].iter_mut().zip(multipliers.iter()) {
                *entry -= multiplier * top;
            }
        }
    }

    /// Overwrites `row_ends`, or refuses a matrix with an entry that is not finite: beside a band not every one reaches a pivot.
    fn find_row_ends(&mut self, entries: &[f64]) -> Result<(), SingularMatrix> {
        if !entries.iter().all(|entry| entry.is_finite()) {
            return Err(SingularMatrix { pivot_ratio: f64::NAN });
        }
        for (col, column) in entries.chunks_exact(self.swaps.len()).enumerate() {
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
        let dimension = self.swaps.len();
        // The multipliers of a column stand in the rows of its own time: a swap comes right before their substitution.
        for (k, &pivot_row) in self.swaps.iter().enumerate() {
            rhs.swap(k, pivot_row);
            let value = rhs[k];
            let multipliers = &entries[k * dimension + k + 1..k * dimension + self.column_ends[k]];
            for (entry, multiplier) in rhs[k + 1..].iter_mut().zip(multipliers) {
                *entry -= multiplier * value;
            }
        }
        for k in (0..dimension).rev() {
            let value = rhs[k] * self.inverse_pivots[k];
            rhs[k] = value;
            for (entry, factor) in rhs[..k].iter_mut().zip(&entries[k * dimension..]) {
                *entry -= factor * value;
            }
        }
    }

    /// Overwrites the right-hand side with the solution for the transposed matrix; `entries` are the factors.
    pub(crate) fn solve_transposed(&self, entries: &[f64], rhs: &mut [f64]) {
        let dimension = self.swaps.len();
        for k in 0..dimension {
            let above = entries[k * dimension..].iter().zip(&rhs[..k]);
            let sum: f64 = above.map(|(factor, value)| factor * value).sum();
            rhs[k] = (rhs[k] - sum) * self.inverse_pivots[k];
        }
        for k in (0..dimension).rev() {
            let multipliers = &entries[k * dimension + k + 1..k * dimension + self.column_ends[k]];
            let sum: f64 = multipliers.iter().zip(&rhs[k + 1..]).map(|(factor, value)| factor * value).sum();
            rhs[k] -= sum;
            rhs.swap(k, self.swaps[k]);
        }
    }

    /// Smallest pivot over largest.
    pub(crate) const fn pivot_ratio(&self) -> f64 {
        self.pivot_ratio
    }
}

/// Row and value of the largest entry of a column from row `first` on; a NaN counts as the largest, so that it reaches
/// the pivots.
fn largest_entry(column: &[f64], first: usize) -> (usize, f64) {
    let (mut largest, mut magnitude) = (first, column[first].abs());
    for (row, entry) in column.iter().enumerate().skip(first + 1) {
        let is_smaller = entry.abs() <= magnitude;
        if !is_smaller && !magnitude.is_nan() {
            (largest, magnitude) = (row, entry.abs());
        }
    }
    (largest, column[largest])
}
