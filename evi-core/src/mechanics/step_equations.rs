//! The constrained discrete Euler-Lagrange equations of one step in position-momentum form.
//!
//! The discrete Lagrangian of a rule `(cⱼ, wⱼ)` on the interpolant between `q₀` and `q₁` is
//!
//! ```text
//! L_d(q₀, q₁) = h Σⱼ wⱼ L(t₀ + cⱼ h, xⱼ, vⱼ)
//! ```
//!
//! A step from `(q₀, p₀)` solves, for the difference `d = q₁ − q₀` and the impulse `Λ = h·L` of the constraint force,
//!
//! ```text
//! h (−D₁L_d(q₀, q₁) − p₀) + G₀ᵀ Λ = 0        φ(t₁, q₁) = 0
//! ```
//!
//! (Marsden & West, Acta Numerica 10 (2001), sec. 3.5; the first row times `h`, so that every entry of the matrix
//! stays of order one as `h → 0`). `p⁻ = D₂L_d(q₀, q₁)` is the momentum that arrives at the end of the step. Where forces
//! act, `∂L/∂q + f` stands for `∂L/∂q` in `D₁L_d` and `D₂L_d`: see [`super::forces`].

use super::{ForceDerivatives, ForcePoint, Mechanics, NOTHING};
use crate::array::Array;
use crate::linear::{Kkt, unknowns};
use crate::scheme::{InterpolationTable, NodeCoefficients, Quadrature, interpolate};
use crate::system::{LagrangianGradient, MechanicalSystem};

/// The discrete Lagrangian of a scene for one step size.
pub(crate) struct DiscreteLagrangian<S: MechanicalSystem, T, const K: usize> {
    pub(crate) mechanics: Mechanics<S>,
    table: T,
    quadrature: Quadrature<K>,
    h: f64,
    /// `1/h`.
    inverse_h: f64,
    /// `wⱼ h²`.
    squared_weights: [f64; K],
}

/// Where a step starts, with what stays fixed during its Newton iteration.
pub(crate) struct StepStart<'a, S: MechanicalSystem> {
    pub(crate) t: f64,
    pub(crate) q: &'a S::PerCoordinate<f64>,
    pub(crate) p: &'a S::PerCoordinate<f64>,
    pub(crate) inputs: &'a S::PerInput<f64>,
    /// The varying entries of `G₀ = G(t₀, q₀)`.
    pub(crate) jacobian: S::PerJacobianEntry<f64>,
}

impl<'a, S: MechanicalSystem> StepStart<'a, S> {
    #[inline]
    pub(crate) fn new(
        mechanics: &Mechanics<S>,
        t: f64,
        q: &'a S::PerCoordinate<f64>,
        p: &'a S::PerCoordinate<f64>,
        inputs: &'a S::PerInput<f64>,
    ) -> Self {
        let (_, jacobian) = S::constraint_derivatives(&mechanics.constants, t, q);
        Self { t, q, p, inputs, jacobian }
    }
}

/// How the position and the velocity times `h` at a node depend on one of the arguments of a step.
#[derive(Clone, Copy)]
pub(crate) struct Slot {
    position: fn(&NodeCoefficients) -> f64,
    rate: fn(&NodeCoefficients) -> f64,
}

impl Slot {
    /// `q₀` at fixed `q₁`.
    pub(crate) const START: Self =
        Self { position: NodeCoefficients::start, rate: NodeCoefficients::start_rate };
    /// `q₁` at fixed `q₀`, which is `d` at fixed `q₀`.
    pub(crate) const END: Self = Self { position: NodeCoefficients::end, rate: NodeCoefficients::end_rate };
    /// `q₀` at fixed `d`: both ends move together.
    pub(crate) const BOTH: Self = Self { position: |c| c.even, rate: |c| c.even_rate };
}

impl<S: MechanicalSystem, T: InterpolationTable, const K: usize> DiscreteLagrangian<S, T, K> {
    pub(crate) fn new(mechanics: Mechanics<S>, table: T, quadrature: Quadrature<K>, h: f64) -> Self {
        let squared_weights = quadrature.weights().map(|weight| weight * h * h);
        Self { mechanics, table, quadrature, h, inverse_h: 1.0 / h, squared_weights }
    }

    /// Step size.
    #[inline]
    pub(crate) fn h(&self) -> f64 {
        self.h
    }

    /// The residual of the step equations at `(d, Λ)` and their derivative
    ///
    /// ```text
    /// [ h A   G₀ᵀ ]      A = −D₁D₂ L_d: rows from slot 0, columns from slot 1.
    /// [ G₁    0   ]
    /// ```
    ///
    /// `A` is not symmetric when `L` couples `q` and `v` or forces act (then it holds `−∂f⁻/∂q₁`, too), and `G₁` moves with
    /// the iterate: hence LU, not LDLᵀ.
    #[inline]
    pub(crate) fn linearize(
        &self,
        start: &StepStart<'_, S>,
        difference: &S::PerCoordinate<f64>,
        impulse: &S::PerConstraint<f64>,
    ) -> (S::PerUnknown<f64>, Kkt<S>) {
        let constants = &self.mechanics.constants;
        let h = self.h;
        let mut kkt = Kkt::zero();
        let mut start_momentum = S::PerCoordinate::<f64>::from_fn(|_| NOTHING);
        self.for_each_node(start.t, start.q, difference, |node, weight, t, x, v| {
            let (mut gradient, hessian) = S::lagrangian_derivatives(constants, t, x, v);
            if S::STRUCTURE.forces.exist() {
                let at = ForcePoint { t, q: x, v, inputs: start.inputs };
                let derivatives = self.mechanics.add_force_with_derivatives(at, &mut gradient.force);
                self.subtract_force_derivatives(node, weight, &derivatives, &mut kkt);
            }
            self.subtract_d1(node, weight, &gradient, &mut start_momentum);
            self.subtract_d2d1(node, weight, hessian.as_ref(), &mut kkt);
        });
        let end = Array::from_fn(|i| start.q[i] + difference[i]);
        let (residual, jacobian) = S::constraint_derivatives(constants, start.t + h, &end);
        kkt.set_upper_jacobian(constants.as_ref(), start.jacobian.as_ref());
        kkt.set_lower_jacobian(constants.as_ref(), jacobian.as_ref());
        let mut momentum_row = S::PerCoordinate::<f64>::from_fn(|i| h * (start_momentum[i] - start.p[i]));
        self.mechanics.add_constraint_force(start.jacobian.as_ref(), impulse.as_ref(), momentum_row.as_mut());
        (unknowns::<S>(|i| momentum_row[i], |c| residual[c]), kkt)
    }

    /// `p⁻ = D₂L_d(q₀, q₀ + d) + f⁺ = Σⱼ wⱼ (h g₂ (∂L/∂q + f) + h g₂' ∂L/∂v)`.
    #[inline]
    pub(crate) fn end_momentum(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
        difference: &S::PerCoordinate<f64>,
        inputs: &S::PerInput<f64>,
    ) -> S::PerCoordinate<f64> {
        let mut end_momentum = S::PerCoordinate::<f64>::from_fn(|_| NOTHING);
        self.for_each_node(t, q, difference, |node, weight, t, x, v| {
            let mut gradient = S::lagrangian_gradient(&self.mechanics.constants, t, x, v);
            self.mechanics.add_force(ForcePoint { t, q: x, v, inputs }, &mut gradient.force);
            for i in 0..S::N_COORDINATES {
                let c = self.table.coefficients(node, i);
                end_momentum[i] +=
                    weight * (self.h * c.end() * gradient.force[i] + c.end_rate() * gradient.momentum[i]);
            }
        });
        end_momentum
    }

    /// `p⁻ − p₀ = (D₁ + D₂) L_d(q₀, q₀ + d) + f⁻ + f⁺ − G₀ᵀΛ/h`, by the step equations: the derivative of `L_d` in which both ends move
    /// together, and so no difference of large momenta.
    pub(crate) fn momentum_gain(
        &self,
        start: &StepStart<'_, S>,
        difference: &S::PerCoordinate<f64>,
        impulse: &S::PerConstraint<f64>,
    ) -> S::PerCoordinate<f64> {
        let mut gain = S::PerCoordinate::<f64>::from_fn(|_| NOTHING);
        let pull = S::PerConstraint::<f64>::from_fn(|c| self.inverse_h * impulse[c]);
        self.for_each_node(start.t, start.q, difference, |node, weight, t, x, v| {
            let mut gradient = S::lagrangian_gradient(&self.mechanics.constants, t, x, v);
            self.mechanics.add_force(ForcePoint { t, q: x, v, inputs: start.inputs }, &mut gradient.force);
            for i in 0..S::N_COORDINATES {
                let c = self.table.coefficients(node, i);
                gain[i] +=
                    weight * (self.h * c.even * gradient.force[i] + c.even_rate * gradient.momentum[i]);
            }
        });
        self.mechanics.subtract_constraint_force(start.jacobian.as_ref(), pull.as_ref(), gain.as_mut());
        gain
    }

    /// Calls `visit(node, weight, t, x, v)` at every node of the interpolant from `q` to `q + difference`.
    #[inline]
    pub(crate) fn for_each_node(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
        difference: &S::PerCoordinate<f64>,
        mut visit: impl FnMut(usize, f64, f64, &S::PerCoordinate<f64>, &S::PerCoordinate<f64>),
    ) {
        let half_sum = S::PerCoordinate::<f64>::from_fn(|i| q[i] + 0.5 * difference[i]);
        for node in 0..K {
            let (x, v) = interpolate::<S>(&self.table, node, &half_sum, difference, self.inverse_h);
            let node_time = t + (0.5 + self.quadrature.offsets()[node]) * self.h;
            visit(node, self.quadrature.weights()[node], node_time, &x, &v);
        }
    }

    /// Subtracts this node's part of `D₁L_d = Σⱼ wⱼ (h g₁ ∂L/∂q + h g₁' ∂L/∂v)`, and of `f⁻` where the gradient's force
    /// holds it, too.
    #[inline]
    fn subtract_d1(
        &self,
        node: usize,
        weight: f64,
        gradient: &LagrangianGradient<S, f64>,
        sum: &mut S::PerCoordinate<f64>,
    ) {
        for i in 0..S::N_COORDINATES {
            let c = self.table.coefficients(node, i);
            sum[i] -=
                weight * (self.h * c.start() * gradient.force[i] + c.start_rate() * gradient.momentum[i]);
        }
    }

    /// Subtracts this node's part of `h D₁D₂L_d`.
    #[inline]
    fn subtract_d2d1(&self, node: usize, weight: f64, hessian: &[f64], kkt: &mut Kkt<S>) {
        self.for_each_second_derivative(node, weight, hessian, Slot::START, Slot::END, |row, col, value| {
            kkt.add_block(row, col, -value);
        });
    }

    /// Subtracts this node's part of `h ∂f⁻/∂q₁ = Σⱼ wⱼ h g₁ (h ∂f/∂q g₂ + ∂f/∂v h g₂')`.
    #[inline]
    fn subtract_force_derivatives(
        &self,
        node: usize,
        weight: f64,
        derivatives: &ForceDerivatives<'_, S>,
        kkt: &mut Kkt<S>,
    ) {
        let h = self.h;
        derivatives.for_each_by_q(|row, col, value| {
            let (of_row, of_col) = self.coefficients_of(node, row, col);
            kkt.add_block(row, col, -(weight * h * h * of_row.start() * value * of_col.end()));
        });
        derivatives.for_each_by_v(|row, col, value| {
            let (of_row, of_col) = self.coefficients_of(node, row, col);
            kkt.add_block(row, col, -(weight * h * of_row.start() * value * of_col.end_rate()));
        });
    }

    /// Calls `add(row, col, value)` for this node's part of the second derivative of `h L_d` by two slots,
    /// entry by entry of the Hessian's pattern:
    /// `wⱼ (h² a L_qq b + h a L_qv b' + h a' L_vq b + a' L_vv b')`, where `a` and `a'` say how position and
    /// velocity times `h` at the node depend on the first slot, `b` and `b'` on the second.
    #[inline]
    pub(crate) fn for_each_second_derivative(
        &self,
        node: usize,
        weight: f64,
        hessian: &[f64],
        first: Slot,
        second: Slot,
        mut add: impl FnMut(usize, usize, f64),
    ) {
        let constants = self.mechanics.constants.as_ref();
        let pattern = S::STRUCTURE.hessian;
        let h = self.h;
        for entry in pattern.qq {
            let value = self.squared_weights[node] * entry.value(constants, hessian);
            let (row, col) = self.coefficients_of(node, entry.row, entry.col);
            add(entry.row, entry.col, (first.position)(&row) * value * (second.position)(&col));
            if entry.row != entry.col {
                add(entry.col, entry.row, (first.position)(&col) * value * (second.position)(&row));
            }
        }
        for entry in pattern.vq {
            let value = weight * h * entry.value(constants, hessian);
            let (row, col) = self.coefficients_of(node, entry.row, entry.col);
            add(entry.row, entry.col, (first.rate)(&row) * value * (second.position)(&col));
            // ∂²L/∂q∂v is the transpose: its row is the coordinate, its column the velocity.
            add(entry.col, entry.row, (first.position)(&col) * value * (second.rate)(&row));
        }
        for entry in pattern.vv {
            let value = weight * entry.value(constants, hessian);
            let (row, col) = self.coefficients_of(node, entry.row, entry.col);
            add(entry.row, entry.col, (first.rate)(&row) * value * (second.rate)(&col));
            if entry.row != entry.col {
                add(entry.col, entry.row, (first.rate)(&col) * value * (second.rate)(&row));
            }
        }
    }

    /// The interpolant's coefficients at a node for a coordinate.
    #[inline]
    pub(crate) fn coefficients(&self, node: usize, coordinate: usize) -> NodeCoefficients {
        self.table.coefficients(node, coordinate)
    }

    #[inline]
    fn coefficients_of(&self, node: usize, row: usize, col: usize) -> (NodeCoefficients, NodeCoefficients) {
        (self.table.coefficients(node, row), self.table.coefficients(node, col))
    }
}
