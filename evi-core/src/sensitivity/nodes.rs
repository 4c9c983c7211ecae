//! Actions that are sums over the nodes of a curve through the points of a step.
//!
//! `L_d = h Σⱼ wⱼ L(tⱼ, xⱼ, vⱼ)` with `xⱼ = Σ_a X_ja q_a`, `h vⱼ = Σ_a R_ja q_a`. Second derivatives of `L` are symmetric: one evaluation of its gradient on
//! tangent numbers is their product with a vector, in either direction.

use super::evaluation::{Point, along};
use super::parameters::Seeds;
use super::points::{PerPoint, PointAction, Points, TakenStep, zero};
use super::{StateGradient, StateTangent};
use crate::mechanics::{ForcePoint, Mechanics, State};
use crate::system::MechanicalSystem;

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

/// An action on nodes, as one of points.
pub(super) struct OnNodes<'a, N>(pub(super) &'a N);

impl<S: MechanicalSystem, N: NodeAction<S, A>, const A: usize> PointAction<S, A> for OnNodes<'_, N> {
    fn scene(&self) -> &Mechanics<S> {
        self.0.mechanics()
    }

    fn point_time(&self, t: f64, point: usize) -> f64 {
        self.0.point_time(t, point)
    }

    fn end_momenta(&self, start: &State<S>, differences: &PerPoint<S, A>) -> [S::PerCoordinate<f64>; 2] {
        let (mechanics, h) = (self.0.mechanics(), self.0.h());
        let mut sums = [zero::<S>(), zero::<S>()];
        for node in 0..self.0.n_nodes() {
            let (x, v) = self.0.node(&start.q, differences, node);
            let t = self.0.node_time(start.t, node);
            let mut gradient = S::lagrangian_gradient(&mechanics.constants, t, &x, &v);
            mechanics.add_force(ForcePoint { t, q: &x, v: &v, inputs: &start.inputs }, &mut gradient.force);
            let weight = self.0.weight(node);
            for (sum, point) in sums.iter_mut().zip([0, A]) {
                for i in 0..S::N_COORDINATES {
                    let (position, rate) = self.0.shares(node, point, i);
                    sum[i] += weight * (h * position * gradient.force[i] + rate * gradient.momentum[i]);
                }
            }
        }
        sums
    }

    fn momentum_rates(
        &self,
        step: &TakenStep<S, A>,
        tangent: &StateTangent<S>,
        moved: &Points<S, A>,
    ) -> Points<S, A> {
        let (action, h) = (self.0, self.0.h());
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
            let (t, x, v) = node_of(self.0, step, node);
            let point = Point { t, q: &x, v: &v, inputs: &step.start.inputs };
            let rates = along::<S>(tangent, &point, &x_rate, &v_rate);
            let weight = action.weight(node);
            for point in 0..=A {
                let sum = sum.get_mut(point);
                for i in 0..S::N_COORDINATES {
                    let (position, rate) = action.shares(node, point, i);
                    sum[i] += weight * (h * position * rates.force[i] + rate * rates.momentum[i]);
                }
            }
        }
        sum
    }

    fn products(&self, step: &TakenStep<S, A>, seeds: &Seeds<S>, along: &Points<S, A>) -> Points<S, A> {
        let (action, mechanics, h) = (self.0, self.0.mechanics(), self.0.h());
        let start = &step.start;
        let mut sum = Points::<S, A>::zero();
        for node in 0..action.n_nodes() {
            let (t, x, v) = node_of(self.0, step, node);
            let (of_force, of_momentum) = weights(self.0, node, along);
            let point = Point { t, q: &x, v: &v, inputs: &start.inputs };
            let by = point.product(seeds, mechanics, &of_force, &of_momentum);
            for point in 0..=A {
                let sum = sum.get_mut(point);
                for i in 0..S::N_COORDINATES {
                    let (position, rate) = action.shares(node, point, i);
                    sum[i] += position * by.force[i] + rate / h * by.momentum[i];
                }
            }
        }
        sum
    }

    fn add_parameters(
        &self,
        step: &TakenStep<S, A>,
        seeds: &Seeds<S>,
        along: &Points<S, A>,
        gradient: &mut StateGradient<S>,
    ) {
        if seeds.n_parameters == 0 && S::N_INPUTS == 0 {
            return;
        }
        let inputs = &step.start.inputs;
        for node in 0..self.0.n_nodes() {
            let (t, x, v) = node_of(self.0, step, node);
            let (of_force, of_momentum) = weights(self.0, node, along);
            let point = Point { t, q: &x, v: &v, inputs };
            point.add_parameters(seeds, &of_force, &of_momentum, gradient);
        }
    }
}

/// `tⱼ`, `xⱼ`, `vⱼ`.
fn node_of<S: MechanicalSystem, const A: usize>(
    action: &impl NodeAction<S, A>,
    TakenStep { start, differences, .. }: &TakenStep<S, A>,
    node: usize,
) -> (f64, S::PerCoordinate<f64>, S::PerCoordinate<f64>) {
    let (x, v) = action.node(&start.q, differences, node);
    (action.node_time(start.t, node), x, v)
}

/// What `Σ_a m_a · P_a` makes of the force and of the momentum at a node: `wⱼ h Σ_a X_ja m_a` and `wⱼ Σ_a R_ja m_a`.
fn weights<S: MechanicalSystem, const A: usize>(
    action: &impl NodeAction<S, A>,
    node: usize,
    along: &Points<S, A>,
) -> (S::PerCoordinate<f64>, S::PerCoordinate<f64>) {
    let (weight, h) = (action.weight(node), action.h());
    let (mut of_force, mut of_momentum) = (zero::<S>(), zero::<S>());
    for point in 0..=A {
        let along = along.get(point);
        for i in 0..S::N_COORDINATES {
            let (position, rate) = action.shares(node, point, i);
            of_force[i] += weight * h * position * along[i];
            of_momentum[i] += weight * rate * along[i];
        }
    }
    (of_force, of_momentum)
}
