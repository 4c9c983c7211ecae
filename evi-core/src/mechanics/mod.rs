//! Mechanics of a scene in continuous and discrete time, without a step size policy or an iteration of steps.
//!
//! In: a scene's kernels and their constants. Out: energies, momenta, projections, accelerations with multipliers
//! ([`Mechanics`]), and the equations of one step (`DiscreteLagrangian`).

mod momentum;
mod observables;
mod state;
mod step_equations;

pub use momentum::{Acceleration, ProjectionError};
pub(crate) use momentum::{Projected, relative};
pub use state::State;
pub(crate) use step_equations::{DiscreteLagrangian, StepStart};

use crate::array::Array;
use crate::linear::Kkt;
use crate::system::MechanicalSystem;

/// A scene with its parameters folded into constants.
pub struct Mechanics<S: MechanicalSystem> {
    pub(crate) constants: S::PerConstant<f64>,
}

impl<S: MechanicalSystem> Clone for Mechanics<S> {
    fn clone(&self) -> Self {
        Self { constants: self.constants.clone() }
    }
}

impl<S: MechanicalSystem> Mechanics<S> {
    /// Folds the parameters of `system` into the constants of its equations.
    pub fn new(system: &S) -> Self {
        Self { constants: S::constants(&system.parameters()) }
    }

    /// The saddle-point matrix of mass matrix and constraints, `[M Gᵀ; G 0]`.
    #[inline]
    pub(crate) fn mass_kkt(&self, hessian: &[f64], jacobian: &[f64]) -> Kkt<S> {
        let mut kkt = Kkt::zero();
        for entry in S::STRUCTURE.hessian.vv {
            let mass = entry.value(self.constants.as_ref(), hessian);
            kkt.add_block(entry.row, entry.col, mass);
            if entry.row != entry.col {
                kkt.add_block(entry.col, entry.row, mass);
            }
        }
        kkt.set_upper_jacobian(self.constants.as_ref(), jacobian);
        kkt.set_lower_jacobian(self.constants.as_ref(), jacobian);
        kkt
    }

    /// Adds `Gᵀ x` to `sum`.
    #[inline]
    pub(crate) fn add_constraint_force(&self, jacobian: &[f64], x: &[f64], sum: &mut [f64]) {
        for entry in S::STRUCTURE.jacobian.q {
            sum[entry.col] += entry.value(self.constants.as_ref(), jacobian) * x[entry.row];
        }
    }

    /// `G v + ∂φ/∂t`: the rate at which a motion leaves the constraints.
    #[inline]
    pub(crate) fn constraint_rate(
        &self,
        jacobian: &[f64],
        v: &S::PerCoordinate<f64>,
    ) -> S::PerConstraint<f64> {
        let mut rate = S::PerConstraint::<f64>::from_fn(|_| 0.0);
        for entry in S::STRUCTURE.jacobian.t {
            rate[entry.row] += entry.value(self.constants.as_ref(), jacobian);
        }
        for entry in S::STRUCTURE.jacobian.q {
            rate[entry.row] += entry.value(self.constants.as_ref(), jacobian) * v[entry.col];
        }
        rate
    }
}
