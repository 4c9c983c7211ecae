//! Dense elimination with partial pivoting, on the stack.

use nalgebra::{Const, DimMin, LU, SMatrix, SVector};

use super::{Factorization, SingularMatrix};

/// Pivots below this fraction of the largest are round-off of an `D × D` elimination.
const fn singular_pivot_ratio(dimension: usize) -> f64 {
    4.0 * dimension as f64 * f64::EPSILON
}

/// `P A = L U` with partial pivoting (Golub & Van Loan, Matrix Computations, 4th ed., alg. 3.4.1).
pub struct DenseLu<const D: usize>
where
    Const<D>: DimMin<Const<D>, Output = Const<D>>,
{
    factors: LU<f64, Const<D>, Const<D>>,
    pivot_ratio: f64,
}

impl<const D: usize> Factorization<[f64; D], [[f64; D]; D]> for DenseLu<D>
where
    Const<D>: DimMin<Const<D>, Output = Const<D>>,
{
    #[inline]
    fn factor(matrix: &[[f64; D]; D]) -> Result<Self, SingularMatrix> {
        let factors = LU::new(SMatrix::<f64, D, D>::from_fn(|row, col| matrix[row][col]));
        let (mut smallest, mut largest) = (f64::INFINITY, 0.0_f64);
        for i in 0..D {
            let pivot = factors.lu_internal()[(i, i)].abs();
            // Written so that a NaN pivot survives both comparisons.
            smallest = if pivot >= smallest { smallest } else { pivot };
            largest = if pivot <= largest { largest } else { pivot };
        }
        let pivot_ratio = if D == 0 { 1.0 } else { smallest / largest };
        if pivot_ratio > singular_pivot_ratio(D) {
            Ok(Self { factors, pivot_ratio })
        } else {
            Err(SingularMatrix { pivot_ratio })
        }
    }

    #[inline]
    fn solve(&self, rhs: &mut [f64; D]) {
        let mut solution = SVector::<f64, D>::from(*rhs);
        let solved = self.factors.solve_mut(&mut solution);
        assert!(solved, "a factored matrix has nonzero pivots");
        *rhs = solution.into();
    }

    #[inline]
    fn pivot_ratio(&self) -> f64 {
        self.pivot_ratio
    }
}
