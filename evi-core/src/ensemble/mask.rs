//! Which of eight members something is meant for.

use crate::scalar::{LANES, Lanes};

/// A choice of lanes.
///
/// Comparisons with a NaN choose nothing, so that a lane that has left the numbers never counts as solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaneMask(
    /// 1 where a lane is chosen, 0 where it is not: what comparisons, products and choices of vectors are made of.
    Lanes,
);

impl LaneMask {
    /// No lane.
    pub const NONE: Self = Self(Lanes::ZERO);
    /// Every lane.
    pub const ALL: Self = Self(Lanes::splat(1.0));

    /// These lanes.
    pub fn of(chosen: [bool; LANES]) -> Self {
        Self(Lanes::new(chosen.map(|chosen| if chosen { 1.0 } else { 0.0 })))
    }

    /// The first `count` lanes.
    pub fn first(count: usize) -> Self {
        Self::of(core::array::from_fn(|lane| lane < count))
    }

    /// Whether `a ≤ b` in every lane: what is asked before a mask is made, since the answer is a flag, not a vector.
    #[inline(always)]
    pub fn is_everywhere_at_most(a: Lanes, b: Lanes) -> bool {
        let (a, b) = (a.to_array(), b.to_array());
        let mut all = true;
        for lane in 0..LANES {
            all &= a[lane] <= b[lane];
        }
        all
    }

    /// Where `a ≤ b`.
    #[inline(always)]
    pub fn at_most(a: Lanes, b: Lanes) -> Self {
        Self::compare(a, b, |a, b| a <= b)
    }

    /// Where `a < b`.
    #[inline(always)]
    pub fn below(a: Lanes, b: Lanes) -> Self {
        Self::compare(a, b, |a, b| a < b)
    }

    #[inline(always)]
    fn compare(a: Lanes, b: Lanes, holds: impl Fn(f64, f64) -> bool) -> Self {
        let (a, b) = (a.to_array(), b.to_array());
        let mut chosen = [0.0; LANES];
        for lane in 0..LANES {
            chosen[lane] = if holds(a[lane], b[lane]) { 1.0 } else { 0.0 };
        }
        Self(Lanes::new(chosen))
    }

    /// The lanes of both.
    #[inline(always)]
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }

    /// The lanes of either.
    #[inline(always)]
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self(self.0.larger(other.0))
    }

    /// The lanes of `self` that are none of `other`.
    #[inline(always)]
    #[must_use]
    pub fn without(self, other: Self) -> Self {
        Self(self.0 * (Lanes::splat(1.0) - other.0))
    }

    /// The same choice but for one lane.
    #[inline(always)]
    #[must_use]
    pub fn with(self, lane: usize, chosen: bool) -> Self {
        Self(self.0.with(lane, if chosen { 1.0 } else { 0.0 }))
    }

    /// Whether any lane is chosen.
    #[inline(always)]
    pub fn is_any(self) -> bool {
        let chosen = self.0.to_array();
        let mut any = false;
        for lane in 0..LANES {
            any |= chosen[lane] > 0.0;
        }
        any
    }

    /// Whether every lane is chosen.
    #[inline(always)]
    pub fn is_all(self) -> bool {
        Self::is_everywhere_at_most(Lanes::splat(1.0), self.0)
    }

    /// Whether this lane is chosen.
    #[inline(always)]
    pub fn has(self, lane: usize) -> bool {
        self.0.to_array()[lane] > 0.0
    }

    /// The chosen lanes.
    pub fn lanes(self) -> impl Iterator<Item = usize> {
        (0..LANES).filter(move |&lane| self.has(lane))
    }

    /// `chosen` in the chosen lanes, `other` elsewhere.
    #[inline(always)]
    pub fn select(self, chosen: Lanes, other: Lanes) -> Lanes {
        let (mask, a, b) = (self.0.to_array(), chosen.to_array(), other.to_array());
        let mut result = [0.0; LANES];
        for lane in 0..LANES {
            result[lane] = if mask[lane] > 0.0 { a[lane] } else { b[lane] };
        }
        Lanes::new(result)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masks_choose_by_comparison_and_a_nan_is_never_chosen() {
        let x = Lanes::new([1.0, 2.0, f64::NAN, 4.0, 0.0, -1.0, f64::INFINITY, 2.0]);
        let small = LaneMask::at_most(x, Lanes::splat(2.0));
        assert_eq!(small.lanes().collect::<Vec<_>>(), [0, 1, 4, 5, 7]);
        assert_eq!(LaneMask::below(x, Lanes::splat(2.0)).lanes().collect::<Vec<_>>(), [0, 4, 5]);
        let mixed = small.select(x, Lanes::splat(9.0)).to_array();
        assert_eq!(mixed, [1.0, 2.0, 9.0, 9.0, 0.0, -1.0, 9.0, 2.0]);
        assert_eq!(small.without(LaneMask::first(2)).lanes().collect::<Vec<_>>(), [4, 5, 7]);
        assert_eq!(LaneMask::NONE.with(3, true).or(LaneMask::first(1)).lanes().collect::<Vec<_>>(), [0, 3]);
        assert!(LaneMask::is_everywhere_at_most(Lanes::ZERO, Lanes::splat(0.0)));
        assert!(!LaneMask::is_everywhere_at_most(x, Lanes::splat(f64::INFINITY)), "there is a NaN");
        assert!(!LaneMask::NONE.is_any() && LaneMask::ALL.and(LaneMask::first(1)).is_any());
    }
}
