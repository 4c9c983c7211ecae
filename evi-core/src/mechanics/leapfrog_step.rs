//! The step of the trapezoidal rule on straight curves: the potential acts at the ends of a step alone, so that the matrix of the step is
//! constant whatever the potential is.
//!
//! ```text
//! p½ = p₀ + ½h f(t₀, q₀)      q₁ = q₀ + h M⁻¹ p½      p⁻ = p½ + ½h f(t₁, q₁)      f = ∂L/∂q
//! ```
//!
//! (the method of Störmer and Verlet; with constraints RATTLE, Andersen, J. Comput. Phys. 52 (1983) 24).

use super::{AsScene, ConstantLegendre, CoordinateMatrix, KickDriftKick, Mechanics};
use crate::array::Array;
use crate::linear::SingularMatrix;
use crate::system::MechanicalSystem;

/// A leapfrog step without its constraint forces.
pub(crate) struct LeapfrogStep<S: MechanicalSystem> {
    half_h: f64,
    /// `h M⁻¹`.
    drift: CoordinateMatrix<S>,
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

    /// `p + ½h ∂L/∂q`, which does not depend on the velocity.
    #[inline(always)]
    fn kicked(
        &self,
        mechanics: &Mechanics<S>,
        t: f64,
        q: &S::PerCoordinate<f64>,
        p: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        let at_rest = Array::from_fn(|_| 0.0);
        let force = S::lagrangian_gradient(&mechanics.constants, t, q, &at_rest).force;
        Array::from_fn(|i| p[i] + self.half_h * force[i])
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
        for entry in S::STRUCTURE.hessian.qq {
            let value = self.half_h * entry.value(mechanics.constants.as_ref(), hessian.as_ref());
            product[entry.row] += value * x[entry.col];
            if entry.row != entry.col {
                product[entry.col] += value * x[entry.row];
            }
        }
        product
    }
}

impl<S: MechanicalSystem> KickDriftKick<S> for LeapfrogStep<S> {
    type Coupling = AsScene;

    #[inline(always)]
    fn kicked_at_start(
        &self,
        mechanics: &Mechanics<S>,
        t: f64,
        q: &S::PerCoordinate<f64>,
        p: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        let p = self.kicked(mechanics, t, q, p);
        self.legendre.moving(&p)
    }

    #[inline(always)]
    fn kicked_at_end(
        &self,
        mechanics: &Mechanics<S>,
        t: f64,
        q: &S::PerCoordinate<f64>,
        p: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        let p = self.kicked(mechanics, t, q, p);
        self.legendre.canonical(&p)
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
    fn drift(&self) -> &CoordinateMatrix<S> {
        &self.drift
    }

    #[inline(always)]
    fn legendre(&self) -> &ConstantLegendre<S> {
        &self.legendre
    }
}
