//! What is computed with: one number, or a number for each of eight nodes.

use crate::scalar::{Lanes, Scalar};

/// A number of a sparse elimination.
pub(super) trait Number: Scalar {
    /// Zero.
    const ZERO: Self;

    /// `self + a · b`, rounded once if `FUSED`.
    #[must_use]
    fn plus_product<const FUSED: bool>(self, a: Self, b: Self) -> Self;
}

impl Number for f64 {
    const ZERO: Self = 0.0;

    #[inline(always)]
    fn plus_product<const FUSED: bool>(self, a: Self, b: Self) -> Self {
        self + a * b
    }
}

impl Number for Lanes {
    const ZERO: Self = Self::ZERO;

    #[inline(always)]
    fn plus_product<const FUSED: bool>(self, a: Self, b: Self) -> Self {
        a.times_plus::<FUSED>(b, self)
    }
}
