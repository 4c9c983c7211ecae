//! Constant matrices over the coordinates.

use core::marker::PhantomData;

use super::{AsScene, Coupling};
use crate::array::Array;
use crate::linear::{Factorization, SingularMatrix};
use crate::system::MechanicalSystem;

/// A square array of numbers, by rows.
pub(crate) type Rows<S> = <S as MechanicalSystem>::PerCoordinate<<S as MechanicalSystem>::PerCoordinate<f64>>;

/// A constant symmetric matrix over the coordinates, which couples those that `C` says.
// Aligned, so that instructions on two numbers take them from where they are.
#[repr(C, align(16))]
pub(crate) struct CoordinateMatrix<S: MechanicalSystem, C = AsScene> {
    /// All that is read of a diagonal matrix.
    diagonal: S::PerCoordinate<f64>,
    rows: Rows<S>,
    coupling: PhantomData<C>,
}

impl<S: MechanicalSystem> CoordinateMatrix<S> {
    pub(crate) fn zero_rows() -> Rows<S> {
        Array::from_fn(|_| Array::from_fn(|_| 0.0))
    }
}

impl<S: MechanicalSystem, C: Coupling<S>> CoordinateMatrix<S, C> {
    /// The inverse of a matrix, symmetric to the last bit.
    ///
    /// # Errors
    /// [`SingularMatrix`] if it has none.
    pub(crate) fn inverse_of(rows: &Rows<S>) -> Result<Self, SingularMatrix> {
        let factors = S::MassFactors::factor_of_any_size(rows)?;
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

    pub(crate) fn new(rows: Rows<S>) -> Self {
        Self { diagonal: Array::from_fn(|i| rows[i][i]), rows, coupling: PhantomData }
    }

    /// The element at `(row, col)`; `row = col` of a diagonal matrix.
    #[inline(always)]
    pub(crate) fn at(&self, row: usize, col: usize) -> f64 {
        if C::IS_DIAGONAL { self.diagonal[row] } else { self.rows[row][col] }
    }

    /// The product with a vector.
    #[inline(always)]
    pub(crate) fn times(&self, x: impl Fn(usize) -> f64) -> S::PerCoordinate<f64> {
        Array::from_fn(|i| {
            if C::IS_DIAGONAL {
                self.diagonal[i] * x(i)
            } else {
                (0..S::N_COORDINATES).map(|k| self.rows[i][k] * x(k)).sum()
            }
        })
    }
}

/// `rows · x`, for a matrix that need not be symmetric.
#[inline]
pub(crate) fn times<S: MechanicalSystem>(rows: &Rows<S>, x: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64> {
    Array::from_fn(|row| (0..S::N_COORDINATES).map(|col| rows[row][col] * x[col]).sum())
}

/// Adds `rowsᵀ · x` to `sum`.
#[inline]
pub(crate) fn add_transposed<S: MechanicalSystem>(
    rows: &Rows<S>,
    x: &S::PerCoordinate<f64>,
    sum: &mut S::PerCoordinate<f64>,
) {
    for row in 0..S::N_COORDINATES {
        for col in 0..S::N_COORDINATES {
            sum[col] += rows[row][col] * x[row];
        }
    }
}
