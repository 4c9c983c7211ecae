//! A step for which corrections with one matrix did not suffice: Newton's iteration on the multipliers with a fresh matrix for each.

use core::borrow::Borrow;

use super::attempt::{are_all, displacement_by, is_trusted};
use super::history::History;
use super::span::{DriftGram, Span, move_by};
use crate::array::Array;
use crate::integrator::{IterationFailure, StepError};
use crate::linear::{Factorization, largest_magnitude};
use crate::mechanics::State;
use crate::mechanics::{KickDriftKick, Lost, RoundOff, Sum};
use crate::newton::{self, Progress, Tally};
use crate::system::MechanicalSystem;

/// The end of a step on the constraints.
struct Landing<S: MechanicalSystem, Q> {
    q: Q,
    /// What was added to the impulse that the span begins with; in the end, the whole impulse.
    impulse: S::PerConstraint<f64>,
    /// Factors of `G M⁻¹ Gᵀ` there.
    gram: S::GramFactors,
    /// Number of corrections that led there.
    corrections: usize,
}

impl<S: MechanicalSystem, F: KickDriftKick<S>, R: RoundOff<S>> Span<'_, S, F, R> {
    /// Finds the impulse, and ends the step.
    pub(super) fn search(
        mut self,
        history: &mut History<S>,
        state: &mut State<S>,
        tally: &mut impl Tally,
    ) -> Result<[Lost<S, R>; 2], StepError> {
        let none = S::PerConstraint::<f64>::from_fn(|_| 0.0);
        let (expected, mut landing) = match self.follow_carefully(&history.predicted, tally) {
            Some(landing) => (history.predicted.clone(), landing),
            None => {
                self.expect_nothing(&state.p);
                tally.begin_iteration();
                (none.clone(), self.iterate(0, none.clone(), self.end(), [&none, &none], tally)?)
            }
        };
        let terms = self.momentum.terms_mut();
        self.mechanics.subtract_constraint_force(&self.jacobian, &landing.impulse, terms);
        landing.impulse = Array::from_fn(|c| expected[c] + landing.impulse[c]);
        let at_end = history.expected_end_impulse(&landing.impulse);
        self.land(landing, &at_end, history, state, tally)
    }

    /// Ends the step: overwrites `state` with the end on the constraints.
    fn land(
        self,
        Landing { q: position, impulse, gram, corrections }: Landing<S, R::Sum>,
        expected: &S::PerConstraint<f64>,
        history: &mut History<S>,
        state: &mut State<S>,
        tally: &mut impl Tally,
    ) -> Result<[Lost<S, R>; 2], StepError> {
        let Self { mechanics, free, t_end: t, momentum, .. } = self;
        tally.count_corrections(corrections);
        let (q, lost_q) = position.split();
        let momentum = momentum.plus(&free.end_kick(mechanics, t, &q));
        let (_, jacobian) = mechanics.primitive_constraints(t, &q);
        let (v, momentum) = free.legendre().project(mechanics, &gram, &jacobian, expected, momentum);
        let (p, lost_p) = momentum.split();
        state.replace(t, q, v, p)?;
        history.remember(impulse);
        Ok([lost_q, lost_p])
    }

    /// Newton's iteration from the `expected` impulse; `None` where that is not near enough to be followed, the first correction did not contract, or
    /// the iteration leads nowhere.
    fn follow_carefully(
        &self,
        expected: &S::PerConstraint<f64>,
        tally: &mut impl Tally,
    ) -> Option<Landing<S, R::Sum>> {
        let mut q = self.end();
        let (first, jacobian) = self.constraints_at(&q);
        let matrix = self.matrix(&jacobian);
        if !is_trusted::<S>(&first, &displacement_by::<S>(&matrix, expected)) {
            return None;
        }
        let gram = DriftGram::<S, F>::factor_of_any_size(&matrix).ok()?;
        if gram.is_fallback() {
            tally.count_fallback();
        }
        let correction = self.correction(&gram, &first);
        move_by::<S, _>(&mut q, &correction.moved);
        let (second, _) = self.constraints_at(&q);
        let scale = self.scale(&q, [expected, &correction.impulse]);
        tally.begin_iteration();
        tally.see_correction(|| relative_length::<S>(&first, &scale));
        let slowest = newton::SLOWEST_CHORD * relative_length::<S>(&first, &scale);
        // Written so that a NaN does not contract.
        let contracts = relative_length::<S>(&second, &scale) <= slowest.max(newton::CHORD_ROUND_OFF);
        if !contracts {
            return None;
        }
        self.iterate(1, first, q, [expected, &correction.impulse], tally).ok()
    }

    /// The landing at `q`, where `φ = 0`.
    fn landing(
        &self,
        q: R::Sum,
        impulse: S::PerConstraint<f64>,
        corrections: usize,
        tally: &mut impl Tally,
    ) -> Result<Landing<S, R::Sum>, StepError> {
        let (_, jacobian) = self.constraints_at(&q);
        match self.free.legendre().factor_gram(self.mechanics, &jacobian, tally) {
            Ok(gram) => Ok(Landing { q, impulse, gram, corrections }),
            Err(cause) => Err(StepError::Projection { t: self.t_end, cause: cause.into() }),
        }
    }

    /// Newton's iteration from `q = q₁(ℓ₀ + c)` for `c`, with a fresh matrix for every correction. `previous` is the residual that the
    /// last of the `corrections` so far was made for, 0 if there was none.
    fn iterate(
        &self,
        corrections: usize,
        mut previous: S::PerConstraint<f64>,
        mut q: R::Sum,
        [expected, begun]: [&S::PerConstraint<f64>; 2],
        tally: &mut impl Tally,
    ) -> Result<Landing<S, R::Sum>, StepError> {
        let mut impulse = begun.clone();
        let mut progress = if corrections == 0 {
            Progress::default()
        } else {
            Progress::after(relative_length::<S>(&previous, &self.scale(&q, [expected, begun])))
        };
        loop {
            let (residual, jacobian) = self.constraints_at(&q);
            let matrix = self.matrix(&jacobian);
            let gram = DriftGram::<S, F>::factor_of_any_size(&matrix).map_err(|matrix| {
                let failure = IterationFailure::Singular { correction: progress.corrections() + 1, matrix };
                self.failed(failure, &residual, 0.0)
            })?;
            if gram.is_fallback() {
                tally.count_fallback();
            }
            let scale = self.scale(&q, [expected, &impulse]);
            let correction = self.correction(&gram, &residual);
            move_by::<S, _>(&mut q, &correction.moved);
            impulse = Array::from_fn(|c| impulse[c] + correction.impulse[c]);
            let is_last = is_round_off_next::<S>(&residual, &previous, &scale);
            let length = relative_length::<S>(&residual, &scale);
            tally.see_correction(|| length);
            match progress.record(length, is_last) {
                Ok(true) => return self.landing(q, impulse, corrections + progress.corrections(), tally),
                Ok(false) => previous = residual,
                Err(failure) => {
                    if self.is_round_off_of_terms(&q) {
                        return self.landing(q, impulse, corrections + progress.corrections(), tally);
                    }
                    let (residual, _) = self.constraints_at(&q);
                    return Err(self.failed(failure.into(), &residual, gram.pivot_ratio()));
                }
            }
        }
    }

    /// Whether what the constraints leave at `q` is the round-off of terms that are no part of their scale, as those of `x² + (y − l)² = l²` are at the
    /// origin: a correction makes it no smaller, though it leaves nothing by the linear equations, and next to nothing by the curvature
    /// of the constraints.
    #[cold]
    fn is_round_off_of_terms(&self, q: &R::Sum) -> bool {
        /// What is left of a residual by equations that are solved.
        const SOLVED: f64 = 1.0 / 1024.0;
        let (residual, jacobian) = self.constraints_at(q);
        let matrix = self.matrix(&jacobian);
        let Ok(gram) = DriftGram::<S, F>::factor_of_any_size(&matrix) else { return false };
        let correction = self.correction(&gram, &residual);
        let solved = self.mechanics.reach(&jacobian, &correction.moved);
        let bent = self.remainder(q, &correction.moved);
        let (value, moved) = (q.value(), &correction.moved);
        let end = Array::from_fn(|i| value.borrow()[i] - moved[i]);
        let (left, _) = self.mechanics.primitive_constraints(self.t_end, &end);
        are_all::<S>(|c| {
            let allowed = SOLVED * residual[c].abs();
            // Written so that a NaN is none.
            let is_corrected = (solved[c] - residual[c]).abs() <= allowed && bent[c].abs() <= allowed;
            let stays = (0.25 * residual[c].abs()..=4.0 * residual[c].abs()).contains(&left[c].abs());
            // Exactly 0 is no residual.
            residual[c] == 0.0 || (is_corrected && stays)
        })
    }

    /// The numbers that explain a failure.
    #[cold]
    fn failed(
        &self,
        failure: IterationFailure,
        residual: &S::PerConstraint<f64>,
        pivot_ratio: f64,
    ) -> StepError {
        failure.at(self.t_start, largest_magnitude(residual.as_ref().iter().copied()), pivot_ratio)
    }
}

/// Whether the correction for `residual` is the last, constraint by constraint: the fast convergence of one must not pass for
/// that of all.
#[inline(always)]
pub(super) fn is_round_off_next<S: MechanicalSystem>(
    residual: &S::PerConstraint<f64>,
    previous: &S::PerConstraint<f64>,
    scale: &S::PerConstraint<f64>,
) -> bool {
    let mut all = true;
    for c in 0..S::N_CONSTRAINTS {
        all &= newton::predicts_round_off(residual[c], previous[c], scale[c]);
    }
    all
}

/// Sum of the residuals relative to their scales, in which a NaN survives.
fn relative_length<S: MechanicalSystem>(
    residual: &S::PerConstraint<f64>,
    scale: &S::PerConstraint<f64>,
) -> f64 {
    let mut length = 0.0;
    for c in 0..S::N_CONSTRAINTS {
        // Exactly 0 is no residual on any scale.
        length += if residual[c] == 0.0 { 0.0 } else { residual[c].abs() / scale[c] };
    }
    length
}
