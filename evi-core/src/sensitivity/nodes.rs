//! Derivatives of the steps whose action is a sum over nodes of a curve through points.
//!
//! With the points `q_a`, `a = 0 .. A`, of a step and the action `L_d = h Σⱼ wⱼ L(tⱼ, xⱼ, vⱼ)`, `xⱼ = Σ_a X_ja q_a`, `h vⱼ = Σ_a R_ja q_a`,
//! let `P_a = ∂L_d/∂q_a` with the discrete forces. Every such step solves
//!
//! ```text
//! −P_a − p₀ δ_a0 + G_aᵀ Λ_a = 0,  a = 0 .. A−1        φ(t_a, q_a) = 0,  a = 1 .. A        p⁻ = P_A
//! ```
//!
//! With one interval these are the exponential variational integrators, with inner Lobatto points the Galerkin ones. By the implicit function
//! theorem a change of the start moves the points by `−K⁻¹` times what it makes of the left sides, where `K` is the matrix of the step; a gradient goes
//! back through `K⁻ᵀ`. Second derivatives of `L` are symmetric: one evaluation of its gradient on tangent numbers is the product with them in either direction.
//! (Marsden & West, Acta Numerica 10 (2001), sec. 2.2; for adjoints of variational integrators Ober-Blöbaum, Junge, Marsden, ESAIM COCV 17 (2011) 322.)

use super::evaluation::{ConstraintRates, forced_gradient, moving, still};
use super::landing::{Landing, Moved};
use super::parameters::Seeds;
use super::{DerivativeError, StateGradient, StateTangent};
use crate::array::Array;
use crate::linear::constraint_index;
use crate::mechanics::{ForcePoint, Mechanics, State};
use crate::scalar::{Rate, Tangent};
use crate::system::MechanicalSystem;

/// One vector per point after the first.
pub(super) type PerPoint<S, const A: usize> = [<S as MechanicalSystem>::PerCoordinate<f64>; A];
/// One row of the equations, or one unknown, per point after the first: coordinates, then constraints.
pub(super) type Blocks<S, const A: usize> = [<S as MechanicalSystem>::PerUnknown<f64>; A];

/// The action of a step as a sum over nodes.
pub(super) trait NodeAction<S: MechanicalSystem, const A: usize> {
    fn mechanics(&self) -> &Mechanics<S>;

    fn h(&self) -> f64;

    fn n_nodes(&self) -> usize;

    /// `wⱼ`.
    fn weight(&self, node: usize) -> f64;

    /// `tⱼ`.
    fn node_time(&self, t: f64, node: usize) -> f64;

    /// `t_a`.
    fn point_time(&self, t: f64, point: usize) -> f64;

    /// `xⱼ` and `vⱼ`.
    fn node(
        &self,
        q: &S::PerCoordinate<f64>,
        differences: &PerPoint<S, A>,
        node: usize,
    ) -> (S::PerCoordinate<f64>, S::PerCoordinate<f64>);

    /// `X_ja` and `R_ja` of a coordinate.
    fn shares(&self, node: usize, point: usize, coordinate: usize) -> (f64, f64);
}

/// A step that was taken: what its derivative is made of.
pub struct TakenStep<S: MechanicalSystem, const A: usize> {
    pub(super) start: State<S>,
    pub(super) end: State<S>,
    /// `q_a − q₀`, from `a = 1` on.
    pub(super) differences: PerPoint<S, A>,
    /// `Λ_a`, from `a = 0` on.
    pub(super) impulses: [S::PerConstraint<f64>; A],
}

/// Vectors by point, the first one included.
struct Points<S: MechanicalSystem, const A: usize> {
    first: S::PerCoordinate<f64>,
    others: PerPoint<S, A>,
}

impl<S: MechanicalSystem, const A: usize> Points<S, A> {
    fn zero() -> Self {
        Self { first: zero::<S>(), others: core::array::from_fn(|_| zero::<S>()) }
    }

    #[inline]
    fn get(&self, point: usize) -> &S::PerCoordinate<f64> {
        if point == 0 { &self.first } else { &self.others[point - 1] }
    }

    #[inline]
    fn get_mut(&mut self, point: usize) -> &mut S::PerCoordinate<f64> {
        if point == 0 { &mut self.first } else { &mut self.others[point - 1] }
    }
}

fn zero<S: MechanicalSystem>() -> S::PerCoordinate<f64> {
    Array::from_fn(|_| 0.0)
}

/// The derivatives of one step.
pub(super) struct StepDerivative<'a, S: MechanicalSystem, N, const A: usize> {
    action: &'a N,
    step: &'a TakenStep<S, A>,
    landing: Landing<'a, S>,
    /// `N`: what the projection at the end removed.
    removed: S::PerConstraint<f64>,
}

impl<'a, S: MechanicalSystem, N: NodeAction<S, A>, const A: usize> StepDerivative<'a, S, N, A> {
    pub(super) fn new(action: &'a N, step: &'a TakenStep<S, A>) -> Result<Self, DerivativeError> {
        let landing = Landing::new(action.mechanics(), &step.end)?;
        let mut removed = Array::from_fn(|_| 0.0);
        if S::N_CONSTRAINTS > 0 {
            let arriving = momentum(action, &step.start, &step.differences, A);
            removed = landing.impulse(&Array::from_fn(|i| arriving[i] - step.end.p[i]));
        }
        Ok(Self { action, step, landing, removed })
    }

    /// Moves a vector at the start of the step to its end; `solve` overwrites right-hand sides with the solution of `K x = b`.
    pub(super) fn push_forward(&self, tangent: &mut StateTangent<S>, solve: impl FnOnce(&mut Blocks<S, A>)) {
        let mut moved = Points { first: tangent.q.clone(), others: Points::<S, A>::zero().others };
        let rates = self.momentum_rates(tangent, &moved);
        let mut rows: Blocks<S, A> = core::array::from_fn(|a| {
            let own = if a == 0 { 1.0 } else { 0.0 };
            let rate = rates.get(a);
            Array::from_fn(|i| if i < S::N_COORDINATES { rate[i] + own * tangent.p[i] } else { 0.0 })
        });
        if S::N_CONSTRAINTS > 0 {
            self.add_constraint_rows(tangent, &mut rows);
        }
        solve(&mut rows);
        for (moved, row) in moved.others.iter_mut().zip(&rows) {
            *moved = Array::from_fn(|i| row[i]);
        }
        let rates = self.momentum_rates(tangent, &moved);
        let end = &moved.others[A - 1];
        let Moved { v, p } = self.landing.forward(&tangent.constants, &self.removed, end, rates.get(A));
        tangent.q = end.clone();
        (tangent.v, tangent.p) = (v, p);
    }

    /// Adds `−Ġᵀ Λ` and `−φ̇`, which a change of the start and of the constants makes of the left sides.
    fn add_constraint_rows(&self, tangent: &StateTangent<S>, rows: &mut Blocks<S, A>) {
        let TakenStep { start, differences, impulses, .. } = self.step;
        for point in 0..=A {
            if point > 0 && !tangent.parameters_move {
                break;
            }
            let t = Tangent::still(self.action.point_time(start.t, point));
            let q = if point == 0 {
                moving::<S>(&start.q, &tangent.q)
            } else {
                Array::from_fn(|i| Tangent::still(start.q[i] + differences[point - 1][i]))
            };
            let rates = ConstraintRates::<S>::new(&tangent.constants, t, &q);
            if point < A {
                let mut pull = zero::<S>();
                rates.add_pull(-1.0, &impulses[point], &mut pull);
                for i in 0..S::N_COORDINATES {
                    rows[point][i] += pull[i];
                }
            }
            if point > 0 {
                for c in 0..S::N_CONSTRAINTS {
                    rows[point - 1][constraint_index::<S>(c)] -= rates.residual[c];
                }
            }
        }
    }

    /// The rates of `P_a` where the points and the constants move.
    fn momentum_rates(&self, tangent: &StateTangent<S>, moved: &Points<S, A>) -> Points<S, A> {
        let (action, h) = (self.action, self.action.h());
        let inputs = tangent.moving_inputs(&self.step.start.inputs);
        let mut sum = Points::<S, A>::zero();
        for node in 0..action.n_nodes() {
            let (mut x_rate, mut v_rate) = (zero::<S>(), zero::<S>());
            for point in 0..=A {
                let moved = moved.get(point);
                for i in 0..S::N_COORDINATES {
                    let (position, rate) = action.shares(node, point, i);
                    x_rate[i] += position * moved[i];
                    v_rate[i] += rate / h * moved[i];
                }
            }
            let (x, v) = action.node(&self.step.start.q, &self.step.differences, node);
            let t = Tangent::still(action.node_time(self.step.start.t, node));
            let (x, v) = (moving::<S>(&x, &x_rate), moving::<S>(&v, &v_rate));
            let gradient = forced_gradient::<S, f64>(&tangent.constants, t, &x, &v, &inputs);
            let weight = action.weight(node);
            for point in 0..=A {
                let sum = sum.get_mut(point);
                for i in 0..S::N_COORDINATES {
                    let (position, rate) = action.shares(node, point, i);
                    sum[i] += weight * (h * position * gradient.force[i].rate + rate * gradient.momentum[i].rate);
                }
            }
        }
        sum
    }

    /// Moves a gradient at the end of the step to its start; `solve` overwrites right-hand sides with the solution of `Kᵀ x = b`.
    pub(super) fn pull_back(
        &self,
        seeds: &Seeds<S>,
        gradient: &mut StateGradient<S>,
        solve: impl FnOnce(&mut Blocks<S, A>),
    ) {
        let TakenStep { start, impulses, .. } = self.step;
        let by_arriving = self.landing.backward(seeds, &self.removed, gradient);
        let mut along = Points::<S, A>::zero();
        along.others[A - 1] = by_arriving;
        let mut by_points = self.products(seeds, &along);
        for i in 0..S::N_COORDINATES {
            by_points.others[A - 1][i] += gradient.q[i];
        }
        let mut rows: Blocks<S, A> = core::array::from_fn(|a| {
            let by_point = &by_points.others[a];
            Array::from_fn(|i| if i < S::N_COORDINATES { by_point[i] } else { 0.0 })
        });
        solve(&mut rows);
        let mut of_rows = Points::<S, A>::zero();
        for (a, row) in rows.iter().enumerate() {
            *of_rows.get_mut(a) = Array::from_fn(|i| row[i]);
        }
        let by_start = self.products(seeds, &of_rows).first;
        gradient.q = Array::from_fn(|i| by_points.first[i] + by_start[i]);
        gradient.p = of_rows.first.clone();
        gradient.v = zero::<S>();
        if S::N_CONSTRAINTS > 0 {
            let t = Tangent::still(start.t);
            let rates = ConstraintRates::<S>::new(&seeds.still, t, &moving::<S>(&start.q, &of_rows.first));
            rates.add_pull(-1.0, &impulses[0], &mut gradient.q);
            self.subtract_constraint_parameters(seeds, &rows, &mut gradient.parameters);
        }
        for a in 0..A {
            *along.get_mut(a) = of_rows.get(a).clone();
        }
        self.add_action_parameters(seeds, &along, gradient);
    }

    /// How the scalar `Σ_a m_a · P_a` of vectors `m` changes with every point.
    fn products(&self, seeds: &Seeds<S>, along: &Points<S, A>) -> Points<S, A> {
        let (action, mechanics, h) = (self.action, self.action.mechanics(), self.action.h());
        let start = &self.step.start;
        let mut sum = Points::<S, A>::zero();
        for node in 0..action.n_nodes() {
            let (t, x, v) = self.node(node);
            let (of_force, of_momentum) = self.weights(node, along);
            let moving = (moving::<S>(&x, &of_force), moving::<S>(&v, &of_momentum));
            let rates = S::lagrangian_gradient(&seeds.still, Tangent::still(t), &moving.0, &moving.1);
            let mut by_x = S::PerCoordinate::<f64>::from_fn(|i| rates.force[i].rate);
            let mut by_v = S::PerCoordinate::<f64>::from_fn(|i| rates.momentum[i].rate);
            if S::STRUCTURE.forces.exist() {
                let at = ForcePoint { t, q: &x, v: &v, inputs: &start.inputs };
                let derivatives = mechanics.add_force_with_derivatives(at, &mut zero::<S>());
                derivatives.for_each_by_q(|row, col, value| by_x[col] += of_force[row] * value);
                derivatives.for_each_by_v(|row, col, value| by_v[col] += of_force[row] * value);
            }
            for point in 0..=A {
                let sum = sum.get_mut(point);
                for i in 0..S::N_COORDINATES {
                    let (position, rate) = action.shares(node, point, i);
                    sum[i] += position * by_x[i] + rate / h * by_v[i];
                }
            }
        }
        sum
    }

    /// `tⱼ`, `xⱼ`, `vⱼ`.
    fn node(&self, node: usize) -> (f64, S::PerCoordinate<f64>, S::PerCoordinate<f64>) {
        let TakenStep { start, differences, .. } = self.step;
        let (x, v) = self.action.node(&start.q, differences, node);
        (self.action.node_time(start.t, node), x, v)
    }

    /// What `Σ_a m_a · P_a` makes of the force and of the momentum at a node: `wⱼ h Σ_a X_ja m_a` and `wⱼ Σ_a R_ja m_a`.
    fn weights(&self, node: usize, along: &Points<S, A>) -> (S::PerCoordinate<f64>, S::PerCoordinate<f64>) {
        let (weight, h) = (self.action.weight(node), self.action.h());
        let (mut of_force, mut of_momentum) = (zero::<S>(), zero::<S>());
        for point in 0..=A {
            let along = along.get(point);
            for i in 0..S::N_COORDINATES {
                let (position, rate) = self.action.shares(node, point, i);
                of_force[i] += weight * h * position * along[i];
                of_momentum[i] += weight * rate * along[i];
            }
        }
        (of_force, of_momentum)
    }

    /// Adds the derivatives of `Σ_a m_a · P_a` by the parameters and the inputs.
    fn add_action_parameters(&self, seeds: &Seeds<S>, along: &Points<S, A>, gradient: &mut StateGradient<S>) {
        if seeds.n_parameters == 0 && S::N_INPUTS == 0 {
            return;
        }
        let inputs = &self.step.start.inputs;
        for node in 0..self.action.n_nodes() {
            let (t, x, v) = self.node(node);
            let (of_force, of_momentum) = self.weights(node, along);
            seeds.add_parameter_rates(&mut gradient.parameters, |constants| {
                let (x, v) = (still::<S, _>(&x), still::<S, _>(&v));
                let inputs = Array::from_fn(|k| Tangent::still(inputs[k]));
                let rates = forced_gradient::<S, _>(constants, Tangent::still(t), &x, &v, &inputs);
                (0..S::N_COORDINATES).fold(Rate::ZERO, |sum, i| {
                    sum + rates.force[i].rate.times(of_force[i]) + rates.momentum[i].rate.times(of_momentum[i])
                })
            });
            if S::STRUCTURE.forces.on_inputs {
                seeds.add_input_rates(inputs, &mut gradient.inputs, |constants, inputs| {
                    let (x, v) = (still::<S, _>(&x), still::<S, _>(&v));
                    let force = S::forces(constants, Tangent::still(t), &x, &v, inputs);
                    let forced = S::STRUCTURE.forces.forced.iter();
                    forced.fold(Rate::ZERO, |sum, &i| sum + force[i].rate.times(of_force[i]))
                });
            }
        }
    }

    /// Subtracts the derivatives of `Σ_a μ_a · G_aᵀ Λ_a + ν_a · φ(q_a)` by the parameters.
    fn subtract_constraint_parameters(&self, seeds: &Seeds<S>, rows: &Blocks<S, A>, gradient: &mut [f64]) {
        let TakenStep { start, differences, impulses, .. } = self.step;
        for point in 0..=A {
            let t = Tangent::still(self.action.point_time(start.t, point));
            let moved = |i: usize| if point == 0 { 0.0 } else { differences[point - 1][i] };
            seeds.add_parameter_rates(gradient, |constants| {
                let q = Array::from_fn(|i| Tangent::still(start.q[i] + moved(i)));
                let rates = ConstraintRates::<S, _>::new(constants, t, &q);
                let mut sum = Rate::ZERO;
                if point < A {
                    sum = sum - rates.form(&impulses[point], &Array::from_fn(|i| rows[point][i]));
                }
                if point > 0 {
                    for c in 0..S::N_CONSTRAINTS {
                        sum = sum - rates.residual[c].times(rows[point - 1][constraint_index::<S>(c)]);
                    }
                }
                sum
            });
        }
    }
}

/// `P_a`.
pub(super) fn momentum<S: MechanicalSystem, const A: usize>(
    action: &impl NodeAction<S, A>,
    start: &State<S>,
    differences: &PerPoint<S, A>,
    point: usize,
) -> S::PerCoordinate<f64> {
    let (mechanics, h) = (action.mechanics(), action.h());
    let mut sum = zero::<S>();
    for node in 0..action.n_nodes() {
        let (x, v) = action.node(&start.q, differences, node);
        let t = action.node_time(start.t, node);
        let mut gradient = S::lagrangian_gradient(&mechanics.constants, t, &x, &v);
        mechanics.add_force(ForcePoint { t, q: &x, v: &v, inputs: &start.inputs }, &mut gradient.force);
        for i in 0..S::N_COORDINATES {
            let (position, rate) = action.shares(node, point, i);
            sum[i] += action.weight(node) * (h * position * gradient.force[i] + rate * gradient.momentum[i]);
        }
    }
    sum
}
