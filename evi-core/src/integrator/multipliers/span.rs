//! The motion of one step as a function of the impulse.

use core::borrow::Borrow;

use crate::array::Array;
use crate::linear::Factorization;
use crate::mechanics::{
    Coupling, Directions, KickDriftKick, Mechanics, NOTHING, RoundOff, State, Sum, over_content,
};
use crate::system::MechanicalSystem;

/// The motion of one step as a function of the impulse, from the one that is expected:
///
/// ```text
/// p½ = p₀ + k₀ − G₀ᵀℓ₀      q₁(ℓ₀ + c) = q₀ + D p½ − D G₀ᵀ c
/// ```
pub(super) struct Span<'a, S: MechanicalSystem, F, R: RoundOff<S>> {
    pub(super) mechanics: &'a Mechanics<S>,
    pub(super) free: &'a F,
    pub(super) t_start: f64,
    pub(super) t_end: f64,
    /// `q₀`.
    pub(super) start: S::PerCoordinate<f64>,
    pub(super) round_off: R,
    /// `p½`.
    pub(super) momentum: R::Sum,
    /// `D p½`.
    pub(super) difference: S::PerCoordinate<f64>,
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

impl<'a, S: MechanicalSystem, F: KickDriftKick<S>, R: RoundOff<S>> Span<'a, S, F, R> {
    /// The step of size `h` from `state`, on which the impulse `expected` acts.
    #[inline(always)]
    pub(super) fn new(
        mechanics: &'a Mechanics<S>,
        free: &'a F,
        h: f64,
        state: &State<S>,
        round_off: R,
        expected: &S::PerConstraint<f64>,
    ) -> Self {
        let (_, jacobian) = mechanics.primitive_constraints(state.t, &state.q);
        // The momentum comes last, since it is known last.
        let mut kick = free.start_kick(mechanics, state.t, &state.q);
        mechanics.subtract_constraint_force(&jacobian, expected, &mut kick);
        let momentum = round_off.momentum(&state.p).plus(&kick);
        let difference = drift_of(free, &momentum);
        let directions = mechanics.constraint_directions(&jacobian, free.drift());
        let (t_start, start) = (state.t, state.q.clone());
        Self {
            mechanics,
            free,
            t_start,
            t_end: t_start + h,
            start,
            round_off,
            momentum,
            difference,
            jacobian,
            directions,
        }
    }

    /// Begins with `ℓ₀ = 0`, anew from the momentum `p₀`: what is expected, added to what is there, may be a small difference of the two.
    #[inline(always)]
    pub(super) fn expect_nothing(&mut self, p: &S::PerCoordinate<f64>) {
        let kick = self.free.start_kick(self.mechanics, self.t_start, &self.start);
        self.momentum = self.round_off.momentum(p).plus(&kick);
        self.difference = drift_of(self.free, &self.momentum);
    }

    /// `φ` and the varying entries of `G` at the end of the step.
    #[inline(always)]
    pub(super) fn constraints_at(&self, q: &R::Sum) -> (S::PerConstraint<f64>, S::PerJacobianEntry<f64>) {
        self.mechanics.primitive_constraints(self.t_end, q.value().borrow())
    }

    /// `q₁(ℓ₀)`.
    #[inline(always)]
    pub(super) fn end(&self) -> R::Sum {
        self.round_off.position(&self.start).plus(&self.difference)
    }

    /// `G₁ D G₀ᵀ`.
    #[inline(always)]
    pub(super) fn matrix(&self, end: &S::PerJacobianEntry<f64>) -> S::PerConstraint<S::PerConstraint<f64>> {
        // Of several constraints, products of slopes are shared by the coordinates of a rod: the diagonal matrix comes last.
        if F::Coupling::IS_DIAGONAL && S::N_CONSTRAINTS > 1 {
            self.mechanics.gram_matrix_between(end, self.free.drift(), &self.jacobian)
        } else {
            self.mechanics.gram_matrix::<F::Coupling>(end, &self.directions)
        }
    }

    /// The correction for `residual`. The derivative of `φ(q₁(ℓ))` is `−G₁ D G₀ᵀ`, the `matrix` but for the sign.
    #[inline(always)]
    pub(super) fn correction(
        &self,
        matrix: &DriftGram<S, F>,
        residual: &S::PerConstraint<f64>,
    ) -> Correction<S> {
        let mut solution = residual.clone();
        let factor = matrix.solve_up_to_factor(&mut solution);
        let impulse = S::PerConstraint::<f64>::from_fn(|c| solution[c] * factor);
        let force = |y: &S::PerConstraint<f64>| {
            let mut force = S::PerCoordinate::<f64>::from_fn(|_| NOTHING);
            self.mechanics.add_constraint_force(&self.jacobian, y, &mut force);
            force
        };
        if !F::Coupling::IS_DIAGONAL {
            let (pull, moved) = (force(&impulse), self.along(&impulse));
            return Correction { impulse, pull, moved };
        }
        // The factor last, which is known last.
        let pull = force(&solution);
        let pull = S::PerCoordinate::<f64>::from_fn(|i| pull[i] * factor);
        let moved = self.free.drift().times(|i| pull[i]);
        Correction { impulse, pull, moved }
    }

    /// `D G₀ᵀ y`.
    #[inline(always)]
    fn along(&self, y: &S::PerConstraint<f64>) -> S::PerCoordinate<f64> {
        let mut sum = S::PerCoordinate::<f64>::from_fn(|_| NOTHING);
        for c in 0..S::N_CONSTRAINTS {
            for i in 0..S::N_COORDINATES {
                sum[i] += self.directions[c][i] * y[c];
            }
        }
        sum
    }

    /// `φ(q − d) − φ(q) + G d = ½ dᵀ φ_qq d`, exactly.
    #[inline(always)]
    pub(super) fn remainder(&self, q: &R::Sum, moved: &S::PerCoordinate<f64>) -> S::PerConstraint<f64> {
        let curvature =
            S::constraint_curvature(&self.mechanics.constants, self.t_end, q.value().borrow(), moved);
        over_content::<S>(Array::from_fn(|c| 0.5 * curvature[c]))
    }

    /// What the residuals at `end` are compared with: `Σᵢ |G_ci| rᵢ`, where `rᵢ` adds up the magnitudes of what `q₁` is
    /// found from, the displacements by the impulse `ℓ₀ + c` of every constraint among them: they alone are left where a constraint holds a coordinate at 0.
    pub(super) fn scale(
        &self,
        end: &R::Sum,
        [expected, correction]: [&S::PerConstraint<f64>; 2],
    ) -> S::PerConstraint<f64> {
        let (start, end) = (&self.start, end.value());
        let mut reach: S::PerCoordinate<f64> =
            Array::from_fn(|i| start[i].abs() + self.difference[i].abs() + end.borrow()[i].abs());
        let impulse = |c: usize| expected[c] + correction[c];
        if F::Coupling::IS_DIAGONAL {
            S::for_each_slope(&self.mechanics.constants, &self.jacobian, |row, col, _| {
                reach[col] += (self.directions[row][col] * impulse(row)).abs();
            });
        } else {
            for c in 0..S::N_CONSTRAINTS {
                for i in 0..S::N_COORDINATES {
                    reach[i] += (self.directions[c][i] * impulse(c)).abs();
                }
            }
        }
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

/// `D p½`.
#[inline(always)]
pub(super) fn drift_of<S: MechanicalSystem, F: KickDriftKick<S>>(
    free: &F,
    momentum: &impl Sum<S>,
) -> S::PerCoordinate<f64> {
    let half_way = momentum.value();
    free.drift().times(|i| half_way.borrow()[i])
}

/// Subtracts `moved` from the sum.
#[inline(always)]
pub(super) fn move_by<S: MechanicalSystem, Q: Sum<S>>(sum: &mut Q, moved: &S::PerCoordinate<f64>) {
    for i in 0..S::N_COORDINATES {
        sum.terms_mut()[i] -= moved[i];
    }
}
