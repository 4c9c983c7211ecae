//! Mechanics of a scene in continuous and discrete time, without a step size policy or an iteration of steps.
//!
//! In: a scene's kernels and their constants. Out: energies, momenta, forces, projections, accelerations with multipliers
//! ([`Mechanics`]), the equations of one step (`DiscreteLagrangian`), and for quadratic Lagrangians the step itself
//! but for its constraints (`FoldedStep`).

mod constraints;
mod coordinate_matrix;
mod folded_step;
mod forces;
#[cfg(feature = "std")]
mod galerkin_equations;
mod legendre;
mod momentum;
mod observables;
mod state;
mod step_equations;

pub(crate) use constraints::{Directions, NOTHING};
pub(crate) use coordinate_matrix::{CoordinateMatrix, Rows};
pub(crate) use folded_step::FoldedStep;
pub(crate) use forces::{ForceDerivatives, ForcePoint};
#[cfg(feature = "std")]
pub(crate) use galerkin_equations::{GalerkinAction, Points};
pub(crate) use legendre::ConstantLegendre;
pub use momentum::{Acceleration, ProjectionError};
pub(crate) use momentum::{Projected, relative};
pub(crate) use observables::norm;
pub use state::State;
pub(crate) use step_equations::{DiscreteLagrangian, Slot, StepStart};

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

    /// Powers of two that bring the unknowns of a step to one unit: `1/√Mᵢᵢ` for a coordinate, `1/‖√M⁻¹ G_c‖` for a constraint.
    #[cfg(feature = "std")]
    pub(crate) fn unit_scale(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
        v: &S::PerCoordinate<f64>,
    ) -> S::PerUnknown<f64> {
        let (_, hessian) = S::lagrangian_derivatives(&self.constants, t, q, v);
        let (_, jacobian) = S::constraint_derivatives(&self.constants, t, q);
        self.mass_kkt(hessian.as_ref(), jacobian.as_ref()).scale()
    }

    /// The mass matrix of a scene in which it is constant.
    pub(crate) fn constant_mass(&self) -> Rows<S> {
        let at_rest = Array::from_fn(|_| 0.0);
        let (_, hessian) = S::lagrangian_derivatives(&self.constants, 0.0, &at_rest, &at_rest);
        let mut mass = CoordinateMatrix::<S>::zero_rows();
        for entry in S::STRUCTURE.hessian.vv {
            let value = entry.value(self.constants.as_ref(), hessian.as_ref());
            mass[entry.row][entry.col] = value;
            mass[entry.col][entry.row] = value;
        }
        mass
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
}
