//! What happens inside steps, counted.

use crate::linear::Conditioning;
use crate::memory::memory;

/// What is counted under the steps of a run. A step tells it what happens, as it happens, on ways that it gives up as well; what a tally does not count costs
/// nothing. Checkpoints are taken of runs whose tally is a [`Memory`](crate::memory::Memory), as all of this crate are.
pub trait Tally {
    /// Newton's iteration of a step has converged with so many corrections.
    #[inline(always)]
    fn count_corrections(&mut self, corrections: usize) {
        let _ = corrections;
    }

    /// The passes of a Galerkin or Gauss step have not converged from the last steps, and begin again from the state alone.
    #[inline(always)]
    fn count_restart(&mut self) {}

    /// The passes of a Galerkin step have not converged, and Newton's iteration has taken their place.
    #[inline(always)]
    fn count_newton(&mut self) {}

    /// A step that has failed was taken in so many parts.
    #[inline(always)]
    fn count_rescue(&mut self, parts: u64) {
        let _ = parts;
    }

    /// A pivot of the scene's own elimination was round-off, and the pivoted dense solve has taken its place.
    #[inline(always)]
    fn count_fallback(&mut self) {}

    /// A run begins a step; so many have been taken before.
    #[inline(always)]
    fn begin_step(&mut self, step: u64) {
        let _ = step;
    }

    /// Equations of a step are solved with a matrix, whose `conditioning` is computed when it is called.
    #[inline(always)]
    fn see_matrix(&mut self, conditioning: impl FnOnce() -> Conditioning) {
        let _ = conditioning;
    }

    /// Equations of a step are solved with a matrix of which no more is known than the ratio of its smallest pivot to its largest.
    #[inline(always)]
    fn see_pivot_ratio(&mut self, pivot_ratio: f64) {
        let _ = pivot_ratio;
    }

    /// Newton's iteration begins, or begins anew.
    #[inline(always)]
    fn begin_iteration(&mut self) {}

    /// Newton's iteration makes a correction of the relative `length` that is computed when it is called.
    #[inline(always)]
    fn see_correction(&mut self, length: impl FnOnce() -> f64) {
        let _ = length;
    }
}

/// Counts nothing.
impl Tally for () {}

/// Counts the fallbacks on the pivoted dense solve: an increment where one happens, nothing where none does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fallbacks {
    /// How often the pivoted dense solve has taken the place of the scene's own elimination.
    pub fallbacks: u64,
}

impl Tally for Fallbacks {
    #[cold]
    fn count_fallback(&mut self) {
        self.fallbacks += 1;
    }
}

/// Counts everything.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Corrections of the iterations for the end points of the steps taken, Newton's or passes; 0 where steps need none. Not those of a
    /// projection.
    pub corrections: u64,
    /// How often the pivoted dense solve has taken the place of the scene's own elimination.
    pub fallbacks: u64,
    /// Galerkin steps whose passes have begun again without the past.
    pub restarts: u64,
    /// Galerkin steps whose passes have been given up for Newton's iteration.
    pub newton_steps: u64,
    /// Steps that have failed as a whole and were taken in parts, by [`Rescued`](crate::integrator::Rescued) schemes.
    pub rescued_steps: u64,
}

impl Tally for Statistics {
    #[inline]
    fn count_corrections(&mut self, corrections: usize) {
        self.corrections += corrections as u64;
    }

    #[cold]
    fn count_restart(&mut self) {
        self.restarts += 1;
    }

    #[cold]
    fn count_newton(&mut self) {
        self.newton_steps += 1;
    }

    #[cold]
    fn count_rescue(&mut self, _parts: u64) {
        self.rescued_steps += 1;
    }

    #[cold]
    fn count_fallback(&mut self) {
        self.fallbacks += 1;
    }
}

memory!([] Fallbacks, |words| Self { fallbacks } => { words.count(fallbacks) });

memory!([] Statistics, |words| Self { corrections, fallbacks, restarts, newton_steps, rescued_steps } => {
    for count in [corrections, fallbacks, restarts, newton_steps, rescued_steps] {
        words.count(count);
    }
});
