//! Accelerations and multipliers of the continuous motion, on the generic path.
//!
//! In: a state. Out: the solution of the index-1 equations there.

use nalgebra::DVector;

use super::GenericSystem;
use super::derivatives::Point;
use super::state::GenericState;
use super::workspace::Workspace;
use crate::linear::SingularMatrix;

/// Second derivatives of the motion and the forces that keep it on the constraints.
#[derive(Clone, Debug, PartialEq)]
pub struct GenericAcceleration {
    /// `q̈`, `n` values.
    pub acceleration: DVector<f64>,
    /// `λ`, `m` values: the constraint force is `−Gᵀ λ`.
    pub multipliers: DVector<f64>,
}

impl<S: GenericSystem> Workspace<S> {
    /// The solution of `M q̈ + Gᵀ λ = ∂L/∂q + f − (∂²L/∂v∂q) v − ∂²L/∂v∂t`, `G q̈ = −γ`.
    pub(super) fn acceleration(
        &mut self,
        state: &GenericState,
    ) -> Result<GenericAcceleration, SingularMatrix> {
        self.solve_acceleration(state)?;
        let (acceleration, multipliers) = self.unknowns.split_at(state.q.len());
        Ok(GenericAcceleration {
            acceleration: DVector::from_column_slice(acceleration),
            multipliers: DVector::from_column_slice(multipliers),
        })
    }

    /// Overwrites `unknowns` with `(q̈, λ)`; the saddle-point matrix is scaled for the state from then on.
    pub(super) fn solve_acceleration(&mut self, state: &GenericState) -> Result<(), SingularMatrix> {
        let Self { derivatives, kkt, unknowns, .. } = self;
        let n = state.q.len();
        let at = Point { t: state.t, q: &state.q, v: &state.v };
        let (force, curvature) = unknowns.split_at_mut(n);
        kkt.clear();
        // The momentum comes with the mass matrix and is not needed.
        derivatives.add_mass(at, force, &mut kkt.matrix);
        kkt.set_jacobians(&state.jacobian, &state.jacobian);
        kkt.factor()?;
        force.fill(0.0);
        derivatives.add_force(at, force);
        derivatives.add_applied_force(at, &state.inputs, force);
        derivatives.subtract_momentum_drift(at, force);
        derivatives.constraint_curvatures(at, curvature);
        curvature.iter_mut().for_each(|curvature| *curvature = -*curvature);
        kkt.solve(unknowns);
        Ok(())
    }
}
