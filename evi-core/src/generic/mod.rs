//! The generic path: systems whose equations are functions over any [`Scalar`], with sizes known at run time.
//!
//! In: a [`GenericSystem`], emitted by the derive for every scene (the user's expressions in the user's order, without
//! any simplification) or written by hand where sizes are known only when the program runs. Out, behind the feature
//! `generic`: `GenericRun`, exponential and Galerkin variational integrators on dense matrices of run-time size, with first
//! and second derivatives by dual numbers. It shares nothing with the symbolic compiler: the oracle of its tests, the
//! baseline that the specialised path is compared with, and what a user has who writes no derive. The stopping rule of
//! Newton's iteration, the interpolants and the errors are those of the specialised path and stand below.

#[cfg(feature = "generic")]
mod acceleration;
#[cfg(feature = "generic")]
mod chunk;
#[cfg(feature = "generic")]
mod derivatives;
#[cfg(feature = "generic")]
mod evi;
#[cfg(feature = "generic")]
mod evi_step;
#[cfg(feature = "generic")]
mod forces;
#[cfg(feature = "generic")]
mod galerkin;
#[cfg(feature = "generic")]
mod galerkin_node;
#[cfg(feature = "generic")]
mod galerkin_step;
#[cfg(feature = "generic")]
mod kkt;
#[cfg(feature = "generic")]
mod projection;
#[cfg(feature = "generic")]
mod run;
#[cfg(feature = "generic")]
mod scheme;
#[cfg(feature = "generic")]
mod state;
#[cfg(feature = "generic")]
mod step;
#[cfg(feature = "generic")]
mod workspace;

#[cfg(feature = "generic")]
pub use acceleration::GenericAcceleration;
#[cfg(feature = "generic")]
pub use evi::GenericEvi;
#[cfg(feature = "generic")]
pub use galerkin::GenericGalerkin;
#[cfg(feature = "generic")]
pub use run::GenericRun;
#[cfg(feature = "generic")]
pub use scheme::GenericScheme;

use crate::scalar::Scalar;

/// A Lagrangian and holonomic constraints on slices; derived, or written by hand.
pub trait GenericSystem {
    /// Number of coordinates, `n`.
    fn n_coordinates(&self) -> usize;

    /// Number of constraints, `m`.
    fn n_constraints(&self) -> usize;

    /// `L(t, q, v)` for `q` and `v` of length `n`.
    fn lagrangian<T: Scalar>(&self, t: T, q: &[T], v: &[T]) -> T;

    /// Overwrites `residuals`, of length `m`, with `φ(t, q)`.
    fn constraints<T: Scalar>(&self, t: T, q: &[T], residuals: &mut [T]);

    /// Number of inputs: values that forces depend on and that are set from step to step.
    fn n_inputs(&self) -> usize {
        0
    }

    /// Whether the system has a [`dissipation`](Self::dissipation), which is not evaluated otherwise.
    const HAS_DISSIPATION: bool = false;

    /// Rayleigh's function `D(t, q, v)`: the force is `−∂D/∂v`.
    fn dissipation<T: Scalar>(&self, _t: T, _q: &[T], _v: &[T]) -> T {
        T::from_f64(0.0)
    }

    /// Whether the system [adds forces](Self::add_forces), which are not evaluated otherwise.
    const HAS_FORCES: bool = false;

    /// Adds the generalized forces that are neither derivatives of `L` nor of the dissipation to `forces`, of length `n`.
    fn add_forces<T: Scalar>(&self, _t: T, _q: &[T], _v: &[T], _inputs: &[T], _forces: &mut [T]) {}
}
