//! The action of a step for `L = ½ vᵀMv + aᵀv − V(t, q)`, folded over its nodes.
//!
//! Nothing but the force `F = −∂V/∂q` differs from step to step and node to node:
//!
//! ```text
//! −D₁L_d = A d + B q₀ + b − Σ fⱼ F(tⱼ, xⱼ)        D₂L_d = Aᵀ d + E q₁ + e + Σ f'ⱼ F(tⱼ, xⱼ)
//! fⱼ = h wⱼ g₁        f'ⱼ = h wⱼ g₂
//! ```
//!
//! On straight curves `A = M/h`, and `B` and `E` vanish. Momenta leave a step by the matrices that they enter it by, so that rounded
//! coefficients cause no drift.

use super::{CoordinateMatrix, DiscreteLagrangian, ImplicitStep, Mechanics, NOTHING, Rows, Slot};
use crate::array::Array;
use crate::linear::Kkt;
use crate::scheme::InterpolationTable;
use crate::system::{LagrangianGradient, MechanicalSystem};

/// The kinetic part of the action of a step, and the weights of the forces.
pub(crate) struct SeparableAction<S: MechanicalSystem, const K: usize> {
    /// `A`.
    inertia: Rows<S>,
    /// `B`.
    start: Rows<S>,
    /// `E`.
    end: Rows<S>,
    /// `b`.
    start_constant: S::PerCoordinate<f64>,
    /// `e`.
    end_constant: S::PerCoordinate<f64>,
    /// `fⱼ`.
    pub(crate) start_weights: [S::PerCoordinate<f64>; K],
    /// `f'ⱼ`.
    pub(crate) end_weights: [S::PerCoordinate<f64>; K],
    /// `−h wⱼ g₁ g₂`, by rows.
    slopes: [Rows<S>; K],
}

impl<S: MechanicalSystem, const K: usize> SeparableAction<S, K> {
    /// Whether the scene's Lagrangian is of this kind.
    pub(crate) const EXISTS: bool = S::STRUCTURE.is_separable_with_constant_mass();

    /// That of no scene.
    pub(crate) fn none() -> Self {
        let zero = CoordinateMatrix::<S>::zero_rows;
        let none = || Array::from_fn(|_| 0.0);
        Self {
            inertia: zero(),
            start: zero(),
            end: zero(),
            start_constant: none(),
            end_constant: none(),
            start_weights: core::array::from_fn(|_| none()),
            end_weights: core::array::from_fn(|_| none()),
            slopes: core::array::from_fn(|_| zero()),
        }
    }

    /// Folds an action.
    pub(crate) fn new<T: InterpolationTable>(action: &DiscreteLagrangian<S, T, K>) -> Self {
        let mut folded = Self::none();
        let (h, constants) = (action.h(), &action.mechanics.constants);
        let origin = S::PerCoordinate::<f64>::from_fn(|_| 0.0);
        action.for_each_node(0.0, &origin, &origin, |node, weight, t, x, v| {
            let (LagrangianGradient { momentum, .. }, hessian) =
                S::lagrangian_derivatives(constants, t, x, v);
            let add = |matrix: &mut Rows<S>, sign: f64, first, second| {
                action.for_each_inertia(node, &hessian, first, second, |row, col, value| {
                    matrix[row][col] += sign * value;
                });
            };
            add(&mut folded.inertia, -1.0, Slot::START, Slot::END);
            add(&mut folded.start, -1.0, Slot::START, Slot::BOTH);
            add(&mut folded.end, 1.0, Slot::BOTH, Slot::END);
            for i in 0..S::N_COORDINATES {
                let c = action.coefficients(node, i);
                folded.start_constant[i] -= weight * c.start_rate() * momentum[i];
                folded.end_constant[i] += weight * c.end_rate() * momentum[i];
                folded.start_weights[node][i] = weight * h * c.start();
                folded.end_weights[node][i] = weight * h * c.end();
                for k in 0..S::N_COORDINATES {
                    folded.slopes[node][i][k] = -weight * h * c.start() * action.coefficients(node, k).end();
                }
            }
        });
        folded
    }

    /// `A d`.
    #[inline(always)]
    pub(crate) fn inertia_times(&self, difference: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64> {
        let mut product = S::PerCoordinate::<f64>::from_fn(|_| NOTHING);
        Self::add_product(|row, col| self.inertia[row][col], difference, &mut product);
        product
    }

    /// `B q₀ + b`.
    #[inline(always)]
    pub(crate) fn start_momentum(
        &self,
        is_straight: bool,
        q: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        let mut sum = S::PerCoordinate::<f64>::from_fn(|_| NOTHING);
        if !is_straight {
            Self::add_product(|row, col| self.start[row][col], q, &mut sum);
        }
        Self::add_constant(is_straight, &self.start_constant, &mut sum);
        sum
    }

    /// `Aᵀ d + E q₁ + e`.
    #[inline(always)]
    pub(crate) fn end_momentum(
        &self,
        is_straight: bool,
        q: &S::PerCoordinate<f64>,
        difference: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        let mut sum = S::PerCoordinate::<f64>::from_fn(|_| NOTHING);
        Self::add_product(|row, col| self.inertia[col][row], difference, &mut sum);
        if !is_straight {
            let end = Array::from_fn(|i| q[i] + difference[i]);
            Self::add_product(|row, col| self.end[row][col], &end, &mut sum);
        }
        Self::add_constant(is_straight, &self.end_constant, &mut sum);
        sum
    }

    /// Adds `A` to the matrix of the step.
    #[inline(always)]
    pub(crate) fn add_inertia(&self, kkt: &mut Kkt<S>) {
        for entry in S::STRUCTURE.hessian.vv {
            kkt.add_block(entry.row, entry.col, self.inertia[entry.row][entry.col]);
            if entry.row != entry.col {
                kkt.add_block(entry.col, entry.row, self.inertia[entry.col][entry.row]);
            }
        }
    }

    /// Subtracts `h wⱼ g₁ ∂F/∂q g₂` from the matrix of the step.
    #[inline(always)]
    pub(crate) fn subtract_slopes(
        &self,
        mechanics: &Mechanics<S>,
        node: usize,
        hessian: &S::PerHessianEntry<f64>,
        kkt: &mut Kkt<S>,
    ) {
        let slopes = &self.slopes[node];
        S::for_each_qq(&mechanics.constants, hessian, |row, col, value| {
            kkt.add_block(row, col, slopes[row][col] * value);
        });
    }

    /// Adds the product of a matrix that couples what the mass couples with `x`.
    #[inline(always)]
    fn add_product(
        matrix: impl Fn(usize, usize) -> f64,
        x: &S::PerCoordinate<f64>,
        sum: &mut S::PerCoordinate<f64>,
    ) {
        for entry in S::STRUCTURE.hessian.vv {
            sum[entry.row] += matrix(entry.row, entry.col) * x[entry.col];
            if entry.row != entry.col {
                sum[entry.col] += matrix(entry.col, entry.row) * x[entry.row];
            }
        }
    }

    /// Adds a constant that vanishes on straight curves if nothing moves at rest.
    #[inline(always)]
    fn add_constant(is_straight: bool, constant: &S::PerCoordinate<f64>, sum: &mut S::PerCoordinate<f64>) {
        if !(is_straight && S::STRUCTURE.momentum_vanishes_at_rest) {
            for i in 0..S::N_COORDINATES {
                sum[i] += constant[i];
            }
        }
    }
}
