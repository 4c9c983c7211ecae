//! The equations of a step whose quadratic part is integrated exactly, on any nodes.
//!
//! ```text
//! L_d = exact action of ½ vᵀMv − ½ (q − q_ref)ᵀΩ(q − q_ref)  −  h Σ wⱼ U(tⱼ, xⱼ)
//! x(τ) = q_ref + C(σW h)/C(½W h) (s − q_ref) + ½ S(σW h)/S(½W h) d        C = cos, S = sin, W² = M⁻¹ Ω
//! ```
//!
//! The coefficients of [`crate::scheme::NodeCoefficients`], with matrices in the place of numbers. The exact action is that of a kick,
//! a drift and a kick ([`super::ImpulseStep`] has the formulas).

use super::coordinate_matrix::{add_transposed, times};
use super::{ImplicitStep, Mechanics, QuadraticPart, Rows, StepModes, StepSolution, StepStart};
use crate::array::Array;
use crate::linear::{FactoredKkt, Kkt, SingularMatrix};
use crate::scheme::{Mollifier, Quadrature};
use crate::system::MechanicalSystem;

/// The discrete Lagrangian of a scene with a matrix frequency for one step size.
pub(crate) struct MatrixAction<S: MechanicalSystem, const K: usize> {
    pub(crate) mechanics: Mechanics<S>,
    part: QuadraticPart<S>,
    h: f64,
    quadrature: Quadrature<K>,
    /// `T`.
    kick: Rows<S>,
    /// `D⁻¹`.
    inverse_drift: Rows<S>,
    nodes: [Node<S>; K],
    /// `∂L/∂v` at `v = 0`.
    momentum_at_rest: S::PerCoordinate<f64>,
}

/// How the position at a node depends on the ends of a step.
struct Node<S: MechanicalSystem> {
    /// Position per half-sum.
    even: Rows<S>,
    /// Position per difference.
    odd: Rows<S>,
}

/// What the rest of the potential makes of a step.
struct Impulses<S: MechanicalSystem> {
    /// `h Σ wⱼ g₁ⱼᵀ U'(xⱼ)`.
    start: S::PerCoordinate<f64>,
    /// `h Σ wⱼ g₂ⱼᵀ U'(xⱼ)`.
    end: S::PerCoordinate<f64>,
}

impl<S: MechanicalSystem, const K: usize> MatrixAction<S, K> {
    pub(crate) fn new(
        mechanics: Mechanics<S>,
        part: QuadraticPart<S>,
        StepModes { modes, flows }: &StepModes<S>,
        mollifier: Option<Mollifier>,
        quadrature: Quadrature<K>,
        h: f64,
    ) -> Self {
        let filter = |k: usize| mollifier.map_or(1.0, |filter| filter.filter(flows[k].squared_phase()));
        let nodes = quadrature.offsets().map(|offset| Node {
            even: modes.function(|k| filter(k) * flows[k].coefficients(offset).even),
            odd: modes.function(|k| filter(k) * flows[k].coefficients(offset).odd),
        });
        let at_rest = Array::from_fn(|_| 0.0);
        Self {
            kick: modes.to_momenta(|k| flows[k].kick),
            inverse_drift: modes.to_momenta(|k| 1.0 / flows[k].drift),
            momentum_at_rest: mechanics.momentum_at(0.0, &part.reference, &at_rest),
            mechanics,
            part,
            h,
            quadrature,
            nodes,
        }
    }

    /// Calls `see` for the numbers that tell this action from another of its type.
    pub(crate) fn for_each_number(&self, mut see: impl FnMut(f64)) {
        self.part.for_each_number(&mut see);
        for node in 0..K {
            see(self.quadrature.offsets()[node]);
            see(self.quadrature.weights()[node]);
            for i in 0..S::N_COORDINATES {
                for j in 0..S::N_COORDINATES {
                    see(self.nodes[node].even[i][j]);
                    see(self.nodes[node].odd[i][j]);
                }
            }
        }
    }

    #[inline]
    fn impulses(
        &self,
        start: &StepStart<'_, S>,
        difference: &S::PerCoordinate<f64>,
        mut kkt: Option<&mut Kkt<S>>,
    ) -> Impulses<S> {
        let half_sum = Array::from_fn(|i| start.q[i] + 0.5 * difference[i]);
        let half_sum = self.part.displacement(&half_sum);
        let mut sum = Impulses::<S> { start: Array::from_fn(|_| 0.0), end: Array::from_fn(|_| 0.0) };
        for (j, node) in self.nodes.iter().enumerate() {
            let (even, odd) = (times::<S>(&node.even, &half_sum), times::<S>(&node.odd, difference));
            let x = Array::from_fn(|i| even[i] + odd[i]);
            let t = start.t + (0.5 + self.quadrature.offsets()[j]) * self.h;
            let weight = self.h * self.quadrature.weights()[j];
            let gradient = self.part.remaining_gradient(&self.mechanics, t, &x);
            let (mut even, mut odd) = (Array::from_fn(|_| 0.0), Array::from_fn(|_| 0.0));
            add_transposed::<S>(&node.even, &gradient, &mut even);
            add_transposed::<S>(&node.odd, &gradient, &mut odd);
            for i in 0..S::N_COORDINATES {
                sum.start[i] += weight * (0.5 * even[i] - odd[i]);
                sum.end[i] += weight * (0.5 * even[i] + odd[i]);
            }
            if let Some(kkt) = &mut kkt {
                self.add_hessian(node, weight, &self.part.remaining_hessian(&self.mechanics, t, &x), kkt);
            }
        }
        sum
    }

    /// `∂L_d/∂q₀` and `∂L_d/∂q₁`.
    #[cfg(feature = "std")]
    pub(crate) fn end_momenta(
        &self,
        start: &StepStart<'_, S>,
        difference: &S::PerCoordinate<f64>,
    ) -> [S::PerCoordinate<f64>; 2] {
        let inertial = self.inertia_times(difference);
        let at_nodes = self.impulses(start, difference, None);
        let end = Array::from_fn(|i| start.q[i] + difference[i]);
        let at_start = times::<S>(&self.kick, &self.part.displacement(start.q));
        let at_end = times::<S>(&self.kick, &self.part.displacement(&end));
        let rest = &self.momentum_at_rest;
        [
            Array::from_fn(|i| at_start[i] - at_nodes.start[i] - inertial[i] - rest[i]),
            Array::from_fn(|i| at_end[i] - at_nodes.end[i] + inertial[i] + rest[i]),
        ]
    }

    /// The product of the second derivative of `L_d` in `(q₀, q₁)` at the step with a vector.
    #[cfg(feature = "std")]
    pub(crate) fn second_derivative_product(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
        difference: &S::PerCoordinate<f64>,
        [start, end]: [&S::PerCoordinate<f64>; 2],
    ) -> [S::PerCoordinate<f64>; 2] {
        let moved = S::PerCoordinate::<f64>::from_fn(|i| end[i] - start[i]);
        let inertial = times::<S>(&self.inverse_drift, &moved);
        let (at_start, at_end) = (times::<S>(&self.kick, start), times::<S>(&self.kick, end));
        let mut by_start = S::PerCoordinate::<f64>::from_fn(|i| at_start[i] - inertial[i]);
        let mut by_end = S::PerCoordinate::<f64>::from_fn(|i| at_end[i] + inertial[i]);
        let half_sum = Array::from_fn(|i| q[i] + 0.5 * difference[i]);
        let half_sum = self.part.displacement(&half_sum);
        let mean = Array::from_fn(|i| 0.5 * (start[i] + end[i]));
        for (j, node) in self.nodes.iter().enumerate() {
            let at = |half_sum: &_, difference: &_| -> S::PerCoordinate<f64> {
                let (even, odd) = (times::<S>(&node.even, half_sum), times::<S>(&node.odd, difference));
                Array::from_fn(|i| even[i] + odd[i])
            };
            let (x, rate) = (at(&half_sum, difference), at(&mean, &moved));
            let x = Array::from_fn(|i| self.part.reference[i] + x[i]);
            let t = t + (0.5 + self.quadrature.offsets()[j]) * self.h;
            let whole = self.mechanics.potential_hessian_product(t, &x, &self.part.multipliers, &rate);
            let linear = times::<S>(&self.part.stiffness, &rate);
            let rest = Array::from_fn(|i| whole[i] - linear[i]);
            let (mut even, mut odd) = (Array::from_fn(|_| 0.0), Array::from_fn(|_| 0.0));
            add_transposed::<S>(&node.even, &rest, &mut even);
            add_transposed::<S>(&node.odd, &rest, &mut odd);
            let weight = self.h * self.quadrature.weights()[j];
            for i in 0..S::N_COORDINATES {
                by_start[i] -= weight * (0.5 * even[i] - odd[i]);
                by_end[i] -= weight * (0.5 * even[i] + odd[i]);
            }
        }
        [by_start, by_end]
    }

    /// Whether the matrix of the step is the derivative of its equations: not where it holds a curvature of constraints that changes between the nodes.
    #[cfg(feature = "std")]
    pub(crate) fn has_exact_matrix(&self) -> bool {
        // Equality to the exact zeros of a part without multipliers.
        S::STRUCTURE.has_quadratic_constraints() || self.part.multipliers.as_ref().iter().all(|x| *x == 0.0)
    }

    /// Adds `weight g₁ᵀ U'' g₂`, `g₁ = ½ even − odd`, `g₂ = ½ even + odd`.
    fn add_hessian(&self, node: &Node<S>, weight: f64, hessian: &Rows<S>, kkt: &mut Kkt<S>) {
        let n = S::N_COORDINATES;
        let end = |row: usize, col: usize| 0.5 * node.even[row][col] + node.odd[row][col];
        let start = |row: usize, col: usize| 0.5 * node.even[row][col] - node.odd[row][col];
        let image: Rows<S> =
            Array::from_fn(|row| Array::from_fn(|col| (0..n).map(|k| hessian[row][k] * end(k, col)).sum()));
        for row in 0..n {
            for col in 0..n {
                let value: f64 = (0..n).map(|k| start(k, row) * image[k][col]).sum();
                kkt.add_block(row, col, weight * value);
            }
        }
    }
}

impl<S: MechanicalSystem, const K: usize> ImplicitStep<S> for MatrixAction<S, K> {
    type Factors = S::DenseKktFactors;

    fn mechanics(&self) -> &Mechanics<S> {
        &self.mechanics
    }

    fn h(&self) -> f64 {
        self.h
    }

    /// `D⁻¹ d`.
    #[inline]
    fn inertia_times(&self, difference: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64> {
        times::<S>(&self.inverse_drift, difference)
    }

    /// `−p½`, but for the nodes.
    #[inline]
    fn start_row(&self, start: &StepStart<'_, S>) -> S::PerCoordinate<f64> {
        let displacement = self.part.displacement(start.q);
        let linear = times::<S>(&self.kick, &displacement);
        Array::from_fn(|i| -(start.p[i] - self.momentum_at_rest[i] + linear[i]))
    }

    #[inline]
    fn node_kick(
        &self,
        start: &StepStart<'_, S>,
        difference: &S::PerCoordinate<f64>,
        mut kkt: Option<&mut Kkt<S>>,
    ) -> S::PerCoordinate<f64> {
        if let Some(kkt) = &mut kkt {
            for row in 0..S::N_COORDINATES {
                for col in 0..S::N_COORDINATES {
                    kkt.add_block(row, col, self.inverse_drift[row][col]);
                }
            }
        }
        let Impulses { start, .. } = self.impulses(start, difference, kkt);
        Array::from_fn(|i| -start[i])
    }

    /// The modes of the quadratic part couple what the scene does not.
    fn factor(kkt: Kkt<S>) -> Result<FactoredKkt<S, S::DenseKktFactors>, SingularMatrix> {
        kkt.factor_densely()
    }

    fn end_momentum(
        &self,
        start: &StepStart<'_, S>,
        StepSolution { difference, impulse, .. }: &StepSolution<S>,
    ) -> S::PerCoordinate<f64> {
        // From p₀ on, not from d/h: no difference of two large momenta.
        let fixed = self.start_row(start);
        let at_nodes = self.impulses(start, difference, None);
        let mut p = S::PerCoordinate::<f64>::from_fn(|i| -fixed[i] - at_nodes.start[i]);
        self.mechanics.subtract_constraint_force(&start.jacobian, impulse, &mut p);
        let end = Array::from_fn(|i| start.q[i] + difference[i]);
        let displacement = self.part.displacement(&end);
        let linear = times::<S>(&self.kick, &displacement);
        Array::from_fn(|i| p[i] + self.momentum_at_rest[i] + (linear[i] - at_nodes.end[i]))
    }
}
