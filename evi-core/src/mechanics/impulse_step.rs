//! The impulse step: the exact flow of a quadratic part between two kicks of the rest of the potential.
//!
//! On the trapezoidal rule the action of a step is that of the exact flow less `½h (U(q₀) + U(q₁))`, and the step is
//!
//! ```text
//! p½ = p₀ + T (q₀ − q_ref) − ½h U'(q₀)      q₁ = q₀ + D p½      p⁻ = p½ + T (q₁ − q_ref) − ½h U'(q₁)
//! T = −M W tan ½hW                          D = sin(hW) W⁻¹ M⁻¹
//! ```
//!
//! with `W² = M⁻¹ Ω` (Deuflhard, ZAMP 30 (1979) 177; Hairer, Lubich, Wanner, Geometric Numerical Integration, sec. XIII.1): explicit but for
//! the constraints, symplectic, of order 2, and exact where `U = 0`.

use super::coordinate_matrix::{add_transposed, times};
use super::{
    ConstantLegendre, CoordinateMatrix, Full, KickDriftKick, Mechanics, QuadraticPart, Rows, StepModes,
};
use crate::array::Array;
use crate::linear::SingularMatrix;
use crate::scheme::Mollifier;
use crate::system::MechanicalSystem;

/// An impulse step without its constraint forces.
pub(crate) struct ImpulseStep<S: MechanicalSystem> {
    part: QuadraticPart<S>,
    half_h: f64,
    /// `T + ½h φᵀΩφ`: what is left of the kick once the whole force, not `U'`, has been applied. It is smaller by `(wh)²`, and so
    /// is what its rounding does to symmetries that the force has exactly.
    kick: Rows<S>,
    /// `D`.
    drift: CoordinateMatrix<S, Full>,
    /// `φ(hW)`, where positions are filtered.
    filter: Option<Rows<S>>,
    legendre: ConstantLegendre<S>,
}

impl<S: MechanicalSystem> ImpulseStep<S> {
    /// The step of size `h` for a scene whose mass matrix is constant.
    ///
    /// # Errors
    /// [`SingularMatrix`] for a singular mass matrix.
    pub(crate) fn new(
        mechanics: &Mechanics<S>,
        part: QuadraticPart<S>,
        StepModes { modes, flows }: &StepModes<S>,
        mollifier: Option<Mollifier>,
        h: f64,
    ) -> Result<Self, SingularMatrix> {
        let half_h = 0.5 * h;
        let filter = |k: usize| mollifier.map_or(1.0, |filter| filter.filter(flows[k].squared_phase()));
        Ok(Self {
            half_h,
            kick: modes
                .to_momenta(|k| flows[k].kick + half_h * filter(k) * filter(k) * flows[k].squared_frequency),
            drift: CoordinateMatrix::new(modes.to_positions(|k| flows[k].drift)),
            filter: mollifier.map(|_| modes.function(filter)),
            legendre: ConstantLegendre::new(mechanics)?,
            part,
        })
    }

    /// Calls `see` for the numbers that tell this step from another of its type.
    pub(crate) fn for_each_number(&self, mut see: impl FnMut(f64)) {
        self.part.for_each_number(&mut see);
        for i in 0..S::N_COORDINATES {
            for j in 0..S::N_COORDINATES {
                see(self.kick[i][j]);
                see(self.drift.at(i, j));
                see(self.filter.as_ref().map_or(0.0, |filter| filter[i][j]));
            }
        }
    }

    /// `T (q − q_ref) − ½h ∂/∂q U(t, φ(hW) q)`.
    #[inline]
    fn kick_at(&self, mechanics: &Mechanics<S>, t: f64, q: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64> {
        let QuadraticPart { reference, multipliers, .. } = &self.part;
        let displacement = self.part.displacement(q);
        let linear = times::<S>(&self.kick, &displacement);
        let gradient = match &self.filter {
            None => mechanics.potential_gradient(t, q, multipliers),
            Some(filter) => {
                let filtered = times::<S>(filter, &displacement);
                let x = Array::from_fn(|i| reference[i] + filtered[i]);
                let inner = mechanics.potential_gradient(t, &x, multipliers);
                let mut gradient = Array::from_fn(|_| 0.0);
                add_transposed::<S>(filter, &inner, &mut gradient);
                gradient
            }
        };
        Array::from_fn(|i| linear[i] - self.half_h * gradient[i])
    }
}

#[cfg(feature = "std")]
impl<S: MechanicalSystem> ImpulseStep<S> {
    /// `T x − ½h φᵀ ∂²(V + λᵀφ)/∂q² φ x`.
    fn kick_product(
        &self,
        mechanics: &Mechanics<S>,
        t: f64,
        q: &S::PerCoordinate<f64>,
        x: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        let QuadraticPart { reference, multipliers, .. } = &self.part;
        let linear = times::<S>(&self.kick, x);
        let curvature = match &self.filter {
            None => mechanics.potential_hessian_product(t, q, multipliers, x),
            Some(filter) => {
                let filtered = times::<S>(filter, &self.part.displacement(q));
                let at = Array::from_fn(|i| reference[i] + filtered[i]);
                let inner = mechanics.potential_hessian_product(t, &at, multipliers, &times::<S>(filter, x));
                let mut product = Array::from_fn(|_| 0.0);
                add_transposed::<S>(filter, &inner, &mut product);
                product
            }
        };
        Array::from_fn(|i| linear[i] - self.half_h * curvature[i])
    }
}

impl<S: MechanicalSystem> KickDriftKick<S> for ImpulseStep<S> {
    type Coupling = Full;

    #[inline]
    fn start_kick(
        &self,
        mechanics: &Mechanics<S>,
        t: f64,
        q: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        self.legendre.moving(&self.kick_at(mechanics, t, q))
    }

    #[inline]
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

    #[inline]
    fn drift(&self) -> &CoordinateMatrix<S, Full> {
        &self.drift
    }

    #[inline]
    fn legendre(&self) -> &ConstantLegendre<S> {
        &self.legendre
    }
}
