//! Elimination of large matrices with few nonzeros, in an order that is found once.
//!
//! In: which unknowns share an equation. Out: an [`Elimination`], the order and everything that depends on the pattern alone; with it matrices are
//! factored in place, again and again, as [`General`] or [`Symmetric`] ones, or as [`Blocked`] ones whose entries are small matrices. On chains, trees and rings of bodies the cost is proportional to
//! their number.

mod blocked;
mod elimination;
mod general;
mod ordering;
#[cfg(feature = "sparse")]
mod pivoted;
mod symmetric;

pub(super) use blocked::Blocked;
pub use elimination::Effort;
pub(super) use elimination::{Elimination, TooMuchFill};
pub(super) use general::General;
#[cfg(feature = "sparse")]
pub(super) use pivoted::Pivoted;
pub(super) use symmetric::Symmetric;

use crate::linear::SingularMatrix;

/// A pivot below this share of the largest number that stood in its place is made of the round-off of what has cancelled.
const LOST: f64 = 64.0 * f64::EPSILON;

/// The smallest pivot as a share of the largest number that stood in its place: no unit enters.
#[derive(Clone, Copy)]
struct PivotShare(f64);

impl PivotShare {
    /// Before the first pivot.
    const NONE: Self = Self(1.0);

    #[inline(always)]
    fn see(&mut self, pivot: f64, peak: f64) {
        let share = pivot.abs() / peak;
        // Written so that a NaN is kept.
        let is_larger = share >= self.0 || self.0.is_nan();
        self.0 = if is_larger { self.0 } else { share };
    }

    fn checked(self) -> Result<f64, SingularMatrix> {
        if self.0 > LOST { Ok(self.0) } else { Err(SingularMatrix { pivot_ratio: self.0 }) }
    }
}
