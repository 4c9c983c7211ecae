//! The step of a quadratic Lagrangian, folded over its nodes.
//!
//! When every second derivative of `L` is constant, none couples velocities with positions, and no other force acts, the discrete
//! Euler-Lagrange equations are linear but for the constraints, and a step is a kick, a drift and a kick:
//!
//! ```text
//! p½ = p₀ − B q₀ − a − G₀ᵀℓ      q₁ = q₀ + A⁻¹ p½      p⁻ = p½ + E q₁ + c
//! ```
//!
//! with `A = −D₁D₂L_d`, `A − B = D₁D₁L_d` and `A + E = D₂D₂L_d`. The matrices depend on parameters, scheme and `h`
//! alone. They are folded once when a run starts: no kernel of `L` is evaluated under a step, its cost does not depend on
//! the number of nodes, and positions are eliminated for good. Each of the three maps is symplectic whatever the rounding
//! of its matrix, so that rounded coefficients cause no drift.

use core::marker::PhantomData;

use super::{
    AsScene, ConstantLegendre, CoordinateMatrix, DiscreteLagrangian, ImplicitStep, KickDriftKick, Mechanics,
    Rows, Slot,
};
use crate::array::Array;
use crate::linear::SingularMatrix;
use crate::scheme::Interpolant;
use crate::system::{LagrangianGradient, MechanicalSystem};

/// A step without its constraint forces, on the curves of `F`.
pub(crate) struct FoldedStep<S: MechanicalSystem, F> {
    /// `q₀ ↦ −(B q₀ + a)`.
    start_kick: Kick<S>,
    /// `q₁ ↦ E q₁ + c`.
    end_kick: Kick<S>,
    /// `A⁻¹`.
    drift: CoordinateMatrix<S>,
    legendre: ConstantLegendre<S>,
    curves: PhantomData<F>,
}

/// An affine force times a time.
// Aligned, so that instructions on two numbers take them from where they are.
#[repr(C, align(16))]
struct Kick<S: MechanicalSystem> {
    constant: S::PerCoordinate<f64>,
    linear: CoordinateMatrix<S>,
}

impl<S: MechanicalSystem, F: Interpolant<S>> FoldedStep<S, F> {
    /// Whether the steps of the scene can be folded.
    pub(crate) const EXISTS: bool = S::STRUCTURE.hessian.is_constant()
        && S::STRUCTURE.hessian.vq.is_empty()
        && !S::STRUCTURE.lagrangian.on_t
        && !S::STRUCTURE.forces.exist();

    /// Folds the action of a step.
    ///
    /// # Errors
    /// [`SingularMatrix`] if `M` or `A` is singular: then the constraints are needed to determine the motion.
    pub(crate) fn new<const K: usize>(
        action: &DiscreteLagrangian<S, F::Table<K>, K>,
    ) -> Result<Self, SingularMatrix> {
        let h = action.h();
        let constants = &action.mechanics.constants;
        let origin = S::PerCoordinate::<f64>::from_fn(|_| 0.0);
        let zero = CoordinateMatrix::<S>::zero_rows;
        let (mut step_matrix, mut start_matrix, mut end_matrix) = (zero(), zero(), zero());
        let (mut start_constant, mut end_constant) = (origin.clone(), origin.clone());
        action.for_each_node(0.0, &origin, &origin, |node, weight, t, x, v| {
            let (LagrangianGradient { force, momentum }, hessian) =
                S::lagrangian_derivatives(constants, t, x, v);
            let add = |matrix: &mut Rows<S>, sign: f64, first, second| {
                action.for_each_second_derivative(
                    node,
                    weight,
                    &hessian,
                    first,
                    second,
                    |row, col, value| matrix[row][col] += sign * value,
                );
            };
            add(&mut step_matrix, -1.0, Slot::START, Slot::END);
            add(&mut start_matrix, 1.0, Slot::START, Slot::BOTH);
            add(&mut end_matrix, 1.0, Slot::BOTH, Slot::END);
            for i in 0..S::N_COORDINATES {
                let c = action.coefficients(node, i);
                start_constant[i] += weight * (h * c.start() * force[i] + c.start_rate() * momentum[i]);
                end_constant[i] += weight * (h * c.end() * force[i] + c.end_rate() * momentum[i]);
            }
        });
        Ok(Self {
            start_kick: Kick { linear: CoordinateMatrix::new(start_matrix), constant: start_constant },
            end_kick: Kick { linear: CoordinateMatrix::new(end_matrix), constant: end_constant },
            drift: CoordinateMatrix::inverse_of(&step_matrix)?,
            legendre: ConstantLegendre::new(&action.mechanics)?,
            curves: PhantomData,
        })
    }
}

#[cfg(feature = "std")]
impl<S: MechanicalSystem, F> FoldedStep<S, F> {
    /// `−B` and `−a`.
    pub(crate) const fn start_kick(&self) -> (&CoordinateMatrix<S>, &S::PerCoordinate<f64>) {
        (&self.start_kick.linear, &self.start_kick.constant)
    }

    /// `E` and `c`.
    pub(crate) const fn end_kick(&self) -> (&CoordinateMatrix<S>, &S::PerCoordinate<f64>) {
        (&self.end_kick.linear, &self.end_kick.constant)
    }
}

impl<S: MechanicalSystem, F: Interpolant<S>> KickDriftKick<S> for FoldedStep<S, F> {
    type Coupling = AsScene;

    #[inline]
    fn start_kick(
        &self,
        _mechanics: &Mechanics<S>,
        _t: f64,
        q: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        self.start_kick.apply(F::IS_STRAIGHT, q)
    }

    #[inline]
    fn end_kick(
        &self,
        _mechanics: &Mechanics<S>,
        _t: f64,
        q: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        self.end_kick.apply(F::IS_STRAIGHT, q)
    }

    #[cfg(feature = "std")]
    #[inline]
    fn start_kick_product(
        &self,
        _mechanics: &Mechanics<S>,
        _t: f64,
        _q: &S::PerCoordinate<f64>,
        x: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        self.start_kick.linear_part(F::IS_STRAIGHT, x)
    }

    #[cfg(feature = "std")]
    #[inline]
    fn end_kick_product(
        &self,
        _mechanics: &Mechanics<S>,
        _t: f64,
        _q: &S::PerCoordinate<f64>,
        x: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        self.end_kick.linear_part(F::IS_STRAIGHT, x)
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

impl<S: MechanicalSystem> Kick<S> {
    /// What a change `x` of the position makes of the kick.
    #[cfg(feature = "std")]
    #[inline]
    fn linear_part(&self, is_straight: bool, x: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64> {
        if is_straight && S::STRUCTURE.hessian.qq.is_empty() {
            return Array::from_fn(|_| 0.0);
        }
        self.linear.times(|i| x[i])
    }

    /// The kick at `q`, which does not depend on `q` where curves are straight and `L` is at most linear in `q`.
    #[inline(always)]
    fn apply(&self, is_straight: bool, q: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64> {
        if is_straight && S::STRUCTURE.hessian.qq.is_empty() {
            return self.constant.clone();
        }
        let linear = self.linear.times(|i| q[i]);
        Array::from_fn(|i| linear[i] + self.constant[i])
    }
}
