//! Steps that are a kick, a drift and a kick: linear in the momentum at fixed positions.

use super::Mechanics;
use crate::linear::Factorization;
use crate::system::MechanicalSystem;

/// A step without its constraint forces,
///
/// ```text
/// p½ = p₀ + k₀(t₀, q₀)      q₁ = q₀ + D p½      p⁻ = p½ + k₁(t₁, q₁)
/// ```
///
/// with kicks that are gradients and a constant symmetric matrix `D`. Each of the three maps is symplectic whatever the rounding of its
/// matrix, so that rounded coefficients cause no drift.
pub(crate) trait KickDriftKick<S: MechanicalSystem> {
    /// Whether `D` is diagonal. Otherwise it is taken as full.
    const DRIFT_IS_UNCOUPLED: bool;

    /// Solver of systems with the matrix `G₁ D G₀ᵀ`.
    type DriftGram: Factorization<S::PerConstraint<f64>, S::PerConstraint<S::PerConstraint<f64>>>;

    /// `p½` without constraint forces.
    fn kicked_at_start(
        &self,
        mechanics: &Mechanics<S>,
        t: f64,
        q: &S::PerCoordinate<f64>,
        p: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64>;

    /// `p⁻` from `p½`.
    fn kicked_at_end(
        &self,
        mechanics: &Mechanics<S>,
        t: f64,
        q: &S::PerCoordinate<f64>,
        p: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64>;

    /// `D p`: the difference of positions that the momentum `p½` makes.
    fn drift(&self, p: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64>;

    /// `M⁻¹ p`.
    fn inverse_mass(&self, p: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64>;

    /// The velocity of the momentum `p`.
    fn velocity(&self, p: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64>;
}
