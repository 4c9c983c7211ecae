//! Constant symmetric matrices over the coordinates, diagonal where the scene couples no two of them.

use crate::array::Array;
use crate::linear::{Factorization, SingularMatrix};
use crate::system::MechanicalSystem;

/// A square array of numbers, by rows.
pub(crate) type Rows<S> = <S as MechanicalSystem>::PerCoordinate<<S as MechanicalSystem>::PerCoordinate<f64>>;

/// A constant symmetric matrix over the coordinates.
pub(crate) struct CoordinateMatrix<S: MechanicalSystem> {
    /// All that is read where the scene is uncoupled.
    diagonal: S::PerCoordinate<f64>,
    rows: Rows<S>,
}

impl<S: MechanicalSystem> CoordinateMatrix<S> {
    pub(crate) fn zero_rows() -> Rows<S> {
        Array::from_fn(|_| Array::from_fn(|_| 0.0))
    }

    pub(crate) fn new(rows: Rows<S>) -> Self {
        Self { diagonal: Array::from_fn(|i| rows[i][i]), rows }
    }

    /// The inverse of a matrix, symmetric to the last bit.
    ///
    /// # Errors
    /// [`SingularMatrix`] if it has none.
    pub(crate) fn inverse_of(rows: &Rows<S>) -> Result<Self, SingularMatrix> {
        let factors = S::MassFactors::factor(rows)?;
        let columns: Rows<S> = Array::from_fn(|col| {
            let mut column = S::PerCoordinate::<f64>::from_fn(|row| if row == col { 1.0 } else { 0.0 });
            factors.solve(&mut column);
            column
        });
        Ok(Self::new(Array::from_fn(|row| {
            Array::from_fn(|col| 0.5 * (columns[col][row] + columns[row][col]))
        })))
    }

    /// `factor` times the matrix.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self::new(Array::from_fn(|row| Array::from_fn(|col| factor * self.rows[row][col])))
    }

    /// The element at `(row, col)`; `row = col` where the scene is uncoupled.
    #[inline(always)]
    pub(crate) fn at(&self, row: usize, col: usize) -> f64 {
        if S::STRUCTURE.is_uncoupled() { self.diagonal[row] } else { self.rows[row][col] }
    }

    /// The product with a vector.
    #[inline(always)]
    pub(crate) fn times(&self, x: impl Fn(usize) -> f64) -> S::PerCoordinate<f64> {
        Array::from_fn(|i| {
            if S::STRUCTURE.is_uncoupled() {
                self.diagonal[i] * x(i)
            } else {
                (0..S::N_COORDINATES).map(|k| self.rows[i][k] * x(k)).sum()
            }
        })
    }
}
