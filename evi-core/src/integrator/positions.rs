//! Newton's iteration on the positions and multipliers of a step together, where positions cannot be eliminated.
//!
//! In: the equations of a step ([`ImplicitStep`]) and a [`Guess`]. Out: the [`StepSolution`]. As a rule a fresh matrix or two and a last
//! correction with the factors at hand do. Where they do not, the iteration begins anew, with a fresh matrix for every correction, each
//! judged on its own.

use super::{IterationFailure, StepError};
use crate::array::Array;
use crate::linear::{Factorization, constraint_index, largest_magnitude};
use crate::mechanics::{ImplicitStep, Mechanics, StepSolution, StepStart};
use crate::memory::memory;
use crate::newton::{self, Converged, NotConverged, Tally};
use crate::scalar::Scalar;
use crate::system::MechanicalSystem;

/// After a correction `r` below the root of this, its matrix is good for one more. What Newton leaves of `r` is about `r²`, its matrix then
/// leaves `r³`. Where that is more than round-off, the fresh matrix that follows does as well as it would have done before.
const SHORT: f64 = 1.0 / (1_u64 << 28) as f64;
/// A correction has to be below half of the one before, and the first below half of the sag that it was made for, in squares: else the guess was
/// no good.
const SLOWEST: f64 = 0.25;
/// Fresh matrices before the iteration begins anew.
const FRESH: usize = 6;
/// A history is trusted that predicted the last step to an eighth, in squares.
const TRUSTED: f64 = 1.0 / 64.0;
/// Before its last correction, the root of `SHORT` long, an iteration has to be as near to the constraints.
const NEAR: f64 = 1e-3;
/// After the last one; constraints may add up terms a thousand times larger. Newton's iteration ends where corrections do, which is on the
/// constraints unless their matrix has lost its digits.
const MET: f64 = 1e-9;

/// Where the iteration begins.
pub(super) struct Guess<S: MechanicalSystem> {
    /// `h v₀`, which depends on nothing but the state.
    flight: S::PerCoordinate<f64>,
    /// The expected rest `d − h v₀`, if it is known.
    sag: Option<S::PerCoordinate<f64>>,
}

impl<S: MechanicalSystem> Guess<S> {
    /// The guess `difference`.
    pub(super) fn plain(difference: S::PerCoordinate<f64>) -> Self {
        Self { flight: difference, sag: None }
    }
}

/// The rests `d − h v₀` of the last steps. They affect the number of corrections and the last bits of a state, nothing else.
pub(super) struct Sags<S: MechanicalSystem> {
    /// That of the next step, by a parabola through the last three.
    predicted: S::PerCoordinate<f64>,
    /// Those of the last two steps, newest first.
    previous: [S::PerCoordinate<f64>; 2],
    /// Whether the last step was as predicted.
    was_right: bool,
    /// Whether the one before was: known when the next step begins, which need not wait for it.
    is_trusted: bool,
}

impl<S: MechanicalSystem> Sags<S> {
    /// Before the first step.
    pub(super) fn none() -> Self {
        let none = S::PerCoordinate::<f64>::from_fn(|_| 0.0);
        Self { predicted: none.clone(), previous: [none.clone(), none], was_right: false, is_trusted: false }
    }

    /// The guess for the step that begins with the velocity `v`.
    #[inline(always)]
    pub(super) fn guess(&self, h: f64, v: &S::PerCoordinate<f64>) -> Guess<S> {
        let flight = Array::from_fn(|i| h * v[i]);
        Guess { flight, sag: if self.is_trusted { Some(self.predicted.clone()) } else { None } }
    }

    /// Adds a step that was taken.
    #[inline(always)]
    pub(super) fn remember(&mut self, guess: &Guess<S>, difference: &S::PerCoordinate<f64>) {
        let sag = S::PerCoordinate::<f64>::from_fn(|i| difference[i] - guess.flight[i]);
        let (mut missed, mut whole) = (-0.0, -0.0);
        for i in 0..S::N_COORDINATES {
            let miss = sag[i] - self.predicted[i];
            missed += miss * miss;
            whole += sag[i] * sag[i];
        }
        self.is_trusted = self.was_right;
        self.was_right = missed <= TRUSTED * whole;
        let [first, second] = &self.previous;
        self.predicted = Array::from_fn(|i| 3.0 * (sag[i] - first[i]) + second[i]);
        self.previous = [sag, first.clone()];
    }
}

memory!([S: MechanicalSystem] Sags<S>, |words| Self { predicted, previous, was_right, is_trusted } => {
    words.numbers(predicted);
    words.part(previous);
    words.flag(was_right);
    words.flag(is_trusted);
});

/// Solves the equations of a step.
///
/// # Errors
/// [`StepError`] if they have no solution near the guess.
#[inline(always)]
pub(super) fn solve<S, E>(
    equations: &E,
    start: &StepStart<'_, S>,
    guess: &Guess<S>,
    tally: &mut impl Tally,
) -> Result<StepSolution<S>, StepError>
where
    S: MechanicalSystem,
    E: ImplicitStep<S, Factors = S::KktFactors>,
{
    match converge(equations, start, guess, tally) {
        Some(solution) => Ok(solution),
        None => {
            // Taken apart and put together: the values of the other path stay in registers.
            let StepSolution { difference, impulse, .. } =
                iterate(equations, start, guess.flight.clone(), tally)?;
            let node_kick = equations.node_kick(start, &difference, None);
            Ok(StepSolution { difference, impulse, node_kick })
        }
    }
}

/// The solution, if corrections from `guess` converge as Newton's do.
#[inline(always)]
fn converge<S, E>(
    equations: &E,
    start: &StepStart<'_, S>,
    guess: &Guess<S>,
    tally: &mut impl Tally,
) -> Option<StepSolution<S>>
where
    S: MechanicalSystem,
    E: ImplicitStep<S, Factors = S::KktFactors>,
{
    let mut solution = begun_at(match &guess.sag {
        Some(sag) => Array::from_fn(|i| guess.flight[i] + sag[i]),
        None => guess.flight.clone(),
    });
    let mut weights = S::PerCoordinate::<f64>::from_fn(|_| 0.0);
    let mut previous = f64::INFINITY;
    let mut corrections = 0;
    tally.begin_iteration();
    for fresh in 0..FRESH {
        let (mut update, kkt) = equations.linearize(start, &mut solution);
        tally.see_matrix(|| kkt.conditioning());
        let factors = kkt.factor_unscaled()?;
        factors.solve(&mut update);
        subtract(&mut solution, &update);
        corrections += 1;
        if fresh == 0 {
            weights = kkt.weights(|i| start.q[i].abs() + solution.difference[i].abs());
            if let Some(sag) = &guess.sag {
                previous = squared_length::<S>(&weights, |i| sag[i]);
            }
        }
        let mut length = squared_length::<S>(&weights, |i| update[i]);
        tally.see_correction(|| Scalar::sqrt(length));
        // Written so that a NaN does not contract.
        let contracts = length <= SLOWEST * previous;
        if !contracts {
            return None;
        }
        if length <= SHORT {
            solution.node_kick = equations.node_kick(start, &solution.difference, None);
            let (at_end, jacobian) = equations.constraints_at_end(start, &solution.difference);
            if const { may_lose_constraints::<S>() } {
                let mechanics = equations.mechanics();
                if !are_met(mechanics, start, &solution.difference, &at_end, &jacobian, NEAR) {
                    return None;
                }
            }
            let residual = equations.residual(start, &solution, &at_end);
            let mut update = residual.clone();
            factors.solve(&mut update);
            subtract(&mut solution, &update);
            kick_after(equations, start, &mut solution, &residual, &update);
            corrections += 1;
            let last = squared_length::<S>(&weights, |i| update[i]);
            tally.see_correction(|| Scalar::sqrt(last));
            if newton::squares_predict_round_off(last, length) {
                tally.count_corrections(corrections);
                return Some(solution);
            }
            length = last;
        }
        previous = length;
    }
    None
}

/// Whether the scene's elimination, which does not pivot, can lose digits without a cancellation: where a velocity is coupled to another
/// coordinate, an entry beside the diagonal can be out of all proportion to it.
const fn may_lose_constraints<S: MechanicalSystem>() -> bool {
    S::N_CONSTRAINTS > 0 && !S::STRUCTURE.hessian.vq.is_empty()
}

/// Whether `φ` is at most `allowed` of what a displacement of the size of the step's ends makes of it.
#[inline(always)]
fn are_met<S: MechanicalSystem>(
    mechanics: &Mechanics<S>,
    start: &StepStart<'_, S>,
    difference: &S::PerCoordinate<f64>,
    residual: &S::PerConstraint<f64>,
    jacobian: &S::PerJacobianEntry<f64>,
    allowed: f64,
) -> bool {
    let reach = Array::from_fn(|i| start.q[i].abs() + difference[i].abs());
    let scale = mechanics.constraint_scale(jacobian, &reach);
    // Written so that a NaN is not met.
    (0..S::N_CONSTRAINTS).all(|c| residual[c].abs() <= allowed * scale[c])
}

/// Where an iteration begins.
#[inline(always)]
fn begun_at<S: MechanicalSystem>(difference: S::PerCoordinate<f64>) -> StepSolution<S> {
    StepSolution { difference, impulse: Array::from_fn(|_| 0.0), node_kick: Array::from_fn(|_| 0.0) }
}

/// Applies the correction `update`.
#[inline(always)]
fn subtract<S: MechanicalSystem>(solution: &mut StepSolution<S>, update: &S::PerUnknown<f64>) {
    for i in 0..S::N_COORDINATES {
        solution.difference[i] -= update[i];
    }
    for c in 0..S::N_CONSTRAINTS {
        solution.impulse[c] -= update[constraint_index::<S>(c)];
    }
}

/// Moves the node kick, which belongs to the `residual`, to where the correction `update` has led. There the equations hold, and so the
/// linear terms tell by how much: `Δk = r − A u − G₀ᵀ u_ℓ`, a sum of small numbers, where `k = A d + a + G₀ᵀℓ` is one of large ones.
#[inline(always)]
fn kick_after<S: MechanicalSystem>(
    equations: &impl ImplicitStep<S>,
    start: &StepStart<'_, S>,
    solution: &mut StepSolution<S>,
    residual: &S::PerUnknown<f64>,
    update: &S::PerUnknown<f64>,
) {
    let inertial = equations.inertia_times(&Array::from_fn(|i| update[i]));
    let mut change = S::PerCoordinate::<f64>::from_fn(|i| residual[i] - inertial[i]);
    let impulse = S::PerConstraint::<f64>::from_fn(|c| update[constraint_index::<S>(c)]);
    let mechanics = equations.mechanics();
    mechanics.subtract_constraint_force(&start.jacobian, &impulse, &mut change);
    for i in 0..S::N_COORDINATES {
        solution.node_kick[i] += change[i];
    }
}

/// `Σ wᵢ xᵢ²`.
#[inline(always)]
fn squared_length<S: MechanicalSystem>(weights: &S::PerCoordinate<f64>, x: impl Fn(usize) -> f64) -> f64 {
    let mut sum = -0.0;
    for i in 0..S::N_COORDINATES {
        sum += weights[i] * (x(i) * x(i));
    }
    sum
}

/// Solves the equations of a step from the guess `difference`, with a fresh matrix for every correction.
///
/// # Errors
/// [`StepError`] if they have no solution near the guess.
#[inline]
pub(super) fn iterate<S: MechanicalSystem, E: ImplicitStep<S>>(
    equations: &E,
    start: &StepStart<'_, S>,
    difference: S::PerCoordinate<f64>,
    tally: &mut impl Tally,
) -> Result<StepSolution<S>, StepError> {
    let mut solution = begun_at::<S>(difference);
    let mut constraint_residual = 0.0;
    let mut smallest_pivot_ratio = 1.0_f64;
    tally.begin_iteration();
    let mut last = 0.0;
    let iteration = newton::iterate(|correction| {
        let (mut update, kkt) = equations.linearize(start, &mut solution);
        constraint_residual = largest_magnitude(update.as_ref()[S::N_COORDINATES..].iter().copied());
        tally.see_matrix(|| kkt.conditioning());
        let kkt = E::factor(kkt).map_err(|matrix| IterationFailure::Singular { correction, matrix })?;
        smallest_pivot_ratio = smallest_pivot_ratio.min(kkt.pivot_ratio());
        if kkt.is_fallback() {
            tally.count_fallback();
        }
        kkt.solve(&mut update);
        subtract(&mut solution, &update);
        last = kkt.relative_length(|i| update[i], |i| start.q[i].abs() + solution.difference[i].abs());
        tally.see_correction(|| last);
        Ok(last)
    });
    match iteration {
        Ok(Converged { corrections }) => {
            let (residual, jacobian) = equations.constraints_at_end(start, &solution.difference);
            let mechanics = equations.mechanics();
            if !are_met(mechanics, start, &solution.difference, &residual, &jacobian, MET) {
                let constraint_residual = largest_magnitude(residual.as_ref().iter().copied());
                let failure = NotConverged { corrections, last_correction: last };
                return Err(IterationFailure::from(failure).at(
                    start.t,
                    constraint_residual,
                    smallest_pivot_ratio,
                ));
            }
            tally.count_corrections(corrections);
            Ok(solution)
        }
        Err(failure) => {
            Err(IterationFailure::at(failure, start.t, constraint_residual, smallest_pivot_ratio))
        }
    }
}
