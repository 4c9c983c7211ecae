//! The implicit midpoint rule on the index-1 equations.

use super::equations_of_motion::{EquationsOfMotion, MotionPoint, PerAcceleration};
use super::prediction::Prediction;
use crate::array::Array;
use crate::integrator::{IterationFailure, OneStep, Scheme, StepError, Symmetric, Tally};
use crate::linear::{constraint_index, largest_magnitude, unknowns};
use crate::mechanics::{Mechanics, State};
use crate::memory::memory;
use crate::newton::{self, Converged};
use crate::scheme::{SchemeError, checked_step_size};
use crate::system::MechanicalSystem;

/// The implicit midpoint rule, Gauss' method of order 2 (Hairer, Lubich, Wanner, Geometric Numerical Integration, sec. II.1.3), for
/// `q̇ = v`, `v̇ = a(t, q, v)`, where the accelerations solve the index-1 equations with multipliers and forces:
///
/// ```text
/// q₁ = q₀ + ½h (v₀ + v₁)        v₁ = v₀ + h a        qₘ = ½(q₀ + q₁)        vₘ = ½(v₀ + v₁)
/// M a + (∂²L/∂v∂q) vₘ + ∂²L/∂v∂t + Gᵀλ = ∂L/∂q + f        G a = −γ        at (t₀ + ½h, qₘ, vₘ)
/// ```
///
/// What a general solver of differential equations makes of a scene. `G v + ∂φ/∂t` is a first integral of these equations: it stays
/// at round-off where the constraints are quadratic, as Gauss' methods keep quadratic integrals, and drifts elsewhere; `φ` itself
/// drifts with order 2.
///
/// The implicit midpoint rule in `(q, p)`, which is symplectic, is [`Evi::midpoint`](crate::integrator::Evi::midpoint) on every scene
/// without constraints (Marsden, West, Acta Numerica 10 (2001), sec. 2.6.1). The two coincide where `∂L/∂v = M v` with constant `M`.
///
/// Symmetric, so that it can be composed. Newton's iteration on `(a, λ)` has the exact derivative of the equations of motion and
/// leaves out terms of order `h²` that come from the curvature of the constraints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImplicitMidpoint {
    h: f64,
}

impl ImplicitMidpoint {
    /// Steps of size `h`.
    pub const fn new(h: f64) -> Self {
        Self { h }
    }
}

impl Symmetric for ImplicitMidpoint {
    fn step_size(&self) -> f64 {
        self.h
    }

    fn with_step_size(&self, h: f64) -> Self {
        Self { h }
    }

    fn check_symmetry(&self) -> Result<(), SchemeError> {
        Ok(())
    }
}

impl<S: MechanicalSystem> Scheme<S> for ImplicitMidpoint {
    type Step = ImplicitMidpointStep<S>;

    fn prepare(&self, mechanics: Mechanics<S>) -> Result<ImplicitMidpointStep<S>, SchemeError> {
        let h = checked_step_size(self.h)?;
        Ok(ImplicitMidpointStep {
            equations: EquationsOfMotion::new(mechanics),
            h,
            past: Prediction::default(),
        })
    }
}

/// The one-step map of [`ImplicitMidpoint`].
pub struct ImplicitMidpointStep<S: MechanicalSystem> {
    equations: EquationsOfMotion<S>,
    h: f64,
    /// `(a, λ)` of the last steps: they affect the number of corrections and the last bits of a state, nothing else.
    past: Prediction<S::PerUnknown<f64>>,
}

impl<S: MechanicalSystem> OneStep<S> for ImplicitMidpointStep<S> {
    fn h(&self) -> f64 {
        self.h
    }

    fn mechanics(&self) -> &Mechanics<S> {
        &self.equations.mechanics
    }

    fn advance(&mut self, state: &mut State<S>, tally: &mut impl Tally) -> Result<(), StepError> {
        let h = self.h;
        let solution = match self.past.predicted() {
            Some(predicted) => match self.solve(state, predicted, tally) {
                // A prediction overshoots where the motion turns sharply.
                Err(StepError::NoSolution { .. }) => {
                    self.solve(state, self.at_start(state, tally)?, tally)?
                }
                solution => solution?,
            },
            None => self.solve(state, self.at_start(state, tally)?, tally)?,
        };
        let t = state.t + h;
        let v = Array::from_fn(|i| state.v[i] + h * solution[i]);
        let q = Array::from_fn(|i| state.q[i] + h * (state.v[i] + 0.5 * h * solution[i]));
        let p = self.mechanics().momentum_at(t, &q, &v);
        state.replace(t, q, v, p)?;
        self.past.remember(solution);
        Ok(())
    }
}

impl<S: MechanicalSystem> ImplicitMidpointStep<S> {
    /// The accelerations and multipliers at the start of the step.
    fn at_start(&self, state: &State<S>, tally: &mut impl Tally) -> Result<S::PerUnknown<f64>, StepError> {
        let start = self
            .mechanics()
            .acceleration_tallied(state.t, &state.q, &state.v, &state.inputs, tally)
            .map_err(|matrix| StepError::Singular { t: state.t, correction: 0, matrix })?;
        Ok(unknowns::<S>(|i| start.acceleration[i], |c| start.multipliers[c]))
    }

    /// The accelerations and multipliers at the middle of the step, by Newton's iteration from the guess `solution`.
    fn solve(
        &self,
        state: &State<S>,
        mut solution: S::PerUnknown<f64>,
        tally: &mut impl Tally,
    ) -> Result<S::PerUnknown<f64>, StepError> {
        let h = self.h;
        let mechanics = self.mechanics();
        let constants = &mechanics.constants;
        let per = PerAcceleration { q: 0.25 * h * h, v: 0.5 * h };
        let t = state.t + 0.5 * h;
        let mut constraint_residual = 0.0;
        let mut smallest_pivot_ratio = 1.0_f64;
        let iteration = newton::iterate(|correction| {
            let acceleration = Array::from_fn(|i| solution[i]);
            let v: S::PerCoordinate<f64> = Array::from_fn(|i| state.v[i] + 0.5 * h * solution[i]);
            let q = Array::from_fn(|i| state.q[i] + 0.5 * h * v[i]);
            let at = MotionPoint { t, q, v, acceleration: &acceleration, inputs: &state.inputs };
            let (mut residual, mut kkt) = self.equations.linearize(&at, per);
            let mut curvature = S::PerConstraint::<f64>::from_fn(|_| 0.0);
            if S::N_CONSTRAINTS > 0 {
                let rates = self.equations.moving_jacobian(&at);
                let jacobian: S::PerJacobianEntry<f64> = Array::from_fn(|k| rates[k].value);
                let multipliers = Array::from_fn(|c| solution[constraint_index::<S>(c)]);
                mechanics.add_constraint_force(&jacobian, &multipliers, &mut residual);
                curvature = S::constraint_curvature(constants, t, &at.q, &at.v);
                S::for_each_slope(constants, &jacobian, |row, col, slope| {
                    curvature[row] += slope * acceleration[col];
                });
                // ∂γ/∂v = 2 D G.
                let lower: S::PerJacobianEntry<f64> = Array::from_fn(|k| rates[k].value + h * rates[k].rate);
                kkt.set_upper_jacobian(constants, &jacobian);
                kkt.set_lower_jacobian(constants, &lower);
            }
            constraint_residual = largest_magnitude(curvature.as_ref().iter().copied());
            let kkt = kkt.factor().map_err(|matrix| IterationFailure::Singular { correction, matrix })?;
            smallest_pivot_ratio = smallest_pivot_ratio.min(kkt.pivot_ratio());
            if kkt.is_fallback() {
                tally.count_fallback();
            }
            let mut change = unknowns::<S>(|i| residual[i], |c| curvature[c]);
            kkt.solve(&mut change);
            for (unknown, change) in solution.as_mut().iter_mut().zip(change.as_ref()) {
                *unknown -= change;
            }
            Ok(kkt.relative_length(|i| per.v * h * change[i], |i| at.q[i].abs() + (h * at.v[i]).abs()))
        });
        match iteration {
            Ok(Converged { corrections }) => {
                tally.count_corrections(corrections);
                Ok(solution)
            }
            Err(failure) => {
                Err(IterationFailure::at(failure, state.t, constraint_residual, smallest_pivot_ratio))
            }
        }
    }
}

memory!([S: MechanicalSystem] ImplicitMidpointStep<S>, |words|
    Self { equations: _, h: _, past } => { words.part(past) }
);
