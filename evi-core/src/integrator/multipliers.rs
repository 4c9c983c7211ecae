//! The step of a folded scene: Newton's iteration on the multipliers alone.
//!
//! In: a [`FoldedStep`], whose end point is affine in the impulse `ℓ = Λ/h` of the constraint force. Out: the `ℓ` for which
//! `φ(q₁(ℓ)) = 0`, and the state there. From the impulse that the previous steps predict, two corrections with one matrix
//! `h G₁ A⁻¹ G₀ᵀ` do, as a rule; where they do not, Newton's iteration goes on with a fresh matrix for each.

use super::{IterationFailure, StepError};
use crate::array::Array;
use crate::linear::{Factorization, largest_magnitude};
use crate::mechanics::{Directions, FoldedStep, Mechanics, Projected, State};
use crate::newton::{self, Progress, Tally};
use crate::system::MechanicalSystem;

/// Corrections with one matrix that do, as a rule.
const CHORDS: usize = 2;

/// A folded step with the impulses that it has needed so far. They affect the number of corrections and the last bits of
/// a state, nothing else.
pub(crate) struct MultiplierStep<S: MechanicalSystem> {
    folded: FoldedStep<S>,
    /// The first guess of the next step: what a cubic through the last four impulses predicts.
    predicted: S::PerConstraint<f64>,
    /// Impulses of the last three steps, newest first.
    previous: [S::PerConstraint<f64>; 3],
}

/// A last correction that is shorter than this fraction of the displacement by the constraint forces changes no matrix.
const SHORT: f64 = 1.0 / (1_u64 << 40) as f64;

/// The motion of one step as a function of the impulse.
struct Span<'a, S: MechanicalSystem> {
    mechanics: &'a Mechanics<S>,
    folded: &'a FoldedStep<S>,
    t_start: f64,
    t_end: f64,
    /// `q₀`.
    start: &'a S::PerCoordinate<f64>,
    /// `h A⁻¹ p½`, without constraint forces.
    free_difference: S::PerCoordinate<f64>,
    /// Varying entries of `G₀`.
    jacobian: S::PerJacobianEntry<f64>,
    /// `h A⁻¹ G₀ᵀ`.
    directions: Directions<S>,
}

/// The end of a step on the constraints.
struct Landing<S: MechanicalSystem> {
    q: S::PerCoordinate<f64>,
    impulse: S::PerConstraint<f64>,
    /// Factors of `G M⁻¹ Gᵀ` there.
    gram: S::GramFactors,
    /// Number of corrections that led there.
    corrections: usize,
}

impl<S: MechanicalSystem> MultiplierStep<S> {
    pub(crate) fn new(folded: FoldedStep<S>) -> Self {
        let none = S::PerConstraint::<f64>::from_fn(|_| 0.0);
        Self { folded, predicted: none.clone(), previous: [none.clone(), none.clone(), none] }
    }

    /// Overwrites `state` with the state one step of size `h` later.
    #[inline(always)]
    pub(crate) fn advance(
        &mut self,
        mechanics: &Mechanics<S>,
        is_straight: bool,
        h: f64,
        state: &mut State<S>,
        tally: &mut impl Tally,
    ) -> Result<(), StepError> {
        let folded = &self.folded;
        let t = state.t + h;
        let mut p = folded.kicked_at_start(is_straight, &state.q, &state.p);
        let free_difference = folded.drift.times(|i| p[i]);
        if S::N_CONSTRAINTS == 0 {
            let q = Array::from_fn(|i| state.q[i] + free_difference[i]);
            p = folded.kicked_at_end(is_straight, &q, &p);
            return state.replace(t, q, folded.legendre.velocity(&p), p);
        }
        let (_, jacobian) = S::constraint_derivatives(&mechanics.constants, state.t, &state.q);
        let directions = mechanics.constraint_directions(&jacobian, &folded.drift);
        let (t_start, start) = (state.t, &state.q);
        let span =
            Span { mechanics, folded, t_start, t_end: t, start, free_difference, jacobian, directions };
        let Landing { q, impulse, gram, corrections } = span.solve(self.predicted.clone(), tally)?;
        tally.count_corrections(corrections);
        mechanics.subtract_constraint_force(span.jacobian.as_ref(), impulse.as_ref(), p.as_mut());
        p = folded.kicked_at_end(is_straight, &q, &p);

        let (_, jacobian) = S::constraint_derivatives(&mechanics.constants, t, &q);
        let expected = self.expected_end_impulse(&impulse);
        let Projected { v, p } = folded.legendre.project(mechanics, &gram, &jacobian, &expected, p);
        state.replace(t, q, v, p)?;
        self.remember(impulse);
        Ok(())
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
impl<S: MechanicalSystem> Clone for Span<'_, S> {
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

impl<S: MechanicalSystem> Span<'_, S> {
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
    ) -> Result<Landing<S>, StepError> {
        let mut q = self.end(&impulse);
        let (first, jacobian) = self.constraints_at(&q);
        let matrix = self.mechanics.gram_matrix(&jacobian, &self.directions);
        let Ok(chord) = S::GramFactors::factor(&matrix) else { return self.clone().solve_anew(tally) };
        if chord.is_fallback() {
            tally.count_fallback();
        }
        self.correct(&chord, &first, &mut q, &mut impulse);
        let (second, jacobian) = self.constraints_at(&q);
        self.correct(&chord, &second, &mut q, &mut impulse);
        let displacement = Array::from_fn(|c| matrix[c][c] * impulse[c]);
        if is_round_off_next::<S>(&second, &first, &displacement)
            && (0..S::N_CONSTRAINTS).all(|c| second[c].abs() <= SHORT * displacement[c].abs())
            && let Ok(gram) = self.folded.legendre.factor_gram(self.mechanics, &jacobian, tally)
        {
            return Ok(Landing { q, impulse, gram, corrections: CHORDS });
        }
        self.clone().continue_from([first, second], q, impulse, tally)
    }

    /// Newton's iteration after two corrections with one matrix, for the `residuals`, that led to `q`.
    #[inline(never)]
    fn continue_from(
        self,
        [first, second]: [S::PerConstraint<f64>; 2],
        q: S::PerCoordinate<f64>,
        impulse: S::PerConstraint<f64>,
        tally: &mut impl Tally,
    ) -> Result<Landing<S>, StepError> {
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
    fn solve_anew(self, tally: &mut impl Tally) -> Result<Landing<S>, StepError> {
        let none = S::PerConstraint::<f64>::from_fn(|_| 0.0);
        self.iterate(0, none.clone(), self.end(&none), none, tally)
    }

    /// The landing at `q`, where `φ = 0`.
    fn landing(
        &self,
        q: S::PerCoordinate<f64>,
        impulse: S::PerConstraint<f64>,
        corrections: usize,
        tally: &mut impl Tally,
    ) -> Result<Landing<S>, StepError> {
        let (_, jacobian) = self.constraints_at(&q);
        match self.folded.legendre.factor_gram(self.mechanics, &jacobian, tally) {
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
        mut q: S::PerCoordinate<f64>,
        mut impulse: S::PerConstraint<f64>,
        tally: &mut impl Tally,
    ) -> Result<Landing<S>, StepError> {
        let mut progress = Progress::after(relative_length::<S>(&previous, &self.scale(&q)));
        loop {
            let (residual, jacobian) = self.constraints_at(&q);
            let gram = S::GramFactors::factor(&self.mechanics.gram_matrix(&jacobian, &self.directions))
                .map_err(|matrix| {
                    let failure =
                        IterationFailure::Singular { correction: progress.corrections() + 1, matrix };
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
    fn constraints_at(&self, q: &S::PerCoordinate<f64>) -> (S::PerConstraint<f64>, S::PerJacobianEntry<f64>) {
        S::constraint_derivatives(&self.mechanics.constants, self.t_end, q)
    }

    /// `q₁(ℓ) = q₀ − h A⁻¹ G₀ᵀ ℓ + d_free`; the difference comes last, since it is known last.
    #[inline(always)]
    fn end(&self, impulse: &S::PerConstraint<f64>) -> S::PerCoordinate<f64> {
        let mut end = self.start.clone();
        subtract::<S>(&self.directions, impulse, &mut end);
        Array::from_fn(|i| end[i] + self.free_difference[i])
    }

    /// Applies the correction for `residual` to the impulse and to `q = q₁(ℓ)`. The derivative of `φ(q₁(ℓ))` is
    /// `−h G₁ A⁻¹ G₀ᵀ`, the `matrix` but for the sign.
    #[inline(always)]
    fn correct(
        &self,
        matrix: &S::GramFactors,
        residual: &S::PerConstraint<f64>,
        q: &mut S::PerCoordinate<f64>,
        impulse: &mut S::PerConstraint<f64>,
    ) {
        let mut correction = residual.clone();
        matrix.solve(&mut correction);
        subtract::<S>(&self.directions, &correction, q);
        for c in 0..S::N_CONSTRAINTS {
            impulse[c] += correction[c];
        }
    }

    /// What the residuals at `end` are compared with: `Σᵢ |G_ci| rᵢ`, where `rᵢ` adds up the magnitudes of what `q₁` is
    /// found from.
    fn scale(&self, end: &S::PerCoordinate<f64>) -> S::PerConstraint<f64> {
        let reach = Array::from_fn(|i| self.start[i].abs() + self.free_difference[i].abs() + end[i].abs());
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
fn subtract<S: MechanicalSystem>(
    directions: &Directions<S>,
    y: &S::PerConstraint<f64>,
    x: &mut S::PerCoordinate<f64>,
) {
    if S::STRUCTURE.is_uncoupled() {
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
