//! The step of the trapezoidal rule on straight curves: the potential acts at the ends of a step alone, so that the matrix of the step is
//! constant whatever the potential is.
//!
//! ```text
//! p½ = p₀ + ½h f(t₀, q₀)      q₁ = q₀ + h M⁻¹ p½      p⁻ = p½ + ½h f(t₁, q₁)      f = ∂L/∂q
//! ```
//!
//! (the method of Störmer and Verlet; with constraints RATTLE, Andersen, J. Comput. Phys. 52 (1983) 24).

use super::{AsMass, ConstantLegendre, CoordinateMatrix, KickDriftKick, Mechanics};
use crate::array::Array;
use crate::linear::SingularMatrix;
use crate::system::MechanicalSystem;

/// A leapfrog step without its constraint forces.
pub(crate) struct LeapfrogStep<S: MechanicalSystem> {
    half_h: f64,
    /// `h M⁻¹`.
    drift: CoordinateMatrix<S, AsMass>,
    legendre: ConstantLegendre<S>,
}

impl<S: MechanicalSystem> LeapfrogStep<S> {
    /// Whether the scene has such steps.
    pub(crate) const EXISTS: bool = ConstantLegendre::<S>::EXISTS && !S::STRUCTURE.forces.exist();

    /// # Errors
    /// [`SingularMatrix`] if `M` is singular: then the constraints are needed to determine the motion.
    pub(crate) fn new(mechanics: &Mechanics<S>, h: f64) -> Result<Self, SingularMatrix> {
        let drift = CoordinateMatrix::inverse_of(&mechanics.constant_mass())?.scaled(h);
        Ok(Self { half_h: 0.5 * h, drift, legendre: ConstantLegendre::new(mechanics)? })
    }

    /// `½h`.
    #[cfg(feature = "std")]
    pub(crate) const fn half_h(&self) -> f64 {
        self.half_h
    }

    /// `½h ∂L/∂q`, which does not depend on the velocity.
    #[inline(always)]
    fn kick_at(&self, mechanics: &Mechanics<S>, t: f64, q: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64> {
        let at_rest = Array::from_fn(|_| 0.0);
        let force = S::lagrangian_gradient(&mechanics.constants, t, q, &at_rest).force;
        Array::from_fn(|i| self.half_h * force[i])
    }
}

#[cfg(feature = "std")]
impl<S: MechanicalSystem> LeapfrogStep<S> {
    /// `½h ∂²L/∂q² x`.
    fn kick_product(
        &self,
        mechanics: &Mechanics<S>,
        t: f64,
        q: &S::PerCoordinate<f64>,
        x: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        let at_rest = Array::from_fn(|_| 0.0);
        let (_, hessian) = S::lagrangian_derivatives(&mechanics.constants, t, q, &at_rest);
        let mut product = S::PerCoordinate::<f64>::from_fn(|_| 0.0);
        S::for_each_qq(&mechanics.constants, &hessian, |row, col, value| {
            product[row] += self.half_h * value * x[col];
        });
        product
    }
}

impl<S: MechanicalSystem> KickDriftKick<S> for LeapfrogStep<S> {
    type Coupling = AsMass;

    #[inline(always)]
    fn start_kick(
        &self,
        mechanics: &Mechanics<S>,
        t: f64,
        q: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        self.legendre.moving(&self.kick_at(mechanics, t, q))
    }

    #[inline(always)]
    fn end_kick(&self, mechanics: &Mechanics<S>, t: f64, q: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64> {
        self.legendre.canonical(&self.kick_at(mechanics, t, q))
    }

    #[cfg(feature = "std")]
    #[inline]
    fn start_kick_product(
        &self,
        mechanics: &Mechanics<S>,
        t: f64,
        q: &S::PerCoordinate<f64>,
        x: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        self.kick_product(mechanics, t, q, x)
    }

    #[cfg(feature = "std")]
    #[inline]
    fn end_kick_product(
        &self,
        mechanics: &Mechanics<S>,
        t: f64,
        q: &S::PerCoordinate<f64>,
        x: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        self.kick_product(mechanics, t, q, x)
    }

    #[inline(always)]
    fn drift(&self) -> &CoordinateMatrix<S, AsMass> {
        &self.drift
    }

    #[inline(always)]
    fn legendre(&self) -> &ConstantLegendre<S> {
        &self.legendre
    }
}
