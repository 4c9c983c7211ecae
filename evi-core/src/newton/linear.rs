//! Linearly convergent iterations.

use super::{MAX_CORRECTIONS, NotConverged, STAGNATION, STAGNATION_RATIO, TARGET};
use crate::scalar::Scalar;

/// The corrections of a linearly convergent iteration so far, by the squares of their relative lengths: neither root nor division stands between a
/// correction and the decision about the next one.
#[derive(Clone, Copy, Default)]
pub(crate) struct LinearProgress {
    corrections: usize,
    /// Of the last correction, and of the one before; 0 where there is none.
    squares: [f64; 2],
}

impl LinearProgress {
    /// Whether the iteration has converged with a correction whose relative length has this `square`, and which has been applied.
    ///
    /// What a first guess is off by may shrink faster at first than what is left of it then: the slower one of the last two rates predicts the next
    /// correction, `rₖ max(rₖ / rₖ₋₁, rₖ₋₁ / rₖ₋₂)`, and the first two corrections have no rate.
    ///
    /// # Errors
    /// [`NotConverged`] when the iteration has left the numbers or takes too long.
    #[inline(always)]
    pub(crate) fn has_converged(&mut self, square: f64) -> Result<bool, NotConverged> {
        const SQUARED: f64 = TARGET * TARGET;
        let [previous, before] = self.squares;
        self.corrections += 1;
        self.squares = [square, previous];
        let is_slow_round_off = square * square < SQUARED * previous && square * previous < SQUARED * before;
        if square < SQUARED || is_slow_round_off {
            return Ok(true);
        }
        if square <= STAGNATION_RATIO * STAGNATION_RATIO * previous && self.corrections < MAX_CORRECTIONS {
            return Ok(false);
        }
        self.is_stuck(square, previous)
    }

    /// Whether an iteration that hardly proceeds has reached round-off.
    #[cold]
    fn is_stuck(&self, square: f64, previous: f64) -> Result<bool, NotConverged> {
        if square <= STAGNATION * STAGNATION && previous > 0.0 {
            Ok(true)
        } else if square.is_finite() && self.corrections < MAX_CORRECTIONS {
            Ok(false)
        } else {
            Err(NotConverged { corrections: self.corrections, last_correction: Scalar::sqrt(square) })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many corrections of these lengths it takes.
    fn passes(lengths: &[f64]) -> Option<usize> {
        let mut progress = LinearProgress::default();
        let is_last = |&length: &f64| progress.has_converged(length * length).expect("numbers");
        lengths.iter().position(is_last).map(|index| index + 1)
    }

    #[test]
    fn a_fast_start_is_not_mistaken_for_the_rate_of_convergence() {
        // Its second ratio promises 1e-18; at the rate of the third 1e-15 is left.
        assert_eq!(passes(&[1e-6, 1e-12, 1e-14, 1e-16, 1e-18]), Some(4));
        assert_eq!(passes(&[1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14, 1e-16]), Some(8));
        assert_eq!(passes(&[0.0]), Some(1));
        assert_eq!(passes(&[1e-17]), Some(1));
    }

    #[test]
    fn two_corrections_tell_no_rate_that_counts() {
        assert_eq!(passes(&[1e-6, 1e-13, 2e-16]), Some(3));
        assert_eq!(passes(&[0.0, 1e-6, 1e-14]), Some(1));
    }

    #[test]
    fn round_off_that_no_longer_shrinks_ends_the_iteration() {
        assert_eq!(passes(&[1e-12, 9e-13]), Some(2));
        assert_eq!(passes(&[1e-4, 2e-4, 1e-8]), None);
    }

    #[test]
    fn what_never_converges_is_reported_with_its_length() {
        let mut progress = LinearProgress::default();
        let error = (0..).find_map(|_| progress.has_converged(1e-8).err()).expect("it never converges");
        assert_eq!((error.corrections, error.last_correction), (MAX_CORRECTIONS, 1e-4));
        assert!(LinearProgress::default().has_converged(f64::NAN).is_err());
    }
}
