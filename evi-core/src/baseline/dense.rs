//! A scene without what is known about its structure: every step solves the whole saddle-point system by pivoted dense elimination.

use crate::scalar::Scalar;
use crate::system::{HasFrequencies, MechanicalSystem, unfolded_scene_of_inner};

/// The scene `S` with its emitted kernels, but stepped as by a solver that knows only sizes: nothing is folded or eliminated, every
/// Newton correction assembles the `(n + m) × (n + m)` matrix `[hA G₀ᵀ; G₁ 0]` and factors it by the pivoted dense
/// elimination. Its motions are those of `S` to round-off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dense<S>(pub S);

impl<S: MechanicalSystem> MechanicalSystem for Dense<S> {
    unfolded_scene_of_inner!();

    type KktFactors = S::DenseKktFactors;
    type DenseKktFactors = S::DenseKktFactors;
    type MassFactors = S::MassFactors;
    type GramFactors = S::GramFactors;
}

impl<S: HasFrequencies> HasFrequencies for Dense<S> {
    #[inline]
    fn frequencies<T: Scalar>(constants: &Self::PerConstant<T>) -> Self::PerCoordinate<T> {
        S::frequencies(constants)
    }
}
