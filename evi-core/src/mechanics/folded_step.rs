//! The step of a quadratic Lagrangian, folded over its nodes.
//!
//! When every second derivative of `L` is constant, none couples velocities with positions, and no other force acts, the discrete
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

use super::{DiscreteLagrangian, Slot};
use crate::array::Array;
use crate::linear::{Factorization, SingularMatrix};
use crate::scheme::InterpolationTable;
use crate::system::{LagrangianGradient, MechanicalSystem};

/// A matrix over the coordinates, by rows.
type Matrix<S> = <S as MechanicalSystem>::PerCoordinate<<S as MechanicalSystem>::PerCoordinate<f64>>;

/// A step without its constraint forces.
pub(crate) struct FoldedStep<S: MechanicalSystem> {
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
}

/// An affine force times a time.
struct Kick<S: MechanicalSystem> {
    linear: Matrix<S>,
    constant: S::PerCoordinate<f64>,
}

impl<S: MechanicalSystem> FoldedStep<S> {
    /// Whether the steps of the scene can be folded.
    pub(crate) const EXISTS: bool = S::STRUCTURE.hessian.is_constant()
        && S::STRUCTURE.hessian.vq.is_empty()
        && !S::STRUCTURE.lagrangian.on_t
        && !S::STRUCTURE.forces.exist();

    /// Folds the action of a step.
    ///
    /// # Errors
    /// [`SingularMatrix`] if `M` or `A` is singular: then the constraints are needed to determine the motion.
    pub(crate) fn new<T: InterpolationTable, const K: usize>(
        action: &DiscreteLagrangian<S, T, K>,
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
        })
    }

    /// `p½` without constraint forces.
    #[inline]
    pub(crate) fn kicked_at_start(
        &self,
        is_straight: bool,
        q: &S::PerCoordinate<f64>,
        p: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        self.start_kick.apply(is_straight, q, p)
    }

    /// `p⁻` from `p½`.
    #[inline]
    pub(crate) fn kicked_at_end(
        &self,
        is_straight: bool,
        q: &S::PerCoordinate<f64>,
        p: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        self.end_kick.apply(is_straight, q, p)
    }

    /// `h A⁻¹ p`: the difference of positions that the momentum `p½` makes.
    #[inline]
    pub(crate) fn drift(&self, p: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64> {
        times::<S>(&self.drift, |i| p[i])
    }

    /// `M⁻¹ p`.
    #[inline]
    pub(crate) fn inverse_mass(&self, p: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64> {
        times::<S>(&self.inverse_mass, |i| p[i])
    }

    /// The velocity of the momentum `p`.
    #[inline]
    pub(crate) fn velocity(&self, p: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64> {
        if S::STRUCTURE.momentum_vanishes_at_rest {
            return self.inverse_mass(p);
        }
        times::<S>(&self.inverse_mass, |i| p[i] - self.momentum_at_rest[i])
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
        let linear = times::<S>(&self.linear, |i| q[i]);
        Array::from_fn(|i| p[i] + (linear[i] + self.constant[i]))
    }
}

fn zero_matrix<S: MechanicalSystem>() -> Matrix<S> {
    Array::from_fn(|_| Array::from_fn(|_| 0.0))
}

/// `matrix · x`, elementwise where the scene couples no coordinates.
#[inline]
fn times<S: MechanicalSystem>(matrix: &Matrix<S>, x: impl Fn(usize) -> f64) -> S::PerCoordinate<f64> {
    Array::from_fn(|i| {
        if S::STRUCTURE.is_uncoupled() {
            matrix[i][i] * x(i)
        } else {
            (0..S::N_COORDINATES).map(|k| matrix[i][k] * x(k)).sum()
        }
    })
}

fn inverse<S: MechanicalSystem>(matrix: &Matrix<S>) -> Result<Matrix<S>, SingularMatrix> {
    let factors = S::MassFactors::factor(matrix)?;
    // Column by column, kept as rows: the matrix is symmetric, and made so to the last bit.
    let columns: Matrix<S> = Array::from_fn(|col| {
        let mut column = S::PerCoordinate::<f64>::from_fn(|row| if row == col { 1.0 } else { 0.0 });
        factors.solve(&mut column);
        column
    });
    Ok(Array::from_fn(|row| Array::from_fn(|col| 0.5 * (columns[col][row] + columns[row][col]))))
}
