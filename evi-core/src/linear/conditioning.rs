//! How well a matrix determines the solution of its equations: for who watches a run, and computed for nobody else.

use super::{Factorization, Pivoted, SingularMatrix};
use crate::array::Array;

/// Numbers of a matrix that equations are solved with, in units that give every unknown the same weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditioning {
    /// Smallest pivot over largest of an elimination with pivoting: 0 for a singular matrix.
    pub pivot_ratio: f64,
    /// `‖A‖₁ ‖A⁻¹‖₁`: what round-off is multiplied by; infinite for a singular matrix.
    pub condition: f64,
}

impl Conditioning {
    /// Of a matrix that is given by rows, by the columns of its inverse. `P` holds as many indices as there are rows.
    #[cold]
    pub(crate) fn of<V: Array<f64>, M: Array<V>, P: Array<usize>>(matrix: &M) -> Self {
        let factors = match Pivoted::<M, P>::factor(matrix) {
            Ok(factors) => factors,
            Err(SingularMatrix { pivot_ratio }) => return Self { pivot_ratio, condition: f64::INFINITY },
        };
        let (mut norm, mut inverse_norm) = (0.0_f64, 0.0_f64);
        for col in 0..M::LEN {
            norm = norm.max((0..M::LEN).map(|row| matrix[row][col].abs()).sum());
            let mut column = V::from_fn(|row| if row == col { 1.0 } else { 0.0 });
            factors.solve(&mut column);
            inverse_norm = inverse_norm.max(column.as_ref().iter().map(|x| x.abs()).sum());
        }
        // Without unknowns nothing is to be solved.
        let condition = if M::LEN == 0 { 1.0 } else { norm * inverse_norm };
        Self { pivot_ratio: factors.pivot_ratio(), condition }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of<const N: usize>(matrix: [[f64; N]; N]) -> Conditioning {
        Conditioning::of::<[f64; N], [[f64; N]; N], [usize; N]>(&matrix)
    }

    #[test]
    fn the_condition_is_that_of_the_inverse_in_closed_form() {
        // ‖A‖₁ = 7, A⁻¹ = [[3, -4], [-1, 2]] / 2, ‖A⁻¹‖₁ = 3.
        let Conditioning { condition, pivot_ratio } = of([[2.0, 4.0], [1.0, 3.0]]);
        assert_eq!((condition, pivot_ratio), (21.0, 0.5));
        // Hilbert's matrix of order 3: 748 (Higham, Accuracy and Stability of Numerical Algorithms, sec. 28.1).
        let hilbert = [0, 1, 2].map(|i| [0, 1, 2].map(|j| 1.0 / f64::from(i + j + 1)));
        assert!((of(hilbert).condition - 748.0).abs() < 1e-9);
    }

    #[test]
    fn a_singular_matrix_has_no_finite_condition() {
        assert_eq!(of([[1.0, 2.0], [2.0, 4.0]]), Conditioning { pivot_ratio: 0.0, condition: f64::INFINITY });
        assert!(of([[f64::NAN]]).pivot_ratio.is_nan());
        assert_eq!(of([]), Conditioning { pivot_ratio: 1.0, condition: 1.0 });
    }
}
