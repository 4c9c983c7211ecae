//! The motion of one step as a function of the impulse.

use core::borrow::Borrow;

use crate::array::Array;
use crate::linear::Factorization;
use crate::mechanics::{Coupling, Directions, KickDriftKick, Mechanics, NOTHING, RoundOff, Sum};
use crate::system::MechanicalSystem;

/// The motion of one step as a function of the impulse.
pub(super) struct Span<'a, S: MechanicalSystem, F, R> {
    pub(super) mechanics: &'a Mechanics<S>,
    pub(super) free: &'a F,
    pub(super) t_start: f64,
    pub(super) t_end: f64,
    /// `q₀`.
    pub(super) start: S::PerCoordinate<f64>,
    pub(super) round_off: R,
    /// `D p½`, without constraint forces.
    pub(super) free_difference: S::PerCoordinate<f64>,
    /// Varying entries of `G₀`.
    pub(super) jacobian: S::PerJacobianEntry<f64>,
    /// `D G₀ᵀ`.
    pub(super) directions: Directions<S>,
}

/// A correction of the impulse, and what it does.
pub(super) struct Correction<S: MechanicalSystem> {
    pub(super) impulse: S::PerConstraint<f64>,
    /// `G₀ᵀ` times that: what the momentum loses.
    pub(super) pull: S::PerCoordinate<f64>,
    /// `D` times that: what the end loses.
    pub(super) moved: S::PerCoordinate<f64>,
}

/// Solver with `G₁ D G₀ᵀ`.
pub(super) type DriftGram<S, F> = <<F as KickDriftKick<S>>::Coupling as Coupling<S>>::GramFactors;

impl<S: MechanicalSystem, F: KickDriftKick<S>, R: RoundOff<S>> Span<'_, S, F, R> {
    /// `φ` and the varying entries of `G` at the end of the step.
    #[inline(always)]
    pub(super) fn constraints_at(&self, q: &R::Sum) -> (S::PerConstraint<f64>, S::PerJacobianEntry<f64>) {
        S::constraint_derivatives(&self.mechanics.constants, self.t_end, q.value().borrow())
    }

    /// `q₁(ℓ) = q₀ − D G₀ᵀ ℓ + d_free`; the difference comes last, since it is known last.
    #[inline(always)]
    pub(super) fn end(&self, impulse: &S::PerConstraint<f64>) -> R::Sum {
        let mut end = self.round_off.position(&self.start);
        move_by::<S, _>(&mut end, &self.along(impulse));
        end.plus(&self.free_difference)
    }

    /// The correction for `residual`. The derivative of `φ(q₁(ℓ))` is `−G₁ D G₀ᵀ`, the `matrix` but for the sign.
    #[inline(always)]
    pub(super) fn correction(
        &self,
        matrix: &DriftGram<S, F>,
        residual: &S::PerConstraint<f64>,
    ) -> Correction<S> {
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
    pub(super) fn along(&self, y: &S::PerConstraint<f64>) -> S::PerCoordinate<f64> {
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

    /// The `momentum` less `G₀ᵀ ℓ`.
    #[inline(always)]
    pub(super) fn pulled(&self, mut momentum: R::Sum, impulse: &S::PerConstraint<f64>) -> R::Sum {
        let terms = momentum.terms_mut().as_mut();
        self.mechanics.subtract_constraint_force(self.jacobian.as_ref(), impulse.as_ref(), terms);
        momentum
    }

    /// `φ(q − d) − φ(q) + G d = ½ dᵀ φ_qq d`, exactly.
    #[inline(always)]
    pub(super) fn remainder(&self, q: &R::Sum, moved: &S::PerCoordinate<f64>) -> S::PerConstraint<f64> {
        let curvature =
            S::constraint_curvature(&self.mechanics.constants, self.t_end, q.value().borrow(), moved);
        Array::from_fn(|c| 0.5 * curvature[c])
    }

    /// What the residuals at `end` are compared with: `Σᵢ |G_ci| rᵢ`, where `rᵢ` adds up the magnitudes of what `q₁` is
    /// found from.
    pub(super) fn scale(&self, end: &R::Sum) -> S::PerConstraint<f64> {
        let (start, end) = (&self.start, end.value());
        let reach =
            Array::from_fn(|i| start[i].abs() + self.free_difference[i].abs() + end.borrow()[i].abs());
        self.mechanics.constraint_scale(&self.jacobian, &reach)
    }
}

impl<S: MechanicalSystem> Correction<S> {
    /// This correction and the next one.
    #[inline(always)]
    pub(super) fn and(&self, next: &Self) -> Self {
        Self {
            impulse: Array::from_fn(|c| self.impulse[c] + next.impulse[c]),
            pull: Array::from_fn(|i| self.pull[i] + next.pull[i]),
            moved: Array::from_fn(|i| self.moved[i] + next.moved[i]),
        }
    }
}

/// Subtracts `moved` from the sum.
#[inline(always)]
pub(super) fn move_by<S: MechanicalSystem, Q: Sum<S>>(sum: &mut Q, moved: &S::PerCoordinate<f64>) {
    for i in 0..S::N_COORDINATES {
        sum.terms_mut()[i] -= moved[i];
    }
}
