//! One or two corrections with one matrix, from the impulse that the steps before let expect.

use core::borrow::Borrow;

use super::bend::Bend;
use super::careful::is_round_off_next;
use super::span::{Correction, DriftGram, Span, move_by};
use crate::array::Array;
use crate::linear::Factorization;
use crate::mechanics::{KickDriftKick, NOTHING, RoundOff, Sum};
use crate::system::MechanicalSystem;

/// Corrections with one matrix that are tried. Two do, as a rule; where a prediction is poor, a third is shorter than the way to a fresh matrix.
const MOST_CHORDS: usize = 4;

/// A prediction is followed where it misses the displacement by the constraint forces by no more than this fraction: one that misses by more
/// could lead to another root than a step without a past.
pub(crate) const TRUSTED: f64 = 1.0 / 64.0;

/// Where corrections with one matrix have led.
pub(super) struct Attempt<S: MechanicalSystem, Q> {
    pub(super) q: Q,
    /// The sum of the corrections.
    pub(super) correction: Correction<S>,
    pub(super) corrections: usize,
}

impl<S: MechanicalSystem, Q> Attempt<S, Q> {
    /// Whether positions are finite wherever an attempt leads: where quadratic constraints hold all coordinates, their residuals would not be.
    pub(super) const VOUCHES_FOR_POSITIONS: bool =
        S::STRUCTURE.has_quadratic_constraints() && S::STRUCTURE.constrains_every(S::N_COORDINATES);
}

impl<S: MechanicalSystem, F: KickDriftKick<S>, R: RoundOff<S>> Span<'_, S, F, R> {
    /// Corrects the `predicted` impulse, from which the span begins, with the matrix there. `None` if that is next to singular, the prediction
    /// not near enough to be followed, or two corrections are not enough.
    ///
    /// One correction that leaves round-off of quadratic constraints is so short that no other root is as near, whatever was predicted.
    #[inline(always)]
    pub(super) fn attempt(
        &self,
        predicted: &S::PerConstraint<f64>,
        bend: &Bend<S>,
    ) -> Option<Attempt<S, R::Sum>> {
        let mut q = self.end();
        let (first, jacobian) = self.constraints_at(&q);
        let matrix = self.matrix(&jacobian);
        let chord = DriftGram::<S, F>::factor_unguarded(&matrix).ok()?;
        // What it loses no evaluation would see; and it is counted where the step is taken anew.
        if chord.is_fallback() {
            return None;
        }
        let mut correction = self.correction(&chord, &first);
        let displacement = || displacement_by::<S>(&matrix, predicted);
        if const { !S::STRUCTURE.has_quadratic_constraints() } {
            return self.correct_by_evaluation(&chord, q, first, correction, &displacement());
        }
        let mut corrections = 1;
        let doubt = if Bend::<S>::VOUCHES_FOR_MATRICES { NOTHING } else { chord.doubt() };
        if !bend.is_round_off(&correction.moved, doubt) {
            let allowed = bend.allowed(|| self.mechanics.reach(&jacobian, q.value().borrow()));
            let is_round_off =
                |left: &S::PerConstraint<f64>| are_all::<S>(|c| left[c].abs() + chord.doubt() <= allowed[c]);
            let second = self.remainder(&q, &correction.moved);
            if !is_round_off(&second) {
                if !is_trusted::<S>(&first, &displacement()) {
                    return None;
                }
                correction = correction.and(&self.correction(&chord, &second));
                let both = self.remainder(&q, &correction.moved);
                if !is_round_off(&Array::from_fn(|c| both[c] - second[c])) {
                    return None;
                }
                corrections = 2;
            }
        }
        move_by::<S, _>(&mut q, &correction.moved);
        Some(Attempt { q, correction, corrections })
    }

    /// Makes the `correction` for the residual `first`, and others for the residuals that are left, judged against the `displacement` by the
    /// constraint forces.
    #[inline(always)]
    fn correct_by_evaluation(
        &self,
        chord: &DriftGram<S, F>,
        mut q: R::Sum,
        first: S::PerConstraint<f64>,
        mut correction: Correction<S>,
        displacement: &S::PerConstraint<f64>,
    ) -> Option<Attempt<S, R::Sum>> {
        if !is_trusted::<S>(&first, displacement) {
            return None;
        }
        move_by::<S, _>(&mut q, &correction.moved);
        let mut previous = first;
        for corrections in 2..=MOST_CHORDS {
            let (residual, _) = self.constraints_at(&q);
            let next = self.correction(chord, &residual);
            move_by::<S, _>(&mut q, &next.moved);
            correction = correction.and(&next);
            if is_round_off_next::<S>(&residual, &previous, displacement) {
                return Some(Attempt { q, correction, corrections });
            }
            previous = residual;
        }
        None
    }
}

/// What the constraints are displaced by where the `impulse` of each acts alone, by the `matrix` `G D G₀ᵀ`.
#[inline(always)]
pub(super) fn displacement_by<S: MechanicalSystem>(
    matrix: &S::PerConstraint<S::PerConstraint<f64>>,
    impulse: &S::PerConstraint<f64>,
) -> S::PerConstraint<f64> {
    Array::from_fn(|c| matrix[c][c] * impulse[c])
}

/// Whether a prediction that leaves the residual `first` is near enough to be followed.
#[inline(always)]
pub(super) fn is_trusted<S: MechanicalSystem>(
    first: &S::PerConstraint<f64>,
    displacement: &S::PerConstraint<f64>,
) -> bool {
    // Written so that a NaN is not trusted.
    are_all::<S>(|c| first[c].abs() <= TRUSTED * displacement[c].abs())
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
