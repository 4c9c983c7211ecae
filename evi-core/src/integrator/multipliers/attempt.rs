//! One or two corrections with one matrix, from the impulse that the steps before let expect.

use core::borrow::Borrow;

use super::careful::is_round_off_next;
use super::span::{Correction, DriftGram, Span, move_by};
use crate::array::Array;
use crate::linear::Factorization;
use crate::mechanics::{KickDriftKick, RoundOff, Sum};
use crate::newton::{self, Tally};
use crate::system::MechanicalSystem;

/// Corrections with one matrix that do, as a rule.
pub(super) const CHORDS: usize = 2;

/// A prediction is followed where it misses the displacement by the constraint forces by no more than this fraction: one that misses by more
/// could lead to another root than a step without a past.
pub(crate) const TRUSTED: f64 = 1.0 / 64.0;

/// A last correction that is shorter than this fraction of the displacement by the constraint forces changes no matrix.
pub(super) const SHORT: f64 = 1.0 / (1_u64 << 40) as f64;

/// Where the corrections with one matrix have led.
pub(super) struct Attempt<S: MechanicalSystem, Q> {
    pub(super) q: Q,
    /// The sum of the corrections.
    pub(super) correction: Correction<S>,
    /// What the corrections were made for, in this order.
    pub(super) residuals: [S::PerConstraint<f64>; 2],
    /// Varying entries of `G`, there or as good as there.
    pub(super) jacobian: S::PerJacobianEntry<f64>,
    pub(super) corrections: usize,
    /// Whether no further correction is needed.
    pub(super) is_solved: bool,
}

impl<S: MechanicalSystem, F: KickDriftKick<S>, R: RoundOff<S>> Span<'_, S, F, R> {
    /// Corrects the `predicted` impulse, from which the span begins, with the matrix there. `None` if that is singular, or the prediction
    /// not near enough to be followed.
    #[inline(always)]
    pub(super) fn attempt(
        &self,
        predicted: &S::PerConstraint<f64>,
        allowed: Option<&S::PerConstraint<f64>>,
        tally: &mut impl Tally,
    ) -> Option<Attempt<S, R::Sum>> {
        let q = self.end();
        let (first, jacobian) = self.constraints_at(&q);
        let matrix = self.mechanics.gram_matrix::<F::Coupling>(&jacobian, &self.directions);
        let chord = DriftGram::<S, F>::factor(&matrix).ok()?;
        if chord.is_fallback() {
            tally.count_fallback();
        }
        let displacement: S::PerConstraint<f64> = Array::from_fn(|c| matrix[c][c] * predicted[c]);
        // Written so that a NaN is not trusted.
        let is_trusted = are_all::<S>(|c| first[c].abs() <= TRUSTED * displacement[c].abs());
        if !is_trusted {
            return None;
        }
        let correction = self.correction(&chord, &first);
        Some(if const { S::STRUCTURE.has_quadratic_constraints() } {
            let allowed = match allowed {
                Some(allowed) => allowed.clone(),
                None => round_off_of(&self.mechanics.reach(&jacobian, q.value().borrow())),
            };
            self.correct_by_curvature(&chord, q, first, correction, &allowed)
        } else {
            self.correct_by_evaluation(&chord, q, first, correction, &displacement)
        })
    }

    /// Makes the correction for the residual `first` and, where what it leaves is more than `allowed`, another: of quadratic constraints that
    /// is known without an evaluation.
    #[inline(always)]
    fn correct_by_curvature(
        &self,
        chord: &DriftGram<S, F>,
        mut q: R::Sum,
        first: S::PerConstraint<f64>,
        mut correction: Correction<S>,
        allowed: &S::PerConstraint<f64>,
    ) -> Attempt<S, R::Sum> {
        let is_round_off = |left: &S::PerConstraint<f64>| are_all::<S>(|c| left[c].abs() <= allowed[c]);
        let second = self.remainder(&q, &correction.moved);
        let mut corrections = 1;
        let mut is_solved = is_round_off(&second);
        if !is_solved {
            correction = correction.and(&self.correction(chord, &second));
            let both = self.remainder(&q, &correction.moved);
            is_solved = is_round_off(&Array::from_fn(|c| both[c] - second[c]));
            corrections = CHORDS;
        }
        move_by::<S, _>(&mut q, &correction.moved);
        let (_, jacobian) = self.constraints_at(&q);
        let residuals = [first, second];
        Attempt { q, correction, residuals, jacobian, corrections, is_solved }
    }

    /// Makes the correction for the residual `first`, and one for the residual that it leaves, judged against the `displacement` by the
    /// constraint forces. The matrix for the velocities is evaluated before the last correction, which must be too short to
    /// change it: so the divisions in it do not wait for that correction.
    #[inline(always)]
    fn correct_by_evaluation(
        &self,
        chord: &DriftGram<S, F>,
        mut q: R::Sum,
        first: S::PerConstraint<f64>,
        correction: Correction<S>,
        displacement: &S::PerConstraint<f64>,
    ) -> Attempt<S, R::Sum> {
        move_by::<S, _>(&mut q, &correction.moved);
        let (second, jacobian) = self.constraints_at(&q);
        let next = self.correction(chord, &second);
        move_by::<S, _>(&mut q, &next.moved);
        let is_solved = is_round_off_next::<S>(&second, &first, displacement)
            && are_all::<S>(|c| second[c].abs() <= SHORT * displacement[c].abs());
        let (correction, residuals) = (correction.and(&next), [first, second]);
        Attempt { q, correction, residuals, jacobian, corrections: CHORDS, is_solved }
    }
}

/// What is round-off of the residuals of quadratic constraints whose `G q` is `reach`.
#[inline(always)]
pub(super) fn round_off_of<C: Array<f64>>(reach: &C) -> C {
    Array::from_fn(|c| newton::TARGET * reach[c].abs())
}

/// Whether every constraint passes: all are asked, without a branch for each.
#[inline(always)]
pub(super) fn are_all<S: MechanicalSystem>(passes: impl Fn(usize) -> bool) -> bool {
    let mut all = true;
    for c in 0..S::N_CONSTRAINTS {
        all &= passes(c);
    }
    all
}
