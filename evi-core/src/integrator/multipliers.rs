//! A kick, a drift and a kick with constraints: Newton's iteration on the multipliers alone.
//!
//! In: a [`KickDriftKick`], whose end point is affine in the impulse `ℓ = Λ/h` of the constraint force. Out: the `ℓ` for which
//! `φ(q₁(ℓ)) = 0`, and the state there. From the impulse that the previous steps predict, one or two corrections with one
//! matrix `G₁ D G₀ᵀ` do, as a rule; where they do not, Newton's iteration goes on with a fresh matrix for each.

use core::borrow::Borrow;

use super::{IterationFailure, StepError};
use crate::array::Array;
use crate::linear::{Factorization, largest_magnitude};
use crate::mechanics::{Coupling, Directions, KickDriftKick, Lost, Mechanics, NOTHING, RoundOff, State, Sum};
use crate::newton::{self, Progress, Tally};
use crate::system::MechanicalSystem;

/// Corrections with one matrix that do, as a rule.
const CHORDS: usize = 2;

/// A step without its constraint forces, with the impulses that it has needed so far.
pub(crate) struct MultiplierStep<S: MechanicalSystem, F> {
    free: F,
    history: History<S>,
}

/// The impulses so far. They affect the number of corrections and the last bits of a state, nothing else: a prediction that misses is not
/// followed.
struct History<S: MechanicalSystem> {
    /// The first guess of the next step: what a cubic through the last four impulses predicts.
    predicted: S::PerConstraint<f64>,
    /// Impulses of the last three steps, newest first.
    previous: [S::PerConstraint<f64>; 3],
}

/// A prediction is followed where it misses the displacement by the constraint forces by no more than this fraction: one that misses by more
/// could lead to another root than a step without a past.
const TRUSTED: f64 = 1.0 / 64.0;

/// A last correction that is shorter than this fraction of the displacement by the constraint forces changes no matrix.
const SHORT: f64 = 1.0 / (1_u64 << 40) as f64;

/// The motion of one step as a function of the impulse.
struct Span<'a, S: MechanicalSystem, F, R> {
    mechanics: &'a Mechanics<S>,
    free: &'a F,
    t_start: f64,
    t_end: f64,
    /// `q₀`.
    start: S::PerCoordinate<f64>,
    round_off: R,
    /// `D p½`, without constraint forces.
    free_difference: S::PerCoordinate<f64>,
    /// Varying entries of `G₀`.
    jacobian: S::PerJacobianEntry<f64>,
    /// `D G₀ᵀ`.
    directions: Directions<S>,
}

/// Where the corrections with one matrix have led.
struct Attempt<S: MechanicalSystem, Q> {
    q: Q,
    /// The sum of the corrections.
    correction: Correction<S>,
    /// What the corrections were made for, in this order.
    residuals: [S::PerConstraint<f64>; 2],
    /// Varying entries of `G`, there or as good as there.
    jacobian: S::PerJacobianEntry<f64>,
    corrections: usize,
    /// Whether the prediction was near enough to be followed.
    is_trusted: bool,
    /// Whether no further correction is needed.
    is_solved: bool,
}

/// A correction of the impulse, and what it does.
struct Correction<S: MechanicalSystem> {
    impulse: S::PerConstraint<f64>,
    /// `G₀ᵀ` times that: what the momentum loses.
    pull: S::PerCoordinate<f64>,
    /// `D` times that: what the end loses.
    moved: S::PerCoordinate<f64>,
}

/// The end of a step on the constraints.
struct Landing<S: MechanicalSystem, Q> {
    q: Q,
    impulse: S::PerConstraint<f64>,
    /// Factors of `G M⁻¹ Gᵀ` there.
    gram: S::GramFactors,
    /// Number of corrections that led there.
    corrections: usize,
}

impl<S: MechanicalSystem, F: KickDriftKick<S>> MultiplierStep<S, F> {
    pub(crate) fn new(free: F) -> Self {
        let none = S::PerConstraint::<f64>::from_fn(|_| 0.0);
        let previous = [none.clone(), none.clone(), none.clone()];
        Self { free, history: History { predicted: none, previous } }
    }

    /// Overwrites `state` with the state one step of size `h` later, and returns what its positions and momenta have lost.
    ///
    /// What follows where two corrections do not suffice takes copies, and ends the step by itself: on the way that most steps
    /// take no value lies in memory for its sake.
    #[inline(always)]
    pub(crate) fn advance<R: RoundOff<S>>(
        &mut self,
        mechanics: &Mechanics<S>,
        h: f64,
        state: &mut State<S>,
        round_off: R,
        tally: &mut impl Tally,
    ) -> Result<[Lost<S, R>; 2], StepError> {
        let Self { free, history } = self;
        let t = state.t + h;
        let momentum = round_off.momentum(&state.p);
        let kicked = free.kicked_at_start(mechanics, state.t, &state.q, momentum.terms());
        let momentum = momentum.with(kicked);
        let half_way = momentum.value().borrow().clone();
        let free_difference = free.drift().times(|i| half_way[i]);
        if S::N_CONSTRAINTS == 0 {
            let (q, lost_q) = round_off.position(&state.q).plus(&free_difference).split();
            let kicked = free.kicked_at_end(mechanics, t, &q, momentum.terms());
            let (p, lost_p) = momentum.with(kicked).split();
            state.replace(t, q, free.legendre().velocity(&p), p)?;
            return Ok([lost_q, lost_p]);
        }
        let (_, jacobian) = S::constraint_derivatives(&mechanics.constants, state.t, &state.q);
        let directions = mechanics.constraint_directions(&jacobian, free.drift());
        let span = Span {
            mechanics,
            free: &*free,
            t_start: state.t,
            t_end: t,
            start: state.q.clone(),
            round_off,
            free_difference,
            jacobian,
            directions,
        };
        let Some(attempt) = span.attempt(&history.predicted, tally) else {
            return span.land_slowly(None, momentum, history, state, tally);
        };
        if attempt.is_trusted
            && attempt.is_solved
            && let Ok(gram) = free.legendre().factor_gram(mechanics, &attempt.jacobian, tally)
        {
            let Attempt { q, correction, corrections, .. } = attempt;
            let mut momentum = span.pulled(momentum, &history.predicted);
            move_by::<S, _>(&mut momentum, &correction.pull);
            // As good a guess as that from the impulse itself, and known at the start of the step.
            let expected = history.expected_end_impulse(&history.predicted);
            let impulse = Array::from_fn(|c| history.predicted[c] + correction.impulse[c]);
            let landing = Landing { q, impulse, gram, corrections };
            return span.land(landing, &expected, momentum, history, state, tally);
        }
        span.land_slowly(Some(attempt), momentum, history, state, tally)
    }
}

impl<S: MechanicalSystem> History<S> {
    /// The impulse at the end of a step, from that at its start. Averages of the multipliers with the weights `1 − τ` and `τ`,
    /// they belong to the times `⅓ h` and `⅔ h`.
    #[inline(always)]
    fn expected_end_impulse(&self, impulse: &S::PerConstraint<f64>) -> S::PerConstraint<f64> {
        Array::from_fn(|c| impulse[c] + (1.0 / 3.0) * (impulse[c] - self.previous[0][c]))
    }

    /// Adds the impulse of a step that was taken.
    #[inline(always)]
    fn remember(&mut self, impulse: S::PerConstraint<f64>) {
        let [first, second, third] = &self.previous;
        self.predicted = Array::from_fn(|c| 4.0 * (impulse[c] + second[c]) - (6.0 * first[c] + third[c]));
        self.previous = [impulse, first.clone(), second.clone()];
    }
}

/// Solver with `G₁ D G₀ᵀ`.
type DriftGram<S, F> = <<F as KickDriftKick<S>>::Coupling as Coupling<S>>::GramFactors;

impl<S: MechanicalSystem, F: KickDriftKick<S>, R: RoundOff<S>> Span<'_, S, F, R> {
    /// Corrects the `predicted` impulse with the matrix there. `None` if that is singular.
    #[inline(always)]
    fn attempt(
        &self,
        predicted: &S::PerConstraint<f64>,
        tally: &mut impl Tally,
    ) -> Option<Attempt<S, R::Sum>> {
        let q = self.end(predicted);
        let (first, jacobian) = self.constraints_at(&q);
        let matrix = self.mechanics.gram_matrix::<F::Coupling>(&jacobian, &self.directions);
        let chord = DriftGram::<S, F>::factor(&matrix).ok()?;
        if chord.is_fallback() {
            tally.count_fallback();
        }
        let displacement: S::PerConstraint<f64> = Array::from_fn(|c| matrix[c][c] * predicted[c]);
        // Written so that a NaN is not trusted.
        let is_trusted = (0..S::N_CONSTRAINTS).all(|c| first[c].abs() <= TRUSTED * displacement[c].abs());
        let correction = self.correction(&chord, &first);
        Some(if const { S::STRUCTURE.has_quadratic_constraints() } {
            let reach = self.mechanics.reach(&jacobian, q.value().borrow());
            self.correct_by_curvature(&chord, q, first, correction, &reach, is_trusted)
        } else {
            self.correct_by_evaluation(&chord, q, first, correction, &displacement, is_trusted)
        })
    }

    /// Makes the correction for the residual `first` and, where what it leaves is not round-off of terms as large as `reach`, another:
    /// of quadratic constraints that is known without an evaluation.
    #[inline(always)]
    fn correct_by_curvature(
        &self,
        chord: &DriftGram<S, F>,
        mut q: R::Sum,
        first: S::PerConstraint<f64>,
        mut correction: Correction<S>,
        reach: &S::PerConstraint<f64>,
        is_trusted: bool,
    ) -> Attempt<S, R::Sum> {
        let is_round_off = |left: &S::PerConstraint<f64>| {
            (0..S::N_CONSTRAINTS).all(|c| left[c].abs() <= newton::TARGET * reach[c].abs())
        };
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
        Attempt { q, correction, residuals, jacobian, corrections, is_trusted, is_solved }
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
        is_trusted: bool,
    ) -> Attempt<S, R::Sum> {
        move_by::<S, _>(&mut q, &correction.moved);
        let (second, jacobian) = self.constraints_at(&q);
        let next = self.correction(chord, &second);
        move_by::<S, _>(&mut q, &next.moved);
        let is_solved = is_round_off_next::<S>(&second, &first, displacement)
            && (0..S::N_CONSTRAINTS).all(|c| second[c].abs() <= SHORT * displacement[c].abs());
        let (correction, residuals) = (correction.and(&next), [first, second]);
        Attempt { q, correction, residuals, jacobian, corrections: CHORDS, is_trusted, is_solved }
    }

    /// The `momentum` less `G₀ᵀ ℓ`.
    #[inline(always)]
    fn pulled(&self, mut momentum: R::Sum, impulse: &S::PerConstraint<f64>) -> R::Sum {
        let terms = momentum.terms_mut().as_mut();
        self.mechanics.subtract_constraint_force(self.jacobian.as_ref(), impulse.as_ref(), terms);
        momentum
    }

    /// Ends the step: overwrites `state` with the end on the constraints.
    #[inline(always)]
    fn land(
        self,
        Landing { q: position, impulse, gram, corrections }: Landing<S, R::Sum>,
        expected: &S::PerConstraint<f64>,
        momentum: R::Sum,
        history: &mut History<S>,
        state: &mut State<S>,
        tally: &mut impl Tally,
    ) -> Result<[Lost<S, R>; 2], StepError> {
        let Self { mechanics, free, t_end: t, .. } = self;
        tally.count_corrections(corrections);
        let (q, lost_q) = position.split();
        let kicked = free.kicked_at_end(mechanics, t, &q, momentum.terms());
        let momentum = momentum.with(kicked);
        let (_, jacobian) = S::constraint_derivatives(&mechanics.constants, t, &q);
        let (v, momentum) = free.legendre().project(mechanics, &gram, &jacobian, expected, momentum);
        let (p, lost_p) = momentum.split();
        state.replace(t, q, v, p)?;
        history.remember(impulse);
        Ok([lost_q, lost_p])
    }

    /// Ends a step for which the corrections with one matrix did not suffice.
    #[inline(never)]
    fn land_slowly(
        self,
        attempt: Option<Attempt<S, R::Sum>>,
        momentum: R::Sum,
        history: &mut History<S>,
        state: &mut State<S>,
        tally: &mut impl Tally,
    ) -> Result<[Lost<S, R>; 2], StepError> {
        let landing = match attempt {
            Some(attempt) if attempt.is_trusted => self.continue_from(attempt, &history.predicted, tally)?,
            _ => self.solve_anew(tally)?,
        };
        let expected = history.expected_end_impulse(&landing.impulse);
        let momentum = self.pulled(momentum, &landing.impulse);
        self.land(landing, &expected, momentum, history, state, tally)
    }

    /// Newton's iteration after corrections with one matrix.
    fn continue_from(
        &self,
        Attempt { q, correction, residuals: [first, second], .. }: Attempt<S, R::Sum>,
        predicted: &S::PerConstraint<f64>,
        tally: &mut impl Tally,
    ) -> Result<Landing<S, R::Sum>, StepError> {
        let impulse = Array::from_fn(|c| predicted[c] + correction.impulse[c]);
        let scale = self.scale(&q);
        if is_round_off_next::<S>(&second, &first, &scale) {
            return self.landing(q, impulse, CHORDS, tally);
        }
        let slowest = newton::SLOWEST_CHORD * relative_length::<S>(&first, &scale);
        // Written so that a NaN does not contract.
        let contracts = relative_length::<S>(&second, &scale) <= slowest.max(newton::CHORD_ROUND_OFF);
        if contracts && let Ok(landing) = self.iterate(CHORDS, second, q, impulse, tally) {
            return Ok(landing);
        }
        self.solve_anew(tally)
    }

    /// Newton's iteration without the history.
    #[cold]
    #[inline(never)]
    fn solve_anew(&self, tally: &mut impl Tally) -> Result<Landing<S, R::Sum>, StepError> {
        let none = S::PerConstraint::<f64>::from_fn(|_| 0.0);
        self.iterate(0, none.clone(), self.end(&none), none, tally)
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

    /// Newton's iteration from `q = q₁(ℓ)`, with a fresh matrix for every correction. `previous` is the residual that the
    /// last of the `corrections` so far was made for, 0 if there was none.
    fn iterate(
        &self,
        corrections: usize,
        mut previous: S::PerConstraint<f64>,
        mut q: R::Sum,
        mut impulse: S::PerConstraint<f64>,
        tally: &mut impl Tally,
    ) -> Result<Landing<S, R::Sum>, StepError> {
        let mut progress = Progress::after(relative_length::<S>(&previous, &self.scale(&q)));
        loop {
            let (residual, jacobian) = self.constraints_at(&q);
            let matrix = self.mechanics.gram_matrix::<F::Coupling>(&jacobian, &self.directions);
            let gram = DriftGram::<S, F>::factor(&matrix).map_err(|matrix| {
                let failure = IterationFailure::Singular { correction: progress.corrections() + 1, matrix };
                self.failed(failure, &residual, 0.0)
            })?;
            if gram.is_fallback() {
                tally.count_fallback();
            }
            let scale = self.scale(&q);
            let correction = self.correction(&gram, &residual);
            move_by::<S, _>(&mut q, &correction.moved);
            impulse = Array::from_fn(|c| impulse[c] + correction.impulse[c]);
            let is_last = is_round_off_next::<S>(&residual, &previous, &scale);
            match progress.record(relative_length::<S>(&residual, &scale), is_last) {
                Ok(true) => return self.landing(q, impulse, corrections + progress.corrections(), tally),
                Ok(false) => previous = residual,
                Err(failure) => {
                    let (residual, _) = self.constraints_at(&q);
                    return Err(self.failed(failure.into(), &residual, gram.pivot_ratio()));
                }
            }
        }
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

    /// `φ` and the varying entries of `G` at the end of the step.
    #[inline(always)]
    fn constraints_at(&self, q: &R::Sum) -> (S::PerConstraint<f64>, S::PerJacobianEntry<f64>) {
        S::constraint_derivatives(&self.mechanics.constants, self.t_end, q.value().borrow())
    }

    /// `q₁(ℓ) = q₀ − D G₀ᵀ ℓ + d_free`; the difference comes last, since it is known last.
    #[inline(always)]
    fn end(&self, impulse: &S::PerConstraint<f64>) -> R::Sum {
        let mut end = self.round_off.position(&self.start);
        move_by::<S, _>(&mut end, &self.along(impulse));
        end.plus(&self.free_difference)
    }

    /// The correction for `residual`. The derivative of `φ(q₁(ℓ))` is `−G₁ D G₀ᵀ`, the `matrix` but for the sign.
    #[inline(always)]
    fn correction(&self, matrix: &DriftGram<S, F>, residual: &S::PerConstraint<f64>) -> Correction<S> {
        let mut correction = residual.clone();
        let factor = matrix.solve_up_to_factor(&mut correction);
        let moved = self.along(&correction);
        let mut pull = S::PerCoordinate::<f64>::from_fn(|_| NOTHING);
        self.mechanics.add_constraint_force(self.jacobian.as_ref(), correction.as_ref(), pull.as_mut());
        Correction {
            impulse: Array::from_fn(|c| correction[c] * factor),
            pull: Array::from_fn(|i| pull[i] * factor),
            moved: Array::from_fn(|i| moved[i] * factor),
        }
    }

    /// `D G₀ᵀ y`.
    #[inline(always)]
    fn along(&self, y: &S::PerConstraint<f64>) -> S::PerCoordinate<f64> {
        let mut sum = S::PerCoordinate::<f64>::from_fn(|_| NOTHING);
        if F::Coupling::IS_DIAGONAL {
            for entry in S::STRUCTURE.jacobian.q {
                sum[entry.col] += self.directions[entry.row][entry.col] * y[entry.row];
            }
        } else {
            for c in 0..S::N_CONSTRAINTS {
                for i in 0..S::N_COORDINATES {
                    sum[i] += self.directions[c][i] * y[c];
                }
            }
        }
        sum
    }

    /// `φ(q − d) − φ(q) + G d = ½ dᵀ φ_qq d`, exactly.
    #[inline(always)]
    fn remainder(&self, q: &R::Sum, moved: &S::PerCoordinate<f64>) -> S::PerConstraint<f64> {
        let curvature =
            S::constraint_curvature(&self.mechanics.constants, self.t_end, q.value().borrow(), moved);
        Array::from_fn(|c| 0.5 * curvature[c])
    }

    /// What the residuals at `end` are compared with: `Σᵢ |G_ci| rᵢ`, where `rᵢ` adds up the magnitudes of what `q₁` is
    /// found from.
    fn scale(&self, end: &R::Sum) -> S::PerConstraint<f64> {
        let (start, end) = (&self.start, end.value());
        let reach =
            Array::from_fn(|i| start[i].abs() + self.free_difference[i].abs() + end.borrow()[i].abs());
        self.mechanics.constraint_scale(&self.jacobian, &reach)
    }
}

/// Whether the correction for `residual` is the last, constraint by constraint: the fast convergence of one must not pass for
/// that of all.
#[inline(always)]
fn is_round_off_next<S: MechanicalSystem>(
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

/// Subtracts `moved` from the sum.
#[inline(always)]
fn move_by<S: MechanicalSystem, Q: Sum<S>>(sum: &mut Q, moved: &S::PerCoordinate<f64>) {
    for i in 0..S::N_COORDINATES {
        sum.terms_mut()[i] -= moved[i];
    }
}

impl<S: MechanicalSystem> Correction<S> {
    /// This correction and the next one.
    #[inline(always)]
    fn and(&self, next: &Self) -> Self {
        Self {
            impulse: Array::from_fn(|c| self.impulse[c] + next.impulse[c]),
            pull: Array::from_fn(|i| self.pull[i] + next.pull[i]),
            moved: Array::from_fn(|i| self.moved[i] + next.moved[i]),
        }
    }
}

crate::memory::memory!([S: MechanicalSystem, F] MultiplierStep<S, F>, |words| Self { free: _, history } => {
    let History { predicted, previous } = history;
    words.numbers(predicted);
    words.part(previous);
});

impl<S: MechanicalSystem, F> MultiplierStep<S, F> {
    /// The step without its constraint forces.
    pub(crate) const fn free(&self) -> &F {
        &self.free
    }
}
