//! A kick, a drift and a kick with constraints: Newton's iteration on the multipliers alone.
//!
//! In: a [`KickDriftKick`], whose end point is affine in the impulse `ℓ = Λ/h` of the constraint force. Out: the `ℓ` for which
//! `φ(q₁(ℓ)) = 0`, and the state there. From the impulse that the previous steps predict, two corrections with one matrix
//! `G₁ D G₀ᵀ` do, as a rule; where they do not, Newton's iteration goes on with a fresh matrix for each.

use core::borrow::Borrow;

use super::{IterationFailure, StepError};
use crate::array::Array;
use crate::linear::{Factorization, largest_magnitude};
use crate::mechanics::{Coupling, Directions, KickDriftKick, Lost, Mechanics, RoundOff, State, Sum};
use crate::newton::{self, Progress, Tally};
use crate::system::MechanicalSystem;

/// Corrections with one matrix that do, as a rule.
const CHORDS: usize = 2;

/// A step without its constraint forces, with the impulses that it has needed so far. They affect the number of corrections and the last bits of
/// a state, nothing else: a prediction that misses is not followed.
pub(crate) struct MultiplierStep<S: MechanicalSystem, F> {
    free: F,
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
    start: &'a S::PerCoordinate<f64>,
    round_off: R,
    /// `D p½`, without constraint forces.
    free_difference: S::PerCoordinate<f64>,
    /// Varying entries of `G₀`.
    jacobian: S::PerJacobianEntry<f64>,
    /// `D G₀ᵀ`.
    directions: Directions<S>,
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
        Self { free, predicted: none.clone(), previous: [none.clone(), none.clone(), none] }
    }

    /// Overwrites `state` with the state one step of size `h` later, and returns what its positions and momenta have lost.
    #[inline(always)]
    pub(crate) fn advance<R: RoundOff<S>>(
        &mut self,
        mechanics: &Mechanics<S>,
        h: f64,
        state: &mut State<S>,
        round_off: R,
        tally: &mut impl Tally,
    ) -> Result<[Lost<S, R>; 2], StepError> {
        let free = &self.free;
        let t = state.t + h;
        let momentum = round_off.momentum(&state.p);
        let kicked = free.kicked_at_start(mechanics, state.t, &state.q, momentum.terms());
        let mut momentum = momentum.with(kicked);
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
        let (t_start, start) = (state.t, &state.q);
        let span = Span {
            mechanics,
            free,
            t_start,
            t_end: t,
            start,
            round_off,
            free_difference,
            jacobian,
            directions,
        };
        let Landing { q: position, impulse, gram, corrections } =
            span.solve(self.predicted.clone(), tally)?;
        tally.count_corrections(corrections);
        let (q, lost_q) = position.split();
        mechanics.subtract_constraint_force(
            span.jacobian.as_ref(),
            impulse.as_ref(),
            momentum.terms_mut().as_mut(),
        );
        let kicked = free.kicked_at_end(mechanics, t, &q, momentum.terms());
        let momentum = momentum.with(kicked);

        let (_, jacobian) = S::constraint_derivatives(&mechanics.constants, t, &q);
        let expected = self.expected_end_impulse(&impulse);
        let (v, momentum) = free.legendre().project(mechanics, &gram, &jacobian, &expected, momentum);
        let (p, lost_p) = momentum.split();
        state.replace(t, q, v, p)?;
        self.remember(impulse);
        Ok([lost_q, lost_p])
    }

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

// Written out, since a derive would demand the same of `S`.
impl<S: MechanicalSystem, F, R: Copy> Clone for Span<'_, S, F, R> {
    #[inline(always)]
    fn clone(&self) -> Self {
        Self {
            free_difference: self.free_difference.clone(),
            jacobian: self.jacobian.clone(),
            directions: self.directions.clone(),
            ..*self
        }
    }
}

/// Solver with `G₁ D G₀ᵀ`.
type DriftGram<S, F> = <<F as KickDriftKick<S>>::Coupling as Coupling<S>>::GramFactors;

impl<S: MechanicalSystem, F: KickDriftKick<S>, R: RoundOff<S>> Span<'_, S, F, R> {
    /// Solves `φ(q₁(ℓ)) = 0` from the guess `impulse`.
    ///
    /// What follows the two corrections takes a copy of `self`, which therefore need not lie in memory until then. The
    /// matrix for the velocities is evaluated before the last correction, which is too short to change it: so the
    /// divisions in it do not wait for that correction.
    #[inline(always)]
    fn solve(
        &self,
        mut impulse: S::PerConstraint<f64>,
        tally: &mut impl Tally,
    ) -> Result<Landing<S, R::Sum>, StepError> {
        let mut q = self.end(&impulse);
        let (first, jacobian) = self.constraints_at(&q);
        let matrix = self.mechanics.gram_matrix::<F::Coupling>(&jacobian, &self.directions);
        let Ok(chord) = DriftGram::<S, F>::factor(&matrix) else { return self.clone().solve_anew(tally) };
        if chord.is_fallback() {
            tally.count_fallback();
        }
        self.correct(&chord, &first, &mut q, &mut impulse);
        let (second, jacobian) = self.constraints_at(&q);
        self.correct(&chord, &second, &mut q, &mut impulse);
        let displacement: S::PerConstraint<f64> = Array::from_fn(|c| matrix[c][c] * impulse[c]);
        // Written so that a NaN is not trusted.
        let is_trusted = (0..S::N_CONSTRAINTS).all(|c| first[c].abs() <= TRUSTED * displacement[c].abs());
        if is_trusted
            && is_round_off_next::<S>(&second, &first, &displacement)
            && (0..S::N_CONSTRAINTS).all(|c| second[c].abs() <= SHORT * displacement[c].abs())
            && let Ok(gram) = self.free.legendre().factor_gram(self.mechanics, &jacobian, tally)
        {
            return Ok(Landing { q, impulse, gram, corrections: CHORDS });
        }
        // Taken apart and put together: the values of the other path stay in registers.
        let Landing { q, impulse, gram, corrections } =
            self.clone().continue_from([first, second], is_trusted, q, impulse, tally)?;
        Ok(Landing { q, impulse, gram, corrections })
    }

    /// Newton's iteration after two corrections with one matrix, for the `residuals`, that led to `q`.
    #[inline(never)]
    fn continue_from(
        self,
        [first, second]: [S::PerConstraint<f64>; 2],
        is_trusted: bool,
        q: R::Sum,
        impulse: S::PerConstraint<f64>,
        tally: &mut impl Tally,
    ) -> Result<Landing<S, R::Sum>, StepError> {
        if !is_trusted {
            return self.solve_anew(tally);
        }
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
    fn solve_anew(self, tally: &mut impl Tally) -> Result<Landing<S, R::Sum>, StepError> {
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
            self.correct(&gram, &residual, &mut q, &mut impulse);
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
        let mut end = self.round_off.position(self.start);
        subtract::<S, F::Coupling>(&self.directions, impulse, end.terms_mut());
        end.plus(&self.free_difference)
    }

    /// Applies the correction for `residual` to the impulse and to `q = q₁(ℓ)`. The derivative of `φ(q₁(ℓ))` is
    /// `−G₁ D G₀ᵀ`, the `matrix` but for the sign.
    #[inline(always)]
    fn correct(
        &self,
        matrix: &DriftGram<S, F>,
        residual: &S::PerConstraint<f64>,
        q: &mut R::Sum,
        impulse: &mut S::PerConstraint<f64>,
    ) {
        let mut correction = residual.clone();
        matrix.solve(&mut correction);
        subtract::<S, F::Coupling>(&self.directions, &correction, q.terms_mut());
        for c in 0..S::N_CONSTRAINTS {
            impulse[c] += correction[c];
        }
    }

    /// What the residuals at `end` are compared with: `Σᵢ |G_ci| rᵢ`, where `rᵢ` adds up the magnitudes of what `q₁` is
    /// found from.
    fn scale(&self, end: &R::Sum) -> S::PerConstraint<f64> {
        let (start, end) = (self.start, end.value());
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

/// Subtracts `Σ directions[c] y[c]` from `x`.
#[inline]
fn subtract<S: MechanicalSystem, C: Coupling<S>>(
    directions: &Directions<S>,
    y: &S::PerConstraint<f64>,
    x: &mut S::PerCoordinate<f64>,
) {
    if C::IS_DIAGONAL {
        for entry in S::STRUCTURE.jacobian.q {
            x[entry.col] -= directions[entry.row][entry.col] * y[entry.row];
        }
    } else {
        for c in 0..S::N_CONSTRAINTS {
            for i in 0..S::N_COORDINATES {
                x[i] -= directions[c][i] * y[c];
            }
        }
    }
}
