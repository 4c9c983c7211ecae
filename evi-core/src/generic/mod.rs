//! The generic path: systems whose equations are functions over any [`Scalar`], with sizes known at run time.
//!
//! The derive emits one implementation per scene: the user's expressions in the user's order, without any
//! simplification. It shares nothing with the symbolic compiler and serves as the oracle of its tests.

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
}
