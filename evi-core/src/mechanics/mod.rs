//! Mechanics of a scene in continuous and discrete time, without a step size policy or an iteration of steps.
//!
//! In: a scene's kernels and their constants. Out: energies, momenta, forces, projections, accelerations with multipliers
//! ([`Mechanics`]), linearisations ([`Linearisation`]), the equations of one step (`DiscreteLagrangian`; `MatrixAction` where a
//! quadratic part is integrated exactly), and steps that are linear in the momentum, but for their constraints: those of
//! quadratic Lagrangians (`FoldedStep`), of the trapezoidal rule (`LeapfrogStep`), and impulse methods (`ImpulseStep`); and those of a single
//! force along a distance, which are found by that (`CentralStep`).

mod central_step;
mod constraint_rank;
mod constraints;
mod coordinate_matrix;
mod coupling;
mod folded_step;
mod forces;
#[cfg(feature = "std")]
mod galerkin_equations;
#[cfg(feature = "std")]
mod gauss_passes;
mod implicit_step;
mod impulse_step;
mod kick_drift_kick;
#[cfg(feature = "std")]
mod lane_step;
mod leapfrog_step;
mod legendre;
mod linearisation;
mod matrix_action;
mod modes;
mod momentum;
mod observables;
#[cfg(feature = "std")]
mod point_guess;
#[cfg(feature = "std")]
mod point_passes;
mod quadratic_part;
#[cfg(feature = "std")]
pub(crate) mod reach;
mod round_off;
mod separable_action;
mod state;
mod step_equations;

pub(crate) use central_step::CentralStep;
pub(crate) use constraint_rank::CONSISTENCY;
pub use constraint_rank::{ConstraintRank, ConstraintSet};
pub(crate) use constraints::{Directions, NOTHING, over_content};
#[cfg(feature = "std")]
pub(crate) use constraints::{for_each_constraint_curvature, for_each_curved_pair};
pub(crate) use coordinate_matrix::{CoordinateMatrix, Rows};
pub(crate) use coupling::{AsMass, AsScene, Coupling, Full};
pub(crate) use folded_step::FoldedStep;
pub(crate) use forces::{ForceDerivatives, ForcePoint};
#[cfg(feature = "std")]
pub(crate) use galerkin_equations::{GalerkinAction, Points};
#[cfg(feature = "std")]
pub(crate) use gauss_passes::{GaussEnd, GaussGuess, GaussPasses};
pub(crate) use implicit_step::{ImplicitStep, StepSolution, StepStart};
pub(crate) use impulse_step::ImpulseStep;
pub(crate) use kick_drift_kick::KickDriftKick;
#[cfg(feature = "std")]
pub(crate) use lane_step::{
    Arrival, BackStep, FirstGuess, LaneEnd, LaneStep, Passes, product, product_of_stored,
};
pub(crate) use leapfrog_step::LeapfrogStep;
pub(crate) use legendre::ConstantLegendre;
#[cfg(feature = "std")]
pub(crate) use legendre::LARGEST_REST;
pub use linearisation::Linearisation;
pub(crate) use matrix_action::MatrixAction;
pub(crate) use modes::Modes;
pub(crate) use momentum::relative;
pub use momentum::{Acceleration, ProjectionError};
pub(crate) use observables::norm;
#[cfg(feature = "std")]
pub(crate) use point_guess::{NodeMotion, PointGuess};
#[cfg(feature = "std")]
pub(crate) use point_passes::{PointEnd, PointIteration, PointPasses};
pub use quadratic_part::QuadraticPart;
pub(crate) use quadratic_part::StepModes;
#[cfg(feature = "std")]
pub(crate) use reach::Length;
pub use round_off::LostDigits;
pub(crate) use round_off::{Dropped, Lost, RoundOff, Rounded, Sum};
pub(crate) use separable_action::SeparableAction;
pub use state::State;
pub(crate) use step_equations::{DiscreteLagrangian, Slot};

use crate::array::Array;
use crate::linear::Kkt;
use crate::scalar::Scalar;
use crate::system::{Entry, MechanicalSystem};

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
        self.mass_kkt(&hessian, &jacobian).scale()
    }

    /// The largest entry of `D ∂²L/∂q² D` with `D = diag 1/√|Mᵢᵢ|`: about the square of the fastest rate of the free motion.
    pub(crate) fn largest_squared_rate(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
        v: &S::PerCoordinate<f64>,
    ) -> f64 {
        let (_, hessian) = S::lagrangian_derivatives(&self.constants, t, q, v);
        let value = |entry: &Entry| entry.value(self.constants.as_ref(), hessian.as_ref());
        let mut mass = S::PerCoordinate::<f64>::from_fn(|_| 0.0);
        for entry in S::STRUCTURE.hessian.vv.iter().filter(|entry| entry.row == entry.col) {
            mass[entry.row] = value(entry).abs();
        }
        let rate = |entry: &Entry| {
            let scale = Scalar::sqrt(mass[entry.row]) * Scalar::sqrt(mass[entry.col]);
            if scale > 0.0 { value(entry).abs() / scale } else { 0.0 }
        };
        S::STRUCTURE.hessian.qq.iter().map(rate).fold(0.0, f64::max)
    }

    /// The mass matrix of a scene in which it is constant.
    pub(crate) fn constant_mass(&self) -> Rows<S> {
        self.mass_at(&Array::from_fn(|_| 0.0))
    }

    /// The saddle-point matrix of mass matrix and constraints, `[M Gᵀ; G 0]`.
    #[inline]
    pub(crate) fn mass_kkt(
        &self,
        hessian: &S::PerHessianEntry<f64>,
        jacobian: &S::PerJacobianEntry<f64>,
    ) -> Kkt<S> {
        let mut kkt = Kkt::zero();
        S::for_each_vv(&self.constants, hessian, |row, col, mass| kkt.add_block(row, col, mass));
        kkt.set_upper_jacobian(&self.constants, jacobian);
        kkt.set_lower_jacobian(&self.constants, jacobian);
        kkt
    }
}
