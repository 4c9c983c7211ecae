//! Elimination with pivoting, by faer, for nets that fill in too much for [`Elimination`](super::Elimination): its symbolic part is done once, and
//! dense blocks of columns are eliminated together.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::lu::{LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par};

use crate::linear::SingularMatrix;

/// A matrix by columns, and its factors.
pub(in super::super) struct Pivoted {
    /// Where the entries of a column begin, and where the last ones end.
    starts: Vec<usize>,
    rows: Vec<usize>,
    entries: Vec<f64>,
    symbolic: SymbolicLu<usize>,
    factors: NumericLu<usize, f64>,
    storage: MemBuffer,
}

impl Pivoted {
    /// For matrices with nonzeros where unknowns are `coupled`, in either order, and on the diagonal. `None` if there is no memory for it.
    pub(in super::super) fn new(
        n_unknowns: usize,
        coupled: impl IntoIterator<Item = (usize, usize)>,
    ) -> Option<Self> {
        let mut places: Vec<(usize, usize)> = (0..n_unknowns).map(|i| (i, i)).collect();
        for (a, b) in coupled {
            places.extend([(a, b), (b, a)]);
        }
        places.sort_unstable();
        places.dedup();
        let mut starts = vec![0; n_unknowns + 1];
        for &(col, _) in &places {
            starts[col + 1] += 1;
        }
        for col in 0..n_unknowns {
            starts[col + 1] += starts[col];
        }
        let rows: Vec<usize> = places.into_iter().map(|(_, row)| row).collect();
        let pattern = SymbolicSparseColMatRef::new_checked(n_unknowns, n_unknowns, &starts, None, &rows);
        let symbolic = factorize_symbolic_lu(pattern, LuSymbolicParams::default()).ok()?;
        let to_factor = symbolic.factorize_numeric_lu_scratch::<f64>(Par::Seq, Default::default());
        let to_solve = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        let storage = MemBuffer::try_new(to_factor.or(to_solve)).ok()?;
        Some(Self {
            entries: vec![0.0; rows.len()],
            starts,
            rows,
            symbolic,
            factors: NumericLu::new(),
            storage,
        })
    }

    /// Number of unknowns.
    pub(in super::super) fn n_unknowns(&self) -> usize {
        self.starts.len() - 1
    }

    /// Where the entry of a row and a column lies in [`entries_mut`](Self::entries_mut).
    pub(in super::super) fn place(&self, row: usize, col: usize) -> u32 {
        let range = self.starts[col]..self.starts[col + 1];
        let found = self.rows[range.clone()].binary_search(&row);
        (range.start + found.expect("the pattern holds the entry")) as u32
    }

    /// The entries, to be written before a factorisation; it keeps them.
    pub(in super::super) fn entries_mut(&mut self) -> &mut [f64] {
        &mut self.entries
    }

    /// Factors the matrix. A singular one may pass: its solutions are no numbers then.
    ///
    /// # Errors
    /// [`SingularMatrix`] where the pattern alone makes it singular, or an entry is no number.
    pub(in super::super) fn factor(&mut self) -> Result<f64, SingularMatrix> {
        let singular = SingularMatrix { pivot_ratio: 0.0 };
        if !self.entries.iter().all(|entry| entry.is_finite()) {
            return Err(SingularMatrix { pivot_ratio: f64::NAN });
        }
        let n = self.symbolic.nrows();
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &self.starts, None, &self.rows);
        let matrix = SparseColMatRef::new(pattern, &self.entries[..]);
        let stack = MemStack::new(&mut self.storage);
        self.symbolic
            .factorize_numeric_lu(&mut self.factors, matrix, Par::Seq, stack, Default::default())
            .map_err(|_| singular)?;
        Ok(1.0)
    }

    /// Overwrites the right-hand side with the solution; the matrix is factored.
    pub(in super::super) fn solve(&mut self, rhs: &mut [f64]) {
        let n = rhs.len();
        let factors = LuRef::new_unchecked(&self.symbolic, &self.factors);
        let stack = MemStack::new(&mut self.storage);
        let rhs = MatMut::from_column_major_slice_mut(rhs, n, 1);
        factors.solve_in_place_with_conj(Conj::No, rhs, Par::Seq, stack);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Elimination, General};
    use super::Pivoted;

    #[test]
    fn solves_as_the_elimination_in_a_fixed_order_does() {
        let n = 60;
        let coupled: Vec<(usize, usize)> =
            (0..n).flat_map(|i| [(i, (i + 1) % n), (i, (i + 7) % n)]).collect();
        let elimination = Elimination::new(n, coupled.iter().copied(), |_| false).expect("little fill");
        let mut ordered = General::zero(&elimination);
        let mut pivoted = Pivoted::new(n, coupled.iter().copied()).expect("memory");
        let diagonal = (0..n).map(|i| (i, i));
        for round in 0..3 {
            ordered.entries_mut().fill(0.0);
            pivoted.entries_mut().fill(0.0);
            for (row, col) in coupled.iter().flat_map(|&(a, b)| [(a, b), (b, a)]).chain(diagonal.clone()) {
                let beside = ((3 * row + 5 * col + round) as f64).sin();
                let value = if row == col { 6.0 + beside } else { beside };
                ordered.entries_mut()[General::place(&elimination, row, col) as usize] = value;
                let place = pivoted.place(row, col) as usize;
                pivoted.entries_mut()[place] = value;
            }
            ordered.factor(&elimination).expect("a regular matrix");
            pivoted.factor().expect("a regular matrix");
            let mut x: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
            let mut y = x.clone();
            ordered.solve(&elimination, &mut x);
            pivoted.solve(&mut y);
            let difference = x.iter().zip(&y).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
            assert!(difference < 1e-15 && x.iter().any(|x| x.abs() > 0.1), "{difference:e}");
        }
    }
}
