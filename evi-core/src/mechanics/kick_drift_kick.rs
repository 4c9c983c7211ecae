//! Steps that are a kick, a drift and a kick: linear in the momentum at fixed positions.

use super::{ConstantLegendre, CoordinateMatrix, Coupling, Mechanics};
use crate::system::MechanicalSystem;

/// A step without its constraint forces,
///
/// ```text
/// p½ = p₀ + k₀(t₀, q₀)      q₁ = q₀ + D p½      p⁻ = p½ + k₁(t₁, q₁)
/// ```
///
/// with kicks that are gradients and a constant symmetric matrix `D`. Each of the three maps is symplectic whatever the rounding of
/// its matrix, so that rounded coefficients cause no drift.
pub(crate) trait KickDriftKick<S: MechanicalSystem> {
    /// What `D` couples.
    type Coupling: Coupling<S>;

    /// `k₀(t₀, q₀)`.
    fn start_kick(
        &self,
        mechanics: &Mechanics<S>,
        t: f64,
        q: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64>;

    /// `k₁(t₁, q₁)`.
    fn end_kick(&self, mechanics: &Mechanics<S>, t: f64, q: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64>;

    /// `∂k₀/∂q x` at the start of a step: the product of a symmetric matrix.
    #[cfg(feature = "std")]
    fn start_kick_product(
        &self,
        mechanics: &Mechanics<S>,
        t: f64,
        q: &S::PerCoordinate<f64>,
        x: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64>;

    /// `∂k₁/∂q x` at the end of a step.
    #[cfg(feature = "std")]
    fn end_kick_product(
        &self,
        mechanics: &Mechanics<S>,
        t: f64,
        q: &S::PerCoordinate<f64>,
        x: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64>;

    /// `D`: the difference of positions that the momentum `p½` makes is `D p½`.
    fn drift(&self) -> &CoordinateMatrix<S, Self::Coupling>;

    /// The Legendre transform.
    fn legendre(&self) -> &ConstantLegendre<S>;
}
