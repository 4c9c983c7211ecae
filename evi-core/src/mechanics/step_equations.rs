//! The constrained discrete Euler-Lagrange equations of one step in position-momentum form.
//!
//! The discrete Lagrangian of a rule `(cⱼ, wⱼ)` on the interpolant between `q₀` and `q₁` is
//!
//! ```text
//! L_d(q₀, q₁) = h Σⱼ wⱼ L(t₀ + cⱼ h, xⱼ, vⱼ)
//! ```
//!
//! A step from `(q₀, p₀)` solves, for the difference `d = q₁ − q₀` and the impulse `ℓ` of the constraint force,
//!
//! ```text
//! −D₁L_d(q₀, q₁) − p₀ + G₀ᵀ ℓ = 0        φ(t₁, q₁) = 0
//! ```
//!
//! (Marsden & West, Acta Numerica 10 (2001), sec. 3.5). `p⁻ = D₂L_d(q₀, q₁)` is the momentum that arrives at the end of the step.
//! Where forces act, `∂L/∂q + f` stands for `∂L/∂q` in `D₁L_d` and `D₂L_d`: see [`super::forces`]. Where the mass matrix is constant, the
//! kinetic part of both is folded over the nodes: see [`SeparableAction`].

use super::{
    ForceDerivatives, ForcePoint, ImplicitStep, Mechanics, NOTHING, SeparableAction, StepSolution, StepStart,
};
use crate::array::Array;
use crate::linear::{FactoredKkt, Kkt, SingularMatrix};
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
    /// `wⱼ/h`.
    divided_weights: [f64; K],
    /// `wⱼ h`.
    multiplied_weights: [f64; K],
    separable: SeparableAction<S, K>,
    /// Whether the forces of a step act on both of its ends alike: those of a single node in the middle. Then the equations of the step
    /// tell what they are, and none is evaluated where the iteration has ended.
    kicks_alike: bool,
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
        let mut action = Self {
            mechanics,
            table,
            quadrature,
            h,
            inverse_h: 1.0 / h,
            divided_weights: quadrature.weights().map(|weight| weight / h),
            multiplied_weights: quadrature.weights().map(|weight| weight * h),
            separable: SeparableAction::none(),
            // Exactly the middle, where the coefficients of both ends agree to the last bit.
            kicks_alike: SeparableAction::<S, K>::EXISTS && K == 1 && quadrature.offsets()[0] == 0.0,
        };
        if SeparableAction::<S, K>::EXISTS {
            action.separable = SeparableAction::new(&action);
        }
        action
    }

    /// The rule that samples the Lagrangian.
    pub(crate) const fn quadrature(&self) -> &Quadrature<K> {
        &self.quadrature
    }

    /// The curves between the ends of a step.
    #[cfg(feature = "std")]
    pub(crate) const fn table(&self) -> &T {
        &self.table
    }

    /// Calls `see` for the numbers that tell this action from another of its type: those of the rule, and of the curves, which are affine in
    /// the ends of a step.
    pub(crate) fn for_each_number(&self, mut see: impl FnMut(f64)) {
        for node in 0..K {
            see(self.quadrature.offsets()[node]);
            see(self.quadrature.weights()[node]);
            for i in 0..S::N_COORDINATES {
                for (q, d) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)] {
                    let (x, rate) = self.table.evaluate(node, i, q, d);
                    see(x);
                    see(rate);
                }
            }
        }
    }

    /// `p⁻ = D₂L_d(q₀, q₀ + d) + f⁺ = Σⱼ wⱼ (h g₂ (∂L/∂q + f) + h g₂' ∂L/∂v)`.
    #[inline]
    pub(crate) fn arriving_momentum(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
        difference: &S::PerCoordinate<f64>,
        inputs: &S::PerInput<f64>,
    ) -> S::PerCoordinate<f64> {
        let mut momentum = if SeparableAction::<S, K>::EXISTS {
            self.separable.end_momentum(T::IS_STRAIGHT, q, difference)
        } else {
            Array::from_fn(|_| NOTHING)
        };
        self.for_each_node(t, q, difference, |node, weight, t, x, v| {
            let gradient = self.gradient(ForcePoint { t, q: x, v, inputs });
            for i in 0..S::N_COORDINATES {
                momentum[i] += if SeparableAction::<S, K>::EXISTS {
                    self.separable.end_weights[node][i] * gradient.force[i]
                } else {
                    let c = self.table.coefficients(node, i);
                    weight * (self.h * c.end() * gradient.force[i] + c.end_rate() * gradient.momentum[i])
                };
            }
        });
        momentum
    }

    /// Whether [`Self::kicks_alike`], as far as the compiler can tell.
    #[inline(always)]
    fn kicks_alike(&self) -> bool {
        SeparableAction::<S, K>::EXISTS && K == 1 && self.kicks_alike
    }

    /// `p⁻ − p₀ = (D₁ + D₂) L_d(q₀, q₀ + d) + f⁻ + f⁺ − G₀ᵀℓ`, by the step equations: the derivative of `L_d` in which both ends move
    /// together, and so no difference of large momenta.
    #[inline(always)]
    pub(crate) fn momentum_gain(
        &self,
        start: &StepStart<'_, S>,
        StepSolution { difference, impulse, node_kick }: &StepSolution<S>,
    ) -> S::PerCoordinate<f64> {
        let mut gain = if self.kicks_alike() {
            Array::from_fn(|i| 2.0 * node_kick[i])
        } else {
            self.joint_momentum(start, difference)
        };
        self.mechanics.subtract_constraint_force(&start.jacobian, impulse, &mut gain);
        gain
    }

    /// `(D₁ + D₂) L_d(q₀, q₀ + d) + f⁻ + f⁺`.
    fn joint_momentum(
        &self,
        start: &StepStart<'_, S>,
        difference: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        let mut gain = S::PerCoordinate::<f64>::from_fn(|_| NOTHING);
        self.for_each_node(start.t, start.q, difference, |node, weight, t, x, v| {
            let gradient = self.gradient(ForcePoint { t, q: x, v, inputs: start.inputs });
            for i in 0..S::N_COORDINATES {
                let c = self.table.coefficients(node, i);
                gain[i] +=
                    weight * (self.h * c.even * gradient.force[i] + c.even_rate * gradient.momentum[i]);
            }
        });
        gain
    }

    /// `∂L/∂q + f` and `∂L/∂v`.
    #[inline(always)]
    fn gradient(&self, at: ForcePoint<'_, S>) -> LagrangianGradient<S, f64> {
        let mut gradient = S::lagrangian_gradient(&self.mechanics.constants, at.t, at.q, at.v);
        self.mechanics.add_force(at, &mut gradient.force);
        gradient
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
        for node in 0..K {
            let (x, v) = interpolate::<S>(&self.table, node, q, difference, self.inverse_h);
            let node_time = t + (0.5 + self.quadrature.offsets()[node]) * self.h;
            visit(node, self.quadrature.weights()[node], node_time, &x, &v);
        }
    }

    /// Adds this node's part of `D₁L_d = Σⱼ wⱼ (h g₁ ∂L/∂q + h g₁' ∂L/∂v)` without what is folded, and of `f⁻` where the
    /// gradient's force holds it, too.
    #[inline(always)]
    fn add_d1(
        &self,
        node: usize,
        weight: f64,
        gradient: &LagrangianGradient<S, f64>,
        sum: &mut S::PerCoordinate<f64>,
    ) {
        for i in 0..S::N_COORDINATES {
            sum[i] += if SeparableAction::<S, K>::EXISTS {
                self.separable.start_weights[node][i] * gradient.force[i]
            } else {
                let c = self.table.coefficients(node, i);
                weight * (self.h * c.start() * gradient.force[i] + c.start_rate() * gradient.momentum[i])
            };
        }
    }

    /// Subtracts this node's part of `D₁D₂L_d` without what is folded.
    #[inline(always)]
    fn subtract_d2d1(&self, node: usize, weight: f64, hessian: &S::PerHessianEntry<f64>, kkt: &mut Kkt<S>) {
        if SeparableAction::<S, K>::EXISTS {
            self.separable.subtract_slopes(&self.mechanics, node, hessian, kkt);
        } else {
            let subtract = |row, col, value: f64| kkt.add_block(row, col, -value);
            self.for_each_second_derivative(node, weight, hessian, Slot::START, Slot::END, subtract);
        }
    }

    /// Subtracts this node's part of `∂f⁻/∂q₁ = Σⱼ wⱼ g₁ (h ∂f/∂q g₂ + ∂f/∂v h g₂')`.
    #[inline]
    fn subtract_force_derivatives(
        &self,
        node: usize,
        weight: f64,
        derivatives: &ForceDerivatives<'_, S>,
        kkt: &mut Kkt<S>,
    ) {
        derivatives.for_each_by_q(|row, col, value| {
            let (of_row, of_col) = self.coefficients_of(node, row, col);
            kkt.add_block(row, col, -(weight * self.h * of_row.start() * value * of_col.end()));
        });
        derivatives.for_each_by_v(|row, col, value| {
            let (of_row, of_col) = self.coefficients_of(node, row, col);
            kkt.add_block(row, col, -(weight * of_row.start() * value * of_col.end_rate()));
        });
    }

    /// Calls `add(row, col, value)` for this node's part of the second derivative of `L_d` by two slots,
    /// entry by entry of the Hessian's pattern:
    /// `wⱼ (h a L_qq b + a L_qv b' + a' L_vq b + a' L_vv b' / h)`, where `a` and `a'` say how position and
    /// velocity times `h` at the node depend on the first slot, `b` and `b'` on the second.
    #[inline]
    pub(crate) fn for_each_second_derivative(
        &self,
        node: usize,
        weight: f64,
        hessian: &S::PerHessianEntry<f64>,
        first: Slot,
        second: Slot,
        mut add: impl FnMut(usize, usize, f64),
    ) {
        let constants = &self.mechanics.constants;
        S::for_each_qq(constants, hessian, |row, col, value| {
            let value = self.multiplied_weights[node] * value;
            let (a, b) = self.coefficients_of(node, row, col);
            add(row, col, (first.position)(&a) * value * (second.position)(&b));
        });
        for entry in S::STRUCTURE.hessian.vq {
            let value = weight * entry.value(constants.as_ref(), hessian.as_ref());
            let (row, col) = self.coefficients_of(node, entry.row, entry.col);
            add(entry.row, entry.col, (first.rate)(&row) * value * (second.position)(&col));
            // ∂²L/∂q∂v is the transpose: its row is the coordinate, its column the velocity.
            add(entry.col, entry.row, (first.position)(&col) * value * (second.rate)(&row));
        }
        self.for_each_inertia(node, hessian, first, second, add);
    }

    /// The same for the part `wⱼ a' L_vv b' / h`.
    #[inline]
    pub(crate) fn for_each_inertia(
        &self,
        node: usize,
        hessian: &S::PerHessianEntry<f64>,
        first: Slot,
        second: Slot,
        mut add: impl FnMut(usize, usize, f64),
    ) {
        S::for_each_vv(&self.mechanics.constants, hessian, |row, col, value| {
            let value = self.divided_weights[node] * value;
            let (a, b) = self.coefficients_of(node, row, col);
            add(row, col, (first.rate)(&a) * value * (second.rate)(&b));
        });
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

impl<S: MechanicalSystem, T: InterpolationTable, const K: usize> ImplicitStep<S>
    for DiscreteLagrangian<S, T, K>
{
    type Factors = S::KktFactors;

    fn mechanics(&self) -> &Mechanics<S> {
        &self.mechanics
    }

    fn h(&self) -> f64 {
        self.h
    }

    #[inline(always)]
    fn inertia_times(&self, difference: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64> {
        if SeparableAction::<S, K>::EXISTS {
            self.separable.inertia_times(difference)
        } else {
            Array::from_fn(|_| NOTHING)
        }
    }

    #[inline(always)]
    fn start_row(&self, start: &StepStart<'_, S>) -> S::PerCoordinate<f64> {
        if SeparableAction::<S, K>::EXISTS {
            let momentum = self.separable.start_momentum(T::IS_STRAIGHT, start.q);
            Array::from_fn(|i| momentum[i] - start.p[i])
        } else {
            Array::from_fn(|i| -start.p[i])
        }
    }

    /// `D₁L_d` without what is folded. The matrix `−D₁D₂L_d` is not symmetric when `L` couples `q` and `v` or forces act (then it holds
    /// `−∂f⁻/∂q₁`, too).
    #[inline(always)]
    fn node_kick(
        &self,
        start: &StepStart<'_, S>,
        difference: &S::PerCoordinate<f64>,
        mut kkt: Option<&mut Kkt<S>>,
    ) -> S::PerCoordinate<f64> {
        if SeparableAction::<S, K>::EXISTS
            && let Some(kkt) = &mut kkt
        {
            self.separable.add_inertia(kkt);
        }
        let mut kick = S::PerCoordinate::<f64>::from_fn(|_| NOTHING);
        self.for_each_node(start.t, start.q, difference, |node, weight, t, x, v| {
            let at = ForcePoint { t, q: x, v, inputs: start.inputs };
            let gradient = if let Some(kkt) = &mut kkt {
                let (mut gradient, hessian) = S::lagrangian_derivatives(&self.mechanics.constants, t, x, v);
                if S::STRUCTURE.forces.exist() {
                    let derivatives = self.mechanics.add_force_with_derivatives(at, &mut gradient.force);
                    self.subtract_force_derivatives(node, weight, &derivatives, kkt);
                }
                self.subtract_d2d1(node, weight, &hessian, kkt);
                gradient
            } else {
                self.gradient(at)
            };
            self.add_d1(node, weight, &gradient, &mut kick);
        });
        kick
    }

    #[inline]
    fn factor(kkt: Kkt<S>) -> Result<FactoredKkt<S>, SingularMatrix> {
        kkt.factor()
    }

    #[inline(always)]
    fn end_momentum(&self, start: &StepStart<'_, S>, solution: &StepSolution<S>) -> S::PerCoordinate<f64> {
        if self.kicks_alike() {
            let gain = self.momentum_gain(start, solution);
            Array::from_fn(|i| start.p[i] + gain[i])
        } else {
            self.arriving_momentum(start.t, start.q, &solution.difference, start.inputs)
        }
    }
}
