//! Dense elimination with partial pivoting over any storage, for matrices that are full although the scene's are not.

use super::dense::checked_pivot_ratio;
use super::{Factorization, SingularMatrix};
use crate::array::Array;

/// `P A = L U` (Golub & Van Loan, Matrix Computations, 4th ed., alg. 3.4.1).
pub(crate) struct Pivoted<M, P> {
    /// `U` on and above the diagonal, the multipliers of `L` below it.
    rows: M,
    /// The row that step `k` exchanged with row `k`.
    exchanges: P,
    pivot_ratio: f64,
}

impl<V, M, P> Factorization<V, M> for Pivoted<M, P>
where
    V: Array<f64>,
    M: Array<V>,
    P: Array<usize>,
{
    #[inline]
    fn factor(matrix: &M) -> Result<Self, SingularMatrix> {
        let n = M::LEN;
        let mut rows = matrix.clone();
        let mut exchanges = P::from_fn(|k| k);
        for k in 0..n {
            let pivot =
                (k..n).fold(k, |best, i| if rows[i][k].abs() > rows[best][k].abs() { i } else { best });
            exchanges[k] = pivot;
            rows.as_mut().swap(k, pivot);
            let (above, below) = rows.as_mut().split_at_mut(k + 1);
            let pivot_row = &above[k];
            for row in below {
                // Not finite where the pivot vanishes: the matrix is then refused.
                let factor = row[k] / pivot_row[k];
                row[k] = factor;
                for col in k + 1..n {
                    row[col] -= factor * pivot_row[col];
                }
            }
        }
        let pivot_ratio = checked_pivot_ratio(n, |i| rows[i][i])?;
        Ok(Self { rows, exchanges, pivot_ratio })
    }

    #[inline]
    fn solve(&self, rhs: &mut V) {
        let n = M::LEN;
        // The multipliers of a column were exchanged with the rows below it: all exchanges come before the substitution.
        for k in 0..n {
            rhs.as_mut().swap(k, self.exchanges[k]);
        }
        for k in 0..n {
            for row in k + 1..n {
                let known = self.rows[row][k] * rhs[k];
                rhs[row] -= known;
            }
        }
        for row in (0..n).rev() {
            let known: f64 = (row + 1..n).map(|col| self.rows[row][col] * rhs[col]).sum();
            rhs[row] = (rhs[row] - known) / self.rows[row][row];
        }
    }

    #[inline]
    fn pivot_ratio(&self) -> f64 {
        self.pivot_ratio
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Factors<const N: usize> = Pivoted<[[f64; N]; N], [usize; N]>;

    #[test]
    fn rows_are_exchanged_where_a_pivot_vanishes() {
        let matrix = [[0.0, 2.0, 1.0], [1.0, 0.0, 3.0], [4.0, -1.0, 0.0]];
        let x = [0.5, -1.5, 2.0];
        let mut y: [f64; 3] = core::array::from_fn(|row| (0..3).map(|col| matrix[row][col] * x[col]).sum());
        Factors::<3>::factor(&matrix).expect("regular").solve(&mut y);
        assert!((0..3).all(|i| (y[i] - x[i]).abs() < 1e-15), "{y:?}");
    }

    #[test]
    fn singular_matrices_are_refused() {
        assert!(Factors::<2>::factor(&[[1.0, 2.0], [2.0, 4.0]]).is_err());
        assert!(Factors::<2>::factor(&[[0.0, 0.0], [0.0, 1.0]]).is_err());
        assert!(Factors::<2>::factor(&[[f64::NAN, 1.0], [0.0, 1.0]]).is_err());
        assert!(Factors::<0>::factor(&[]).is_ok());
    }
}
