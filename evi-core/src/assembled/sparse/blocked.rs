//! `A = L U` for matrices whose entries are dense blocks of one size: unknowns of a scene at all nodes of a step.

use super::{Elimination, PivotShare};
use crate::linear::SingularMatrix;

/// A matrix of blocks, and after its factorisation the factors in its place. Rows are exchanged within the pivot blocks alone.
pub(in super::super) struct Blocked {
    /// Rows of a block.
    size: usize,
    /// Blocks by rows: the diagonal, then those below it by columns, then those above it by rows. Zeros that nobody touches cost an operating system
    /// no memory: a run without a step that needs them has none of it.
    entries: Vec<f64>,
    /// For every row of a pivot block the one that was exchanged with it.
    exchanges: Vec<u8>,
    /// The largest number that stood in the place of every pivot block.
    peaks: Vec<f64>,
    row: Vec<f64>,
}

/// Numbers of a matrix: a gigabyte.
const MOST_NUMBERS: usize = 1 << 27;

impl Blocked {
    /// Zero; `None` if there are too many numbers in it.
    pub(in super::super) fn zero(elimination: &Elimination, size: usize) -> Option<Self> {
        let (n_unknowns, n_below) = (elimination.n_unknowns(), elimination.n_below());
        let n_numbers = (n_unknowns + 2 * n_below) * size * size;
        (n_numbers <= MOST_NUMBERS).then(|| Self {
            size,
            entries: vec![0.0; n_numbers],
            exchanges: vec![0; n_unknowns * size],
            peaks: vec![0.0; n_unknowns],
            row: vec![0.0; size],
        })
    }

    /// Overwrites the matrix with zero.
    pub(in super::super) fn clear(&mut self) {
        self.entries.fill(0.0);
    }

    /// The block at a [place](super::General::place), by rows.
    #[inline]
    pub(in super::super) fn block_mut(&mut self, place: usize) -> &mut [f64] {
        let numbers = self.size * self.size;
        &mut self.entries[place * numbers..(place + 1) * numbers]
    }

    /// Overwrites the matrix with its factors; returns the smallest pivot as a share of the largest number that stood in the place of its block.
    ///
    /// # Errors
    /// [`SingularMatrix`] when a pivot is round-off.
    pub(in super::super) fn factor(&mut self, elimination: &Elimination) -> Result<f64, SingularMatrix> {
        let (size, numbers) = (self.size, self.size * self.size);
        let (diagonal, beside) = self.entries.split_at_mut(elimination.n_unknowns() * numbers);
        let (below, above) = beside.split_at_mut(elimination.n_below() * numbers);
        let at = |index: usize| index * numbers..(index + 1) * numbers;
        for (peak, block) in self.peaks.iter_mut().zip(diagonal.chunks_exact(numbers)) {
            *peak = largest(block);
        }
        let mut share = PivotShare::NONE;
        let mut targets = elimination.targets.iter();
        for (column, &pivot) in elimination.pivots.iter().enumerate() {
            let pivot = pivot as usize;
            let range = elimination.range(column);
            let exchanges = &mut self.exchanges[pivot * size..(pivot + 1) * size];
            let smallest = factor_block(&mut diagonal[at(pivot)], exchanges, &mut self.row);
            share.see(smallest, self.peaks[pivot]);
            for entry in range.clone() {
                divide_right(&mut below[at(entry)], &diagonal[at(pivot)], exchanges, size);
            }
            // What products go to is eliminated later.
            let (left, later_below) = below.split_at_mut(range.end * numbers);
            let (top, later_above) = above.split_at_mut(range.end * numbers);
            for b in range.clone() {
                let row = elimination.rows[b] as usize;
                let corner = &mut diagonal[at(row)];
                subtract_product(corner, &left[at(b)], &top[at(b)], size);
                self.peaks[row] = self.peaks[row].max(largest(corner));
                for (a, &target) in (b + 1..range.end).zip(&mut targets) {
                    let target = at(target as usize - range.end);
                    subtract_product(&mut later_below[target.clone()], &left[at(a)], &top[at(b)], size);
                    subtract_product(&mut later_above[target], &left[at(b)], &top[at(a)], size);
                }
            }
        }
        share.checked()
    }

    /// Overwrites the right-hand side, unknown by unknown, with the solution; the matrix is factored.
    pub(in super::super) fn solve(&mut self, elimination: &Elimination, rhs: &mut [f64]) {
        let (size, numbers) = (self.size, self.size * self.size);
        let (diagonal, beside) = self.entries.split_at(elimination.n_unknowns() * numbers);
        let (below, above) = beside.split_at(elimination.n_below() * numbers);
        let at = |index: usize| index * numbers..(index + 1) * numbers;
        let part = |unknown: u32| unknown as usize * size..(unknown as usize + 1) * size;
        for (column, &pivot) in elimination.pivots.iter().enumerate() {
            self.row.copy_from_slice(&rhs[part(pivot)]);
            for entry in elimination.range(column) {
                let target = &mut rhs[part(elimination.rows[entry])];
                subtract_applied(target, &below[at(entry)], &self.row);
            }
        }
        for (column, &pivot) in elimination.pivots.iter().enumerate().rev() {
            self.row.copy_from_slice(&rhs[part(pivot)]);
            for entry in elimination.range(column) {
                let known = &rhs[part(elimination.rows[entry])];
                subtract_applied(&mut self.row, &above[at(entry)], known);
            }
            let exchanges = &self.exchanges[part(pivot)];
            solve_block(&diagonal[at(pivot as usize)], exchanges, &mut self.row);
            rhs[part(pivot)].copy_from_slice(&self.row);
        }
    }
}

fn largest(block: &[f64]) -> f64 {
    block.iter().fold(0.0, |largest, entry| entry.abs().max(largest))
}

/// `C −= A B`.
fn subtract_product(c: &mut [f64], a: &[f64], b: &[f64], size: usize) {
    for (c, a) in c.chunks_exact_mut(size).zip(a.chunks_exact(size)) {
        for (&factor, b) in a.iter().zip(b.chunks_exact(size)) {
            c.iter_mut().zip(b).for_each(|(c, b)| *c -= factor * b);
        }
    }
}

/// `y −= A x`.
fn subtract_applied(y: &mut [f64], a: &[f64], x: &[f64]) {
    for (y, row) in y.iter_mut().zip(a.chunks_exact(x.len())) {
        *y -= row.iter().zip(x).map(|(a, x)| a * x).sum::<f64>();
    }
}

/// Overwrites a block with its factors, `1/U` on the diagonal; returns the smallest pivot, NaN if one is.
fn factor_block(block: &mut [f64], exchanges: &mut [u8], row: &mut [f64]) -> f64 {
    let size = exchanges.len();
    let mut smallest = f64::INFINITY;
    for k in 0..size {
        let mut best = k;
        for candidate in k + 1..size {
            if block[candidate * size + k].abs() > block[best * size + k].abs() {
                best = candidate;
            }
        }
        exchanges[k] = best as u8;
        if best != k {
            for col in 0..size {
                block.swap(k * size + col, best * size + col);
            }
        }
        let pivot = block[k * size + k];
        // Written so that a NaN is kept.
        let is_larger = pivot.abs() >= smallest || smallest.is_nan();
        smallest = if is_larger { smallest } else { pivot.abs() };
        let inverse = 1.0 / pivot;
        block[k * size + k] = inverse;
        row.copy_from_slice(&block[k * size..(k + 1) * size]);
        for below in block[(k + 1) * size..].chunks_exact_mut(size) {
            let factor = below[k] * inverse;
            below[k] = factor;
            below[k + 1..].iter_mut().zip(&row[k + 1..]).for_each(|(entry, top)| *entry -= factor * top);
        }
    }
    smallest
}

/// Overwrites `x` with `D⁻¹ x`, by the factors of `D`.
fn solve_block(factors: &[f64], exchanges: &[u8], x: &mut [f64]) {
    let size = exchanges.len();
    // Rows were exchanged as a whole, with what stood left of the pivot.
    for (k, &other) in exchanges.iter().enumerate() {
        x.swap(k, other as usize);
    }
    for k in 0..size {
        for row in k + 1..size {
            x[row] -= factors[row * size + k] * x[k];
        }
    }
    for k in (0..size).rev() {
        let known: f64 = (k + 1..size).map(|col| factors[k * size + col] * x[col]).sum();
        x[k] = (x[k] - known) * factors[k * size + k];
    }
}

/// Overwrites `B` with `B D⁻¹`, by the factors of `D`.
fn divide_right(b: &mut [f64], factors: &[f64], exchanges: &[u8], size: usize) {
    for x in b.chunks_exact_mut(size) {
        for k in 0..size {
            x[k] *= factors[k * size + k];
            for col in k + 1..size {
                x[col] -= x[k] * factors[k * size + col];
            }
        }
        for k in (0..size).rev() {
            for row in k + 1..size {
                x[k] -= x[row] * factors[row * size + k];
            }
        }
        for k in (0..size).rev() {
            x.swap(k, exchanges[k] as usize);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Elimination, General};
    use super::Blocked;

    /// A number of a matrix that is neither symmetric nor dominated by its diagonal.
    fn number(row: usize, col: usize) -> f64 {
        ((3 * row + 7 * col) as f64).sin()
            + if row / 3 == col / 3 { 2.0 * ((row * col) as f64).cos() } else { 0.0 }
    }

    #[test]
    fn the_solution_solves_the_system() {
        const BLOCKS: usize = 12;
        const SIZE: usize = 3;
        let coupled: Vec<(usize, usize)> =
            (0..BLOCKS).flat_map(|i| [(i, (i + 1) % BLOCKS), (i, (i + 5) % BLOCKS)]).collect();
        let elimination = Elimination::new(BLOCKS, coupled.iter().copied(), |_| false).expect("little fill");
        let mut matrix = Blocked::zero(&elimination, SIZE).expect("small");
        let places: Vec<(usize, usize)> =
            coupled.iter().flat_map(|&(a, b)| [(a, b), (b, a)]).chain((0..BLOCKS).map(|i| (i, i))).collect();
        for round in 0..2 {
            matrix.clear();
            let mut product = vec![0.0; BLOCKS * SIZE];
            let exact = |col: usize| (col as f64 + 0.5).cos();
            for &(row, col) in &places {
                let block = matrix.block_mut(General::place(&elimination, row, col) as usize);
                for i in 0..SIZE {
                    for j in 0..SIZE {
                        let value = number(SIZE * row + i + round, SIZE * col + j);
                        block[SIZE * i + j] = value;
                        product[SIZE * row + i] += value * exact(SIZE * col + j);
                    }
                }
            }
            matrix.factor(&elimination).expect("a regular matrix");
            matrix.solve(&elimination, &mut product);
            let error = (0..BLOCKS * SIZE).map(|i| (product[i] - exact(i)).abs()).fold(0.0, f64::max);
            println!("{error:e}");
            // Without exchanges between blocks: measured.
            assert!(error < 1e-12, "{error:e}");
        }
    }

    #[test]
    fn a_block_without_inverse_is_told() {
        let elimination = Elimination::new(2, [(0, 1)], |_| false).expect("little fill");
        let mut matrix = Blocked::zero(&elimination, 2).expect("small");
        for unknown in 0..2 {
            let place = General::place(&elimination, unknown, unknown) as usize;
            matrix.block_mut(place).copy_from_slice(&[1.0, 2.0, 0.5, 1.0]);
        }
        assert!(matrix.factor(&elimination).is_err());
    }
}
