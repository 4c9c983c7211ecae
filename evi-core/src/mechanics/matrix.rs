//! Matrices over the coordinates of a scene.

use crate::array::Array;
use crate::linear::{Factorization, SingularMatrix};
use crate::system::MechanicalSystem;

/// A matrix over the coordinates, by rows.
pub(crate) type Matrix<S> =
    <S as MechanicalSystem>::PerCoordinate<<S as MechanicalSystem>::PerCoordinate<f64>>;

pub(crate) fn zero_matrix<S: MechanicalSystem>() -> Matrix<S> {
    Array::from_fn(|_| Array::from_fn(|_| 0.0))
}

/// `matrix · x`, elementwise for a matrix that couples no coordinates.
#[inline]
pub(crate) fn times<S: MechanicalSystem>(
    uncoupled: bool,
    matrix: &Matrix<S>,
    x: impl Fn(usize) -> f64,
) -> S::PerCoordinate<f64> {
    Array::from_fn(|i| {
        if uncoupled { matrix[i][i] * x(i) } else { (0..S::N_COORDINATES).map(|k| matrix[i][k] * x(k)).sum() }
    })
}

/// `sum += matrixᵀ · x`.
#[inline]
pub(crate) fn add_transposed<S: MechanicalSystem>(
    matrix: &Matrix<S>,
    x: &S::PerCoordinate<f64>,
    sum: &mut S::PerCoordinate<f64>,
) {
    for row in 0..S::N_COORDINATES {
        for col in 0..S::N_COORDINATES {
            sum[col] += matrix[row][col] * x[row];
        }
    }
}

/// The inverse of a matrix with the pattern of the mass matrix.
pub(crate) fn inverse<S: MechanicalSystem>(matrix: &Matrix<S>) -> Result<Matrix<S>, SingularMatrix> {
    let factors = S::MassFactors::factor(matrix)?;
    // Column by column, kept as rows: the matrix is symmetric, and made so to the last bit.
    let columns: Matrix<S> = Array::from_fn(|col| {
        let mut column = S::PerCoordinate::<f64>::from_fn(|row| if row == col { 1.0 } else { 0.0 });
        factors.solve(&mut column);
        column
    });
    Ok(Array::from_fn(|row| Array::from_fn(|col| 0.5 * (columns[col][row] + columns[row][col]))))
}
