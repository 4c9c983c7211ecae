//! A kick, a drift and a kick with constraints: Newton's iteration on the multipliers alone.
//!
//! In: a [`KickDriftKick`], whose end point is affine in the impulse `ℓ = Λ/h` of the constraint force. Out: the `ℓ` for which
//! `φ(q₁(ℓ)) = 0`, and the state there. The matrix `G₁ D G₀ᵀ` is evaluated and factored once per step, at an impulse that
//! is extrapolated from the previous steps; each further correction costs one evaluation of the constraints.

use core::marker::PhantomData;

use super::{IterationFailure, StepError};
use crate::array::Array;
use crate::linear::{Factorization, largest_magnitude};
use crate::mechanics::{Directions, KickDriftKick, Mechanics, ProjectionError, State};
use crate::newton::{self, NotConverged, Progress};
use crate::system::MechanicalSystem;

/// A step without its constraint forces, with the impulses that it has needed so far.
pub(crate) struct MultiplierStep<S: MechanicalSystem, F> {
    free: F,
    /// Impulses of the last three steps, newest first: the first guess of the next. They affect the number of
    /// corrections and the last bits of a state, nothing else.
    previous: [S::PerConstraint<f64>; 3],
}

/// The motion of one step as a function of the impulse.
struct Span<'a, S: MechanicalSystem, F> {
    mechanics: &'a Mechanics<S>,
    start_time: f64,
    end_time: f64,
    /// `q₀ + d` without constraint forces.
    free_end: S::PerCoordinate<f64>,
    /// `D G₀ᵀ`.
    directions: Directions<S>,
    /// `1 / Σ |G_ci| rᵢ`, where `rᵢ` adds up the magnitudes of the terms that `q₁` is a sum of: what `φ` is compared with.
    inverse_scale: S::PerConstraint<f64>,
    free: PhantomData<F>,
}

impl<S: MechanicalSystem, F: KickDriftKick<S>> MultiplierStep<S, F> {
    pub(crate) fn new(free: F) -> Self {
        Self { free, previous: core::array::from_fn(|_| Array::from_fn(|_| 0.0)) }
    }

    /// Overwrites `state` with the state one step of size `h` later.
    #[inline(always)]
    pub(crate) fn advance(
        &mut self,
        mechanics: &Mechanics<S>,
        h: f64,
        state: &mut State<S>,
    ) -> Result<(), StepError> {
        let t = state.t + h;
        let mut p = self.free.kicked_at_start(mechanics, state.t, &state.q, &state.p);
        let free_difference = self.free.drift(&p);
        let mut q = Array::from_fn(|i| state.q[i] + free_difference[i]);
        let mut impulse = S::PerConstraint::<f64>::from_fn(|_| 0.0);
        if S::N_CONSTRAINTS > 0 {
            let (_, jacobian) = S::constraint_derivatives(&mechanics.constants, state.t, &state.q);
            let directions = mechanics.constraint_directions(&jacobian, |x| self.free.drift(x));
            impulse = self.extrapolated_impulse();
            let mut reach = S::PerCoordinate::<f64>::from_fn(|i| state.q[i].abs() + free_difference[i].abs());
            add_magnitudes::<S>(F::DRIFT_IS_UNCOUPLED, &directions, &impulse, &mut reach);
            let span = Span::<S, F> {
                free: PhantomData,
                inverse_scale: mechanics.inverse_constraint_scale(&jacobian, &reach),
                directions,
                mechanics,
                start_time: state.t,
                end_time: t,
                free_end: q,
            };
            if span.solve::<false>(&mut impulse).is_err() {
                span.solve_anew(&mut impulse)?;
            }
            q = span.end(&impulse);
            mechanics.subtract_constraint_force(jacobian.as_ref(), impulse.as_ref(), p.as_mut());
        }
        p = self.free.kicked_at_end(mechanics, t, &q, &p);
        let mut v = self.free.velocity(&p);
        if S::N_CONSTRAINTS > 0 {
            self.project(mechanics, t, &q, &mut v, &mut p)?;
        }
        state.replace(t, q, v, p)?;
        self.remember(impulse);
        Ok(())
    }

    /// The impulse that a quadratic through the last three predicts.
    #[inline]
    fn extrapolated_impulse(&self) -> S::PerConstraint<f64> {
        let [newest, older, oldest] = &self.previous;
        Array::from_fn(|c| 3.0 * (newest[c] - older[c]) + oldest[c])
    }

    /// Adds the impulse of a step that was taken.
    #[inline]
    fn remember(&mut self, impulse: S::PerConstraint<f64>) {
        let [newest, older, _] = &self.previous;
        self.previous = [impulse, newest.clone(), older.clone()];
    }

    /// Removes the impulse `Gᵀ N` that leaves the constraints: `G M⁻¹ Gᵀ N = G v + ∂φ/∂t`.
    #[inline(always)]
    fn project(
        &self,
        mechanics: &Mechanics<S>,
        t: f64,
        q: &S::PerCoordinate<f64>,
        v: &mut S::PerCoordinate<f64>,
        p: &mut S::PerCoordinate<f64>,
    ) -> Result<(), StepError> {
        let (_, jacobian) = S::constraint_derivatives(&mechanics.constants, t, q);
        let directions = mechanics.constraint_directions(&jacobian, |x| self.free.inverse_mass(x));
        let gram = mechanics
            .factor_gram(&jacobian, &directions)
            .map_err(|matrix| StepError::Projection { t, cause: ProjectionError::Singular(matrix) })?;
        let mut impulse = S::PerConstraint::<f64>::from_fn(|_| 0.0);
        // Twice: near a turning point `v` is a small difference of large velocities, whose round-off the first time leaves.
        for _ in 0..2 {
            let mut part = mechanics.constraint_rate(jacobian.as_ref(), v);
            gram.solve(&mut part);
            subtract::<S>(S::STRUCTURE.is_uncoupled(), &directions, &part, v);
            for c in 0..S::N_CONSTRAINTS {
                impulse[c] += part[c];
            }
        }
        mechanics.subtract_constraint_force(jacobian.as_ref(), impulse.as_ref(), p.as_mut());
        Ok(())
    }
}

impl<S: MechanicalSystem, F: KickDriftKick<S>> Span<'_, S, F> {
    /// Newton's iteration from the guess `impulse`, which becomes the solution. Its matrix is evaluated at every
    /// correction if it is to be `FRESH`, else once.
    #[inline(always)]
    fn solve<const FRESH: bool>(&self, impulse: &mut S::PerConstraint<f64>) -> Result<(), StepError> {
        let (mut residual, mut gram) = self.linearize(1, impulse)?;
        let mut progress = Progress::default();
        let mut previous = S::PerConstraint::<f64>::from_fn(|_| 0.0);
        loop {
            // Constraint by constraint: the fast convergence of one must not pass for that of all.
            let mut length = 0.0;
            let mut is_round_off = true;
            for c in 0..S::N_CONSTRAINTS {
                let relative = residual[c].abs() * self.inverse_scale[c];
                is_round_off &= newton::predicts_round_off(relative, previous[c]);
                previous[c] = relative;
                // A sum, in which a NaN survives.
                length += relative;
            }
            if !FRESH && progress.is_slow(length) {
                let failure = NotConverged { corrections: progress.corrections(), last_correction: length };
                return Err(self.failed(failure.into(), impulse, gram.pivot_ratio()));
            }
            gram.solve(&mut residual);
            for c in 0..S::N_CONSTRAINTS {
                impulse[c] += residual[c];
            }
            match progress.record(length, is_round_off) {
                Ok(true) => return Ok(()),
                Ok(false) => {}
                Err(failure) => return Err(self.failed(failure.into(), impulse, gram.pivot_ratio())),
            }
            if FRESH {
                (residual, gram) = self.linearize(progress.corrections() + 1, impulse)?;
            } else {
                residual = S::constraints(&self.mechanics.constants, self.end_time, &self.end(impulse));
            }
        }
    }

    /// `φ(q₁(ℓ))`, and the factors of its derivative, `−G₁ D G₀ᵀ`, but for the sign.
    #[inline]
    fn linearize(
        &self,
        correction: usize,
        impulse: &S::PerConstraint<f64>,
    ) -> Result<(S::PerConstraint<f64>, F::DriftGram), StepError> {
        let end = self.end(impulse);
        let (residual, jacobian) = S::constraint_derivatives(&self.mechanics.constants, self.end_time, &end);
        match self.mechanics.factor_gram_with(F::DRIFT_IS_UNCOUPLED, &jacobian, &self.directions) {
            Ok(gram) => Ok((residual, gram)),
            Err(matrix) => Err(self.failed(IterationFailure::Singular { correction, matrix }, impulse, 0.0)),
        }
    }

    /// The numbers that explain a failure.
    #[cold]
    fn failed(
        &self,
        failure: IterationFailure,
        impulse: &S::PerConstraint<f64>,
        pivot_ratio: f64,
    ) -> StepError {
        let residual = S::constraints(&self.mechanics.constants, self.end_time, &self.end(impulse));
        failure.at(self.start_time, largest_magnitude(residual.as_ref().iter().copied()), pivot_ratio)
    }

    /// Newton's iteration without the history, and with a fresh matrix for every correction.
    #[cold]
    fn solve_anew(&self, impulse: &mut S::PerConstraint<f64>) -> Result<(), StepError> {
        *impulse = Array::from_fn(|_| 0.0);
        self.solve::<true>(impulse)
    }

    /// `q₁(ℓ) = q₀ + d_free − D G₀ᵀ ℓ`.
    #[inline]
    fn end(&self, impulse: &S::PerConstraint<f64>) -> S::PerCoordinate<f64> {
        let mut end = self.free_end.clone();
        subtract::<S>(F::DRIFT_IS_UNCOUPLED, &self.directions, impulse, &mut end);
        end
    }
}

/// Subtracts `Σ directions[c] y[c]` from `x`.
#[inline]
fn subtract<S: MechanicalSystem>(
    uncoupled: bool,
    directions: &Directions<S>,
    y: &S::PerConstraint<f64>,
    x: &mut S::PerCoordinate<f64>,
) {
    if uncoupled {
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

/// Adds `Σ |directions[c] y[c]|` to `x`.
#[inline]
fn add_magnitudes<S: MechanicalSystem>(
    uncoupled: bool,
    directions: &Directions<S>,
    y: &S::PerConstraint<f64>,
    x: &mut S::PerCoordinate<f64>,
) {
    if uncoupled {
        for entry in S::STRUCTURE.jacobian.q {
            x[entry.col] += (directions[entry.row][entry.col] * y[entry.row]).abs();
        }
    } else {
        for c in 0..S::N_CONSTRAINTS {
            for i in 0..S::N_COORDINATES {
                x[i] += (directions[c][i] * y[c]).abs();
            }
        }
    }
}
