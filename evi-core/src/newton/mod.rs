//! Newton's iteration and its stopping rule, once for every implicit equation of the crate.
//!
//! In: a function that applies one correction and returns its relative length. Out: the number of corrections, or
//! how it failed. The equations, their matrix and the scale of "relative" are the caller's.

mod diagnostics;
#[cfg(feature = "std")]
mod linear;
mod tally;

pub use diagnostics::{Diagnostics, Worst};
#[cfg(feature = "std")]
pub(crate) use linear::LinearProgress;
pub use tally::{Fallbacks, Statistics, Tally};

/// Stop when the correction after this one would be below this fraction of the unknowns: a quarter of round-off.
pub(crate) const TARGET: f64 = 0.25 * f64::EPSILON;
/// A correction that no longer shrinks ends the iteration only below this length (Hairer, McLachlan,
/// Razakarivony, BIT 48 (2008) 231: iterate until the update stops decreasing); above it, it may grow once.
pub(crate) const STAGNATION: f64 = 1e-12;
/// Corrections that shrink by less than this factor have stagnated.
pub(crate) const STAGNATION_RATIO: f64 = 0.5;
/// A frozen matrix that is good to a few percent contracts by a few hundredths; beyond this it is a bad guess.
pub(crate) const SLOWEST_CHORD: f64 = 0.1;
/// Corrections of a frozen matrix below this length are round-off, whatever their ratio.
pub(crate) const CHORD_ROUND_OFF: f64 = 8.0 * f64::EPSILON;
/// What is light beside the rest has no length in the metric of the masses: lengths count in plain numbers as well, so much less that the metric
/// decides wherever masses are of one size.
#[cfg(feature = "std")]
pub(crate) const LIGHT: f64 = 1.0 / 16.0;
/// Newton from the predictors used here takes 3 to 6 corrections; a solution not found by then is not near.
pub(crate) const MAX_CORRECTIONS: usize = 30;

/// A converged iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Converged {
    /// Number of corrections applied.
    pub(crate) corrections: usize,
}

/// An iteration that did not converge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NotConverged {
    /// Number of corrections applied.
    pub(crate) corrections: usize,
    /// Relative length of the last one; NaN or infinite when the iteration left the numbers.
    pub(crate) last_correction: f64,
}

/// The corrections of an iteration so far.
#[derive(Clone, Copy, Default)]
pub(crate) struct Progress {
    corrections: usize,
    /// Relative length of the last correction; 0 before the first.
    previous: f64,
}

impl Progress {
    /// The progress of an iteration that goes on after a correction of relative length `previous`.
    pub(crate) const fn after(previous: f64) -> Self {
        Self { corrections: 0, previous }
    }

    /// Whether the iteration has converged with a correction of relative length `length`, which has been applied.
    ///
    /// # Errors
    /// [`NotConverged`] when the iteration has left the numbers or takes too long.
    #[inline(always)]
    pub(crate) fn has_converged(&mut self, length: f64) -> Result<bool, NotConverged> {
        let is_round_off = predicts_round_off(length, self.previous, 1.0);
        self.record(length, is_round_off)
    }

    /// The same for an iteration that judges its parts, each by [`predicts_round_off`].
    ///
    /// # Errors
    /// As for [`has_converged`](Self::has_converged).
    #[inline(always)]
    pub(crate) fn record(&mut self, length: f64, is_round_off: bool) -> Result<bool, NotConverged> {
        self.corrections += 1;
        let previous = core::mem::replace(&mut self.previous, length);
        if is_round_off {
            return Ok(true);
        }
        if length <= STAGNATION_RATIO * previous && self.corrections < MAX_CORRECTIONS {
            return Ok(false);
        }
        self.is_stuck(length, previous)
    }

    /// Whether an iteration that hardly proceeds has reached round-off.
    #[cold]
    fn is_stuck(&self, length: f64, previous: f64) -> Result<bool, NotConverged> {
        if length <= STAGNATION && previous > 0.0 {
            Ok(true)
        } else if length.is_finite() && self.corrections < MAX_CORRECTIONS {
            Ok(false)
        } else {
            Err(NotConverged { corrections: self.corrections, last_correction: length })
        }
    }

    /// Number of corrections applied.
    pub(crate) const fn corrections(&self) -> usize {
        self.corrections
    }
}

/// Whether corrections of lengths `rₖ₋₁`, `rₖ` leave no further one: `rₖ · min(1, rₖ / rₖ₋₁)` is below round-off of `scale`.
/// The product predicts the next correction of a linearly convergent iteration, and overestimates it for a quadratically
/// convergent one. `previous` is 0 before the first correction.
#[inline(always)]
pub(crate) fn predicts_round_off(length: f64, previous: f64, scale: f64) -> bool {
    let (target, previous) = (TARGET * scale.abs(), previous.abs());
    // The larger one as the machine takes it; `f64::max` looks for a NaN, which here survives in `length`.
    let denominator = if previous > target { previous } else { target };
    // Strictly, since both sides overflow alike.
    length * length < target * denominator || length == 0.0
}

/// The same for squares of lengths relative to a scale of 1: neither root nor division.
#[inline(always)]
pub(crate) fn squares_predict_round_off(square: f64, previous: f64) -> bool {
    const SQUARED: f64 = TARGET * TARGET;
    let denominator = if previous > SQUARED { previous } else { SQUARED };
    square * square < SQUARED * denominator
}

/// Applies corrections until they have converged; returns their number.
///
/// # Errors
/// `E` from `correct`, or what `E` makes of [`NotConverged`].
#[inline]
pub(crate) fn iterate<E: From<NotConverged>>(
    mut correct: impl FnMut(usize) -> Result<f64, E>,
) -> Result<Converged, E> {
    let mut progress = Progress::default();
    loop {
        let length = correct(progress.corrections + 1)?;
        if progress.has_converged(length)? {
            return Ok(Converged { corrections: progress.corrections });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lengths(sequence: &'static [f64]) -> Result<Converged, NotConverged> {
        iterate(|k| Ok(sequence[(k - 1).min(sequence.len() - 1)]))
    }

    #[test]
    fn squares_are_judged_as_lengths_are() {
        for previous in [1e-2, 1e-6, 1e-12, 1e-17, 0.0] {
            for length in [1e-7, 1e-10, 1e-13, 1e-15, 1e-16, 1e-18, 0.0, f64::NAN, f64::INFINITY] {
                let of_squares = squares_predict_round_off(length * length, previous * previous);
                assert_eq!(of_squares, predicts_round_off(length, previous, 1.0), "{length:e} {previous:e}");
            }
        }
    }

    #[test]
    fn quadratic_convergence_stops_when_the_next_correction_is_round_off() {
        assert_eq!(lengths(&[1e-2, 1e-5, 1e-11, f64::NAN]), Ok(Converged { corrections: 3 }));
    }

    #[test]
    fn slow_linear_convergence_is_not_mistaken_for_convergence() {
        let result = iterate::<NotConverged>(|k| Ok(0.9_f64.powi(k as i32)));
        assert_eq!(result.unwrap_err().corrections, MAX_CORRECTIONS);
    }

    #[test]
    fn round_off_ends_the_iteration() {
        assert_eq!(lengths(&[1e-12, 9e-13]), Ok(Converged { corrections: 2 }));
    }

    #[test]
    fn a_correction_may_grow_while_it_is_large() {
        assert_eq!(lengths(&[1e-3, 2e-3, 1e-6, 1e-12, 1e-18]), Ok(Converged { corrections: 4 }));
    }

    #[test]
    fn values_that_are_not_numbers_are_reported() {
        let error = lengths(&[1.0, f64::INFINITY]).unwrap_err();
        assert_eq!((error.corrections, error.last_correction), (2, f64::INFINITY));
    }
}
