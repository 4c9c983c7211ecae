//! Which coordinates a constant matrix couples: those of the scene, those of its mass matrix, or all.

use crate::linear::{Factorization, Pivoted};
use crate::system::{MassShape, MechanicalSystem};

/// The pattern of a matrix `D` over the coordinates, and what solves with `G D Gᵀ`.
pub(crate) trait Coupling<S: MechanicalSystem> {
    /// Whether the matrix is diagonal.
    const IS_DIAGONAL: bool;

    /// Solver of systems with `G D Gᵀ`.
    type GramFactors: Factorization<S::PerConstraint<f64>, S::PerConstraint<S::PerConstraint<f64>>>;
}

/// Couples what the scene couples.
pub(crate) struct AsScene;

impl<S: MechanicalSystem> Coupling<S> for AsScene {
    const IS_DIAGONAL: bool = S::STRUCTURE.is_uncoupled();

    type GramFactors = S::GramFactors;
}

/// Couples what the mass matrix couples.
pub(crate) struct AsMass;

impl<S: MechanicalSystem> Coupling<S> for AsMass {
    const IS_DIAGONAL: bool = matches!(S::STRUCTURE.mass_shape, MassShape::Diagonal);

    type GramFactors = S::GramFactors;
}

/// Couples every coordinate with every other.
pub(crate) struct Full;

impl<S: MechanicalSystem> Coupling<S> for Full {
    const IS_DIAGONAL: bool = false;

    type GramFactors = Pivoted<S::PerConstraint<S::PerConstraint<f64>>, S::PerConstraint<usize>>;
}
