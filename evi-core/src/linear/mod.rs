//! Linear solves of a step: in, a square matrix by rows; out, factors that solve for right-hand sides.
//!
//! [`Factorization`] is the contract between the integrators and a scene's own solvers: closed forms for one or two
//! rows, the elimination that the derive emits for the scene's pattern ([`Guarded`]), the pivoted dense one for
//! every pattern ([`DenseLu`]), and one for constraints of a stated rank ([`NullSpace`]).

mod closed_form;
mod conditioning;
mod elimination;
#[cfg(feature = "std")]
mod in_place;
mod kkt;
#[cfg(feature = "std")]
mod lane_ldl;
mod null_space;
#[cfg(feature = "std")]
mod ordering;
pub(crate) mod orthonormal;
mod pivoted;
mod singular_values;
mod symmetric_eigen;
mod triangular;

pub use closed_form::{Inverse0, Inverse1, Inverse2};
pub use conditioning::Conditioning;
pub use elimination::{Elimination, Guarded, reciprocal_pivot};
#[cfg(feature = "std")]
pub(crate) use in_place::InPlaceLu;
pub(crate) use kkt::{FactoredKkt, Kkt, constraint_index, reciprocal_power_of_two, unknowns};
#[cfg(feature = "std")]
pub(crate) use lane_ldl::{LaneGram, LaneMass, factor_mass};
pub use null_space::NullSpace;
#[cfg(feature = "std")]
pub(crate) use ordering::band_places;
#[cfg(feature = "std")]
pub(crate) use pivoted::checked_pivot_ratio;
pub use pivoted::{DenseLu, Pivoted};
pub(crate) use singular_values::singular_values;
pub(crate) use symmetric_eigen::SymmetricEigen;
pub(crate) use triangular::Cholesky;

/// Factors of a square matrix `A`.
pub trait Factorization<V, M>: Sized {
    /// Factors the matrix that is given by rows.
    ///
    /// # Errors
    /// [`SingularMatrix`] when the smallest pivot is lost in the round-off of the largest.
    fn factor(matrix: &M) -> Result<Self, SingularMatrix>;

    /// The same for a matrix whose entries are so large or small that products of them may leave the numbers. Closed forms, which have such products,
    /// find them in another unit; where nothing waits for the factors, this is the one to call.
    ///
    /// # Errors
    /// As [`factor`](Self::factor).
    #[inline]
    fn factor_of_any_size(matrix: &M) -> Result<Self, SingularMatrix> {
        Self::factor(matrix)
    }

    /// The same for solutions that are small where they are right, which is looked at, with the [`doubt`](Self::doubt) added to it; what they solve is not evaluated
    /// again. Those with a singular matrix of one row are not finite, and nothing else tells.
    ///
    /// # Errors
    /// As [`factor`](Self::factor), of more rows, and where solutions lose more than four digits.
    #[inline(always)]
    fn factor_unguarded(matrix: &M) -> Result<Self, SingularMatrix> {
        Self::factor(matrix)
    }

    /// 0; NaN of a matrix that is not finite, and was not refused for it.
    #[inline(always)]
    fn doubt(&self) -> f64 {
        // Which the compiler does not add to anything.
        -0.0
    }

    /// Factors a matrix whose rows and columns have different units, if that needs no comparison of pivots with each other.
    #[inline]
    fn factor_unscaled(_matrix: &M) -> Option<Self> {
        None
    }

    /// Overwrites the right-hand side `b` with the solution of `A x = b`.
    fn solve(&self, rhs: &mut V);

    /// Overwrites the right-hand side `b` with `x / f` and returns `f`, where `A x = b`. A solution in closed form is a product with
    /// a quotient that is known last: what is linear in `x` need not wait for it.
    #[inline(always)]
    fn solve_up_to_factor(&self, rhs: &mut V) -> f64 {
        self.solve(rhs);
        1.0
    }

    /// Smallest pivot over largest, in `[0, 1]`: small values announce a singular matrix.
    fn pivot_ratio(&self) -> f64;

    /// Whether the pivoted dense solve has taken the place of the scene's own elimination.
    #[inline(always)]
    fn is_fallback(&self) -> bool {
        false
    }
}

/// A matrix is singular to working precision.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the matrix is singular: smallest over largest pivot is {pivot_ratio:e}")]
pub struct SingularMatrix {
    /// Smallest pivot over largest; NaN when the matrix has entries that are not finite.
    pub pivot_ratio: f64,
}

/// Maximum norm. A NaN among the values survives every later comparison: an iteration that left the numbers must not
/// seem to converge.
#[inline]
pub(crate) fn largest_magnitude(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |largest: f64, value| {
        if value.abs() <= largest || largest.is_nan() { largest } else { value.abs() }
    })
}
