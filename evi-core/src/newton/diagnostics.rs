//! The numerics of the steps of a run, watched.

use super::{CHORD_ROUND_OFF, Statistics, Tally};
use crate::linear::Conditioning;
use crate::memory::memory;

/// A number at its worst over a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worst {
    /// The number.
    pub value: f64,
    /// The step that it belongs to: how many had been taken before.
    pub step: u64,
}

/// Counts everything, and keeps the worst of what the equations of steps are like: a [`Tally`] for runs that one wants to understand, at the
/// price of an elimination with pivoting and an inverse per matrix.
///
/// ```
/// use evi_core::integrator::Diagnostics;
/// use evi_core::prelude::*;
/// # #[derive(MechanicalSystem)]
/// # #[evi(
/// #     coordinates(x, y),
/// #     kinetic = 0.5 * (der(x).powi(2) + der(y).powi(2)),
/// #     potential = 9.81 * y,
/// #     constraint(rod: x.powi(2) + y.powi(2) == 1.0),
/// # )]
/// # struct Pendulum {}
/// let run = Simulation::new(Pendulum {}, Evi::midpoint(0.01)).start([1.0, 0.0], [0.0; 2])?;
/// let mut run = run.with_tally(Diagnostics::default());
/// run.advance_to(1.0)?;
/// let diagnostics = run.tally();
/// // One constraint depends on no other.
/// assert_eq!(diagnostics.condition().expect("a constraint").value, 1.0);
/// // The worst iteration is one of the first steps, which have no past that the next one could be predicted from.
/// assert!(diagnostics.contraction().expect("several corrections").step < 4);
/// assert!(diagnostics.counts().corrections < 200, "less than two a step");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Diagnostics {
    counts: Statistics,
    /// Number of steps before the present one.
    step: u64,
    /// The last correction of the present iteration; 0 before the first.
    last_correction: f64,
    condition: Option<Worst>,
    pivot_ratio: Option<Worst>,
    contraction: Option<Worst>,
}

impl Diagnostics {
    /// What [`Statistics`] counts.
    pub const fn counts(&self) -> &Statistics {
        &self.counts
    }

    /// Largest condition `‖A‖₁ ‖A⁻¹‖₁` of a matrix: of the equations for positions and multipliers together, `G M⁻¹ Gᵀ` where positions are eliminated,
    /// those of the projection at the end of a step; each in units of its unknowns. `None` where no step had a matrix. Infinite if one was
    /// singular. Constraints that are nearly dependent show here: two at the angle `α`, in the metric of the mass matrix, as about `4/α²`.
    pub const fn condition(&self) -> Option<Worst> {
        self.condition
    }

    /// Smallest ratio of the smallest to the largest pivot of these matrices, and of those of Newton's iteration on all points of a step.
    pub const fn pivot_ratio(&self) -> Option<Worst> {
        self.pivot_ratio
    }

    /// Largest ratio of a correction of Newton's iteration to the one before, where both are above round-off: small where the first guess was a
    /// good one, about 1 where the iteration creeps, above 1 where it had to begin anew. `None` where no iteration took two. Passes over nodes are
    /// counted, not measured.
    pub const fn contraction(&self) -> Option<Worst> {
        self.contraction
    }
}

/// Keeps the worse of two, the first to come of equals.
fn keep(worst: &mut Option<Worst>, value: f64, step: u64, is_worse: impl Fn(f64, f64) -> bool) {
    // A NaN is the worst of all, and stays.
    let replaces =
        worst.is_none_or(|old| !old.value.is_nan() && (value.is_nan() || is_worse(value, old.value)));
    if replaces {
        *worst = Some(Worst { value, step });
    }
}

impl Tally for Diagnostics {
    fn begin_step(&mut self, step: u64) {
        self.step = step;
    }

    fn see_matrix(&mut self, conditioning: impl FnOnce() -> Conditioning) {
        let Conditioning { pivot_ratio, condition } = conditioning();
        keep(&mut self.condition, condition, self.step, |new, old| new > old);
        keep(&mut self.pivot_ratio, pivot_ratio, self.step, |new, old| new < old);
    }

    fn see_pivot_ratio(&mut self, pivot_ratio: f64) {
        keep(&mut self.pivot_ratio, pivot_ratio, self.step, |new, old| new < old);
    }

    fn begin_iteration(&mut self) {
        self.last_correction = 0.0;
    }

    fn see_correction(&mut self, length: impl FnOnce() -> f64) {
        let length = length();
        // Below, corrections are noise. Written so that a NaN counts.
        let is_round_off = length <= CHORD_ROUND_OFF;
        if !is_round_off && self.last_correction > 0.0 {
            keep(&mut self.contraction, length / self.last_correction, self.step, |new, old| new > old);
        }
        self.last_correction = length;
    }

    fn count_corrections(&mut self, corrections: usize) {
        self.counts.count_corrections(corrections);
    }

    fn count_restart(&mut self) {
        self.counts.count_restart();
    }

    fn count_newton(&mut self) {
        self.counts.count_newton();
    }

    fn count_rescue(&mut self, parts: u64) {
        self.counts.count_rescue(parts);
    }

    fn count_fallback(&mut self) {
        self.counts.count_fallback();
    }
}

memory!([] Diagnostics, |words| Self { counts, step, last_correction, condition, pivot_ratio, contraction } => {
    words.part(counts);
    words.count(step);
    words.number(last_correction);
    for worst in [condition, pivot_ratio, contraction] {
        words.optional(worst, || Worst { value: 0.0, step: 0 });
    }
});

memory!([] Worst, |words| Self { value, step } => {
    words.number(value);
    words.count(step);
});
