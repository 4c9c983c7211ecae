//! The step of a quadratic Lagrangian, folded over its nodes.
//!
//! When every second derivative of `L` is constant and none couples velocities with positions, the discrete
//! Euler-Lagrange equations are linear but for the constraints, and a step is a kick, a drift and a kick:
//!
//! ```text
//! p½ = p₀ − (B q₀ + a + G₀ᵀΛ)/h      q₁ = q₀ + h A⁻¹ p½      p⁻ = p½ + (E q₁ + c)/h
//! ```
//!
//! with `A = −h D₁D₂L_d`, `A − B = h D₁D₁L_d` and `A + E = h D₂D₂L_d`. The matrices depend on parameters, scheme and `h`
//! alone. They are folded once when a run starts: no kernel of `L` is evaluated under a step, its cost does not depend on
//! the number of nodes, and positions are eliminated for good. Each of the three maps is symplectic whatever the rounding
//! of its matrix, so that rounded coefficients cause no drift.

use core::marker::PhantomData;

use super::matrix::{Matrix, inverse, times, zero_matrix};
use super::{DiscreteLagrangian, KickDriftKick, Mechanics, Slot};
use crate::array::Array;
use crate::linear::SingularMatrix;
use crate::scheme::Interpolant;
use crate::system::{LagrangianGradient, MechanicalSystem};

/// A step without its constraint forces, on the curves of `F`.
pub(crate) struct FoldedStep<S: MechanicalSystem, F> {
    /// `q₀ ↦ −(B q₀ + a)/h`.
    start_kick: Kick<S>,
    /// `q₁ ↦ (E q₁ + c)/h`.
    end_kick: Kick<S>,
    /// `h A⁻¹`.
    drift: Matrix<S>,
    /// `M⁻¹`.
    inverse_mass: Matrix<S>,
    /// `∂L/∂v` at `v = 0`.
    momentum_at_rest: S::PerCoordinate<f64>,
    curves: PhantomData<F>,
}

/// An affine force times a time.
struct Kick<S: MechanicalSystem> {
    linear: Matrix<S>,
    constant: S::PerCoordinate<f64>,
}

impl<S: MechanicalSystem, F: Interpolant<S>> FoldedStep<S, F> {
    /// Whether the steps of the scene can be folded.
    pub(crate) const EXISTS: bool = S::STRUCTURE.hessian.is_constant()
        && S::STRUCTURE.hessian.vq.is_empty()
        && !S::STRUCTURE.lagrangian.on_t;

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
        let mut step_matrix = zero_matrix::<S>();
        let (mut start_kick, mut end_kick) = (Kick::<S>::zero(), Kick::<S>::zero());
        action.for_each_node(0.0, &origin, &origin, |node, weight, t, x, v| {
            let (LagrangianGradient { force, momentum }, hessian) =
                S::lagrangian_derivatives(constants, t, x, v);
            let add = |matrix: &mut Matrix<S>, factor: f64, first, second| {
                action.for_each_second_derivative(
                    node,
                    weight,
                    hessian.as_ref(),
                    first,
                    second,
                    |row, col, value| matrix[row][col] += factor * value,
                );
            };
            add(&mut step_matrix, -1.0, Slot::START, Slot::END);
            add(&mut start_kick.linear, 1.0 / h, Slot::START, Slot::BOTH);
            add(&mut end_kick.linear, 1.0 / h, Slot::BOTH, Slot::END);
            for i in 0..S::N_COORDINATES {
                let c = action.coefficients(node, i);
                start_kick.constant[i] += weight * (h * c.start() * force[i] + c.start_rate() * momentum[i]);
                end_kick.constant[i] += weight * (h * c.end() * force[i] + c.end_rate() * momentum[i]);
            }
        });
        let (LagrangianGradient { momentum, .. }, hessian) =
            S::lagrangian_derivatives(constants, 0.0, &origin, &origin);
        let mut mass = zero_matrix::<S>();
        for entry in S::STRUCTURE.hessian.vv {
            let value = entry.value(constants.as_ref(), hessian.as_ref());
            mass[entry.row][entry.col] = value;
            mass[entry.col][entry.row] = value;
        }
        let response = inverse::<S>(&step_matrix)?;
        Ok(Self {
            start_kick,
            end_kick,
            drift: Array::from_fn(|row| Array::from_fn(|col| h * response[row][col])),
            inverse_mass: inverse::<S>(&mass)?,
            momentum_at_rest: momentum,
            curves: PhantomData,
        })
    }
}

impl<S: MechanicalSystem, F: Interpolant<S>> KickDriftKick<S> for FoldedStep<S, F> {
    const DRIFT_IS_UNCOUPLED: bool = S::STRUCTURE.is_uncoupled();

    type DriftGram = S::GramFactors;

    #[inline]
    fn kicked_at_start(
        &self,
        _mechanics: &Mechanics<S>,
        _t: f64,
        q: &S::PerCoordinate<f64>,
        p: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        self.start_kick.apply(F::IS_STRAIGHT, q, p)
    }

    #[inline]
    fn kicked_at_end(
        &self,
        _mechanics: &Mechanics<S>,
        _t: f64,
        q: &S::PerCoordinate<f64>,
        p: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        self.end_kick.apply(F::IS_STRAIGHT, q, p)
    }

    #[inline]
    fn drift(&self, p: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64> {
        times::<S>(S::STRUCTURE.is_uncoupled(), &self.drift, |i| p[i])
    }

    #[inline]
    fn inverse_mass(&self, p: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64> {
        times::<S>(S::STRUCTURE.is_uncoupled(), &self.inverse_mass, |i| p[i])
    }

    #[inline]
    fn velocity(&self, p: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64> {
        if S::STRUCTURE.momentum_vanishes_at_rest {
            return self.inverse_mass(p);
        }
        times::<S>(S::STRUCTURE.is_uncoupled(), &self.inverse_mass, |i| p[i] - self.momentum_at_rest[i])
    }
}

impl<S: MechanicalSystem> Kick<S> {
    fn zero() -> Self {
        Self { linear: zero_matrix::<S>(), constant: Array::from_fn(|_| 0.0) }
    }

    /// `p` after the kick at `q`, which does not depend on `q` where curves are straight and `L` is at most linear in `q`.
    #[inline]
    fn apply(
        &self,
        is_straight: bool,
        q: &S::PerCoordinate<f64>,
        p: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        if is_straight && S::STRUCTURE.hessian.qq.is_empty() {
            return Array::from_fn(|i| p[i] + self.constant[i]);
        }
        let linear = times::<S>(S::STRUCTURE.is_uncoupled(), &self.linear, |i| q[i]);
        Array::from_fn(|i| p[i] + (linear[i] + self.constant[i]))
    }
}
