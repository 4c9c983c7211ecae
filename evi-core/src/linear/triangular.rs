//! Cholesky factors, for the metric of a mass matrix.

use crate::array::Array;
use crate::scalar::Scalar;

/// A pivot below this fraction of its diagonal entry is the round-off of a semidefinite matrix.
const SMALLEST_PIVOT: f64 = 64.0 * f64::EPSILON;

/// `A = L Lᵀ` with lower triangular `L` by rows (Golub & Van Loan, Matrix Computations, 4th ed., sec. 4.2).
pub(crate) struct Cholesky<M> {
    lower: M,
}

impl<M> Cholesky<M> {
    /// Factors a symmetric matrix, of which the lower triangle is read; `None` if it is not positive definite.
    pub(crate) fn new<V: Array<f64>>(matrix: &M) -> Option<Self>
    where
        M: Array<V>,
    {
        let mut lower = M::from_fn(|_| V::from_fn(|_| 0.0));
        for row in 0..M::LEN {
            for col in 0..=row {
                let known: f64 = (0..col).map(|k| lower[row][k] * lower[col][k]).sum();
                let rest = matrix[row][col] - known;
                lower[row][col] = if row > col {
                    rest / lower[col][col]
                } else if rest > SMALLEST_PIVOT * matrix[row][row] {
                    Scalar::sqrt(rest)
                } else {
                    return None;
                };
            }
        }
        Some(Self { lower })
    }

    /// `L x`.
    pub(crate) fn times<V: Array<f64>>(&self, x: &V) -> V
    where
        M: Array<V>,
    {
        V::from_fn(|row| (0..=row).map(|col| self.lower[row][col] * x[col]).sum())
    }

    /// Overwrites `x` with `L⁻¹ x`.
    pub(crate) fn solve<V: Array<f64>>(&self, x: &mut V)
    where
        M: Array<V>,
    {
        for row in 0..M::LEN {
            let known: f64 = (0..row).map(|col| self.lower[row][col] * x[col]).sum();
            x[row] = (x[row] - known) / self.lower[row][row];
        }
    }

    /// Overwrites `x` with `L⁻ᵀ x`.
    pub(crate) fn solve_transposed<V: Array<f64>>(&self, x: &mut V)
    where
        M: Array<V>,
    {
        for row in (0..M::LEN).rev() {
            let known: f64 = (row + 1..M::LEN).map(|col| self.lower[col][row] * x[col]).sum();
            x[row] = (x[row] - known) / self.lower[row][row];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_positive_definite_matrix_is_factored() {
        let matrix = [[4.0, 2.0, 0.4], [2.0, 5.0, -1.0], [0.4, -1.0, 3.0]];
        let factors = Cholesky::new(&matrix).expect("positive definite");
        let x = [1.0, -2.0, 0.5];
        let mut y: [f64; 3] = core::array::from_fn(|row| (0..3).map(|col| matrix[row][col] * x[col]).sum());
        factors.solve(&mut y);
        factors.solve_transposed(&mut y);
        assert!((0..3).all(|i| (y[i] - x[i]).abs() < 1e-15), "{y:?}");
        let mut z = factors.times(&x);
        factors.solve(&mut z);
        assert!((0..3).all(|i| (z[i] - x[i]).abs() < 1e-15), "{z:?}");
    }

    #[test]
    fn what_is_not_positive_definite_is_refused() {
        assert!(Cholesky::new(&[[1.0, 2.0], [2.0, 1.0]]).is_none());
        assert!(Cholesky::new(&[[1.0, 1.0], [1.0, 1.0]]).is_none());
        assert!(Cholesky::new(&[[0.0]]).is_none());
        assert!(Cholesky::new(&[[f64::NAN]]).is_none());
    }
}
