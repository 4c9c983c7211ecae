//! A scene's own elimination, guarded: straight-line code without pivoting where its pivots are sound, the pivoted
//! dense solve where they are not.

use super::{DenseLu, Factorization, SingularMatrix};

/// A pivot below this fraction of the terms that it is a sum of has lost four digits: more would cost Newton's iteration
/// a correction, and the velocity its hidden constraints.
const SMALLEST_PIVOT: f64 = 1e-4;

/// Elimination in an order that is fixed at compile time, without pivoting.
pub trait Elimination<const D: usize>: Sized {
    /// Factors the matrix that is given by rows; `None` if a pivot is round-off.
    fn factor(matrix: &[[f64; D]; D]) -> Option<Self>;

    /// Overwrites the right-hand side with the solution.
    fn solve(&self, rhs: &mut [f64; D]);
}

/// `1 / pivot`, if the pivot is not round-off of terms whose magnitudes add up to `magnitude`.
#[inline]
pub fn reciprocal_pivot(pivot: f64, magnitude: f64) -> Option<f64> {
    (pivot.abs() > SMALLEST_PIVOT * magnitude).then(|| 1.0 / pivot)
}

/// An [`Elimination`] with the pivoted dense solve as its fallback.
pub enum Guarded<E, const D: usize> {
    /// The scene's own elimination.
    Own(E),
    /// The pivoted dense solve.
    Dense(DenseLu<D>),
}

impl<E: Elimination<D>, const D: usize> Factorization<[f64; D], [[f64; D]; D]> for Guarded<E, D> {
    #[inline]
    fn factor(matrix: &[[f64; D]; D]) -> Result<Self, SingularMatrix> {
        match E::factor(matrix) {
            Some(own) => Ok(Self::Own(own)),
            None => dense(matrix).map(Self::Dense),
        }
    }

    #[inline]
    fn factor_unscaled(matrix: &[[f64; D]; D]) -> Option<Self> {
        E::factor(matrix).map(Self::Own)
    }

    #[inline]
    fn solve(&self, rhs: &mut [f64; D]) {
        match self {
            Self::Own(own) => own.solve(rhs),
            Self::Dense(dense) => dense.solve(rhs),
        }
    }

    fn pivot_ratio(&self) -> f64 {
        match self {
            Self::Own(_) => 1.0,
            Self::Dense(dense) => dense.pivot_ratio(),
        }
    }

    #[inline(always)]
    fn is_fallback(&self) -> bool {
        matches!(self, Self::Dense(_))
    }
}

#[cold]
fn dense<const D: usize>(matrix: &[[f64; D]; D]) -> Result<DenseLu<D>, SingularMatrix> {
    DenseLu::factor(matrix)
}
