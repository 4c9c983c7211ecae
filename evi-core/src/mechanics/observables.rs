//! Functions of the state that tests and reports look at.

use super::{Mechanics, State, relative};
use crate::array::Array;
use crate::scalar::Scalar;
use crate::system::MechanicalSystem;

impl<S: MechanicalSystem> Mechanics<S> {
    /// Energy `H = v·∂L/∂v − L`.
    pub fn energy(&self, state: &State<S>) -> f64 {
        self.energy_at(state.t(), state.q(), state.v())
    }

    /// The quantities that the scene observes, by the items `observe`, in the order of
    /// [`OBSERVABLES`](MechanicalSystem::OBSERVABLES).
    pub fn observe(&self, state: &State<S>) -> S::PerObservable<f64> {
        S::observables(&self.constants, state.t(), state.q(), state.v(), state.inputs())
    }

    /// `f(t, q, v, u)`: the generalized forces at a state that are no derivatives of `L`.
    pub fn forces(&self, state: &State<S>) -> S::PerCoordinate<f64> {
        S::forces(&self.constants, state.t(), state.q(), state.v(), state.inputs())
    }

    /// Energy `H = v·∂L/∂v − L` at `(t, q, v)`.
    pub fn energy_at(&self, t: f64, q: &S::PerCoordinate<f64>, v: &S::PerCoordinate<f64>) -> f64 {
        let momentum = S::lagrangian_gradient(&self.constants, t, q, v).momentum;
        let action_rate: f64 = momentum.as_ref().iter().zip(v.as_ref()).map(|(p, v)| p * v).sum();
        action_rate - S::lagrangian(&self.constants, t, q, v)
    }

    /// Momentum `p = ∂L/∂v` at `(t, q, v)`.
    pub fn momentum_at(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
        v: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        S::lagrangian_gradient(&self.constants, t, q, v).momentum
    }

    /// Constraint residuals `φ(t, q)`, in the units of the constraints as written.
    pub fn constraint_residual(&self, state: &State<S>) -> S::PerConstraint<f64> {
        self.constraint_residual_at(state.t(), state.q())
    }

    /// Constraint residuals `φ(t, q)`.
    pub fn constraint_residual_at(&self, t: f64, q: &S::PerCoordinate<f64>) -> S::PerConstraint<f64> {
        S::constraints(&self.constants, t, q)
    }

    /// Residuals of the hidden constraints, `|G v + ∂φ/∂t|ᵢ / (‖Gᵢ‖ ‖v‖ + |∂φᵢ/∂t|)`, without unit; 0 at rest.
    /// For a velocity that is itself round-off the quotient says nothing.
    pub fn hidden_constraint_residual(&self, state: &State<S>) -> S::PerConstraint<f64> {
        self.hidden_constraint_residual_at(state.t(), state.q(), state.v())
    }

    /// Residuals of the hidden constraints at `(t, q, v)`.
    pub fn hidden_constraint_residual_at(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
        v: &S::PerCoordinate<f64>,
    ) -> S::PerConstraint<f64> {
        let (_, jacobian) = S::constraint_derivatives(&self.constants, t, q);
        let rate = self.constraint_rate(&jacobian, v);
        let speed = norm(v.as_ref());
        let gradient_norms = self.gradient_norms(&jacobian);
        let mut scale = S::PerConstraint::<f64>::from_fn(|i| gradient_norms[i] * speed);
        for entry in S::STRUCTURE.jacobian.t {
            scale[entry.row] += entry.value(self.constants.as_ref(), jacobian.as_ref()).abs();
        }
        Array::from_fn(|i| relative(rate[i].abs(), scale[i]))
    }
}

/// Euclidean norm.
pub(crate) fn norm(x: &[f64]) -> f64 {
    Scalar::sqrt(x.iter().map(|x| x * x).sum::<f64>())
}
