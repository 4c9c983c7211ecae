//! Modes of a stiffness in the metric of a mass matrix, and functions of the matrix `W² = M⁻¹ Ω`.

use super::Rows;
use crate::array::Array;
use crate::linear::{Cholesky, SymmetricEigen};
use crate::scheme::LinearisationError;
use crate::system::MechanicalSystem;

/// An eigenvalue below this many roundings of the largest, per coordinate, is a zero: a free mode stays one.
const ZERO: f64 = 4.0 * f64::EPSILON;

/// `Ω xₖ = κₖ M xₖ`, with `xₖᵀ M xₗ = δₖₗ`.
pub(crate) struct Modes<S: MechanicalSystem> {
    /// `κₖ`, ascending.
    pub(crate) squared_frequencies: S::PerCoordinate<f64>,
    /// `xₖ`, one per row.
    pub(crate) shapes: Rows<S>,
    /// `M xₖ`, one per row.
    pub(crate) momenta: Rows<S>,
}

impl<S: MechanicalSystem> Modes<S> {
    /// Of symmetric matrices, of which the lower triangles are read.
    ///
    /// # Errors
    /// [`LinearisationError`] for a mass matrix that is not positive definite, or numbers that are not finite.
    pub(crate) fn new(mass: &Rows<S>, stiffness: &Rows<S>) -> Result<Self, LinearisationError> {
        let metric = Cholesky::new(mass).ok_or(LinearisationError::Mass)?;
        Self::in_metric(&metric, &reduced::<S>(&metric, stiffness)?)
    }

    /// The modes whose stiffness in coordinates of unit mass, `L⁻¹ Ω L⁻ᵀ` with `M = L Lᵀ`, is `reduced`.
    pub(crate) fn in_metric(
        metric: &Cholesky<Rows<S>>,
        reduced: &Rows<S>,
    ) -> Result<Self, LinearisationError> {
        if !reduced.as_ref().iter().flat_map(|row| row.as_ref()).all(|x| x.is_finite()) {
            return Err(LinearisationError::NotFinite);
        }
        let SymmetricEigen { mut values, vectors } =
            SymmetricEigen::<S::PerCoordinate<f64>, Rows<S>>::new(reduced);
        let largest = values.as_ref().iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        for value in values.as_mut() {
            if value.abs() <= ZERO * S::N_COORDINATES as f64 * largest {
                *value = 0.0;
            }
        }
        let shapes = Array::from_fn(|k| {
            let mut shape: S::PerCoordinate<f64> = vectors[k].clone();
            metric.solve_transposed(&mut shape);
            shape
        });
        let momenta = Array::from_fn(|k| metric.times(&vectors[k]));
        Ok(Self { squared_frequencies: values, shapes, momenta })
    }

    /// `Σ f(k) (M xₖ)(M xₖ)ᵀ`: a function of `W` that takes positions to momenta; symmetric to the last bit.
    pub(crate) fn to_momenta(&self, f: impl Fn(usize) -> f64) -> Rows<S> {
        self.sum(f, &self.momenta, &self.momenta)
    }

    /// `Σ f(k) xₖ xₖᵀ`: a function of `W` that takes momenta to positions; symmetric to the last bit.
    pub(crate) fn to_positions(&self, f: impl Fn(usize) -> f64) -> Rows<S> {
        self.sum(f, &self.shapes, &self.shapes)
    }

    /// `Σ f(k) xₖ (M xₖ)ᵀ = f(W)`: positions to positions.
    pub(crate) fn function(&self, f: impl Fn(usize) -> f64) -> Rows<S> {
        self.sum(f, &self.shapes, &self.momenta)
    }

    fn sum(&self, f: impl Fn(usize) -> f64, left: &Rows<S>, right: &Rows<S>) -> Rows<S> {
        let f = S::PerCoordinate::<f64>::from_fn(f);
        Array::from_fn(|row| {
            Array::from_fn(|col| {
                // The product of the two vectors first: it commutes.
                (0..S::N_COORDINATES).map(|k| f[k] * (left[k][row] * right[k][col])).sum()
            })
        })
    }
}

/// `L⁻¹ Ω L⁻ᵀ`.
pub(crate) fn reduced<S: MechanicalSystem>(
    metric: &Cholesky<Rows<S>>,
    stiffness: &Rows<S>,
) -> Result<Rows<S>, LinearisationError> {
    // Columns of Ω are its rows: L⁻¹ on each leaves the rows of Ω L⁻ᵀ.
    let half: Rows<S> = Array::from_fn(|row| {
        let mut line = S::PerCoordinate::<f64>::from_fn(|col| stiffness[row.max(col)][row.min(col)]);
        metric.solve(&mut line);
        line
    });
    let transposed: Rows<S> = Array::from_fn(|row| {
        let mut line = S::PerCoordinate::<f64>::from_fn(|col| half[col][row]);
        metric.solve(&mut line);
        line
    });
    Ok(transposed)
}
