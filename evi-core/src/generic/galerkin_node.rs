//! One node of a Galerkin step on the generic path: what it adds to the equations of all points and to the momentum at the end.

use nalgebra::DMatrix;

use super::GenericSystem;
use super::derivatives::{Point, Seed};
use super::galerkin::Curves;
use super::galerkin_step::Points;
use super::state::GenericState;
use super::workspace::Workspace;

/// Position and velocity at a node, with buffers for what is evaluated there.
pub(super) struct Node {
    pub(super) q: Vec<f64>,
    pub(super) v: Vec<f64>,
    /// `∂L/∂v`.
    momentum: Vec<f64>,
    /// `∂L/∂q + f`.
    force: Vec<f64>,
    /// First derivatives that come with second ones and are known already.
    repeated: Vec<f64>,
    momentum_by_q: DMatrix<f64>,
    momentum_by_v: DMatrix<f64>,
    force_by_q: DMatrix<f64>,
    force_by_v: DMatrix<f64>,
    /// `φ`.
    constraints: Vec<f64>,
    /// `G`.
    jacobian: DMatrix<f64>,
    /// `Σ Λ_c ∂²φ_c/∂q²`.
    curvature: DMatrix<f64>,
    impulse: Vec<f64>,
    /// Every coordinate alone, and every velocity alone.
    positions: Vec<Seed>,
    velocities: Vec<Seed>,
}

/// The equations of all points: row block `a` belongs to point `a`, column block `b` to point `b + 1` and impulse `b`.
pub(super) struct Blocks<'a> {
    pub(super) residual: &'a mut [f64],
    /// By columns.
    pub(super) entries: &'a mut [f64],
    /// Rows of a block: coordinates, then constraints.
    pub(super) block: usize,
}

impl Blocks<'_> {
    fn add(&mut self, (a, row): (usize, usize), (b, col): (usize, usize), value: f64) {
        self.entries[(b * self.block + col) * self.residual.len() + a * self.block + row] += value;
    }
}

impl Node {
    pub(super) fn new(n: usize, m: usize) -> Self {
        let (numbers, matrix) = (|| vec![0.0; n], || DMatrix::zeros(n, n));
        Self {
            q: numbers(),
            v: numbers(),
            momentum: numbers(),
            force: numbers(),
            repeated: numbers(),
            momentum_by_q: matrix(),
            momentum_by_v: matrix(),
            force_by_q: matrix(),
            force_by_v: matrix(),
            constraints: vec![0.0; m],
            jacobian: DMatrix::zeros(m, n),
            curvature: matrix(),
            impulse: vec![0.0; m],
            positions: vec![Seed::POSITION; n],
            velocities: vec![Seed::VELOCITY; n],
        }
    }

    /// Overwrites position and velocity with those of the curve through `points` at a node.
    pub(super) fn move_to(&mut self, node: usize, curves: &Curves, points: &Points, state: &GenericState) {
        for (i, rates) in curves.rates.iter().enumerate() {
            let differences = points.differences.row(i);
            self.q[i] = state.q[i] + if node == 0 { 0.0 } else { differences[node - 1] };
            let mut rate = rates.start[node] * state.q[i];
            for (a, difference) in differences.iter().enumerate() {
                rate += rates.per_point[(node, a + 1)] * difference;
            }
            self.v[i] = rate / curves.h;
        }
    }

    /// Subtracts the node's part of `h ∂L_d/∂q_a` and of its derivative by `q_b`, forces included: of the rows of all points
    /// `R_ja bⱼ h ∂L/∂v`, of its own `bⱼ h² (∂L/∂q + f)`.
    pub(super) fn add_lagrangian<S: GenericSystem>(
        &mut self,
        node: usize,
        curves: &Curves,
        work: &mut Workspace<S>,
        state: &GenericState,
        equations: &mut Blocks<'_>,
    ) {
        let (n, h, weight, intervals) = (self.q.len(), curves.h, curves.weights[node], curves.intervals());
        let derivatives = &mut work.derivatives;
        let Self { momentum, force, repeated, positions, velocities, .. } = self;
        let at = Point { t: state.t + curves.nodes[node] * h, q: &self.q, v: &self.v };
        momentum.fill(0.0);
        force.fill(0.0);
        for matrix in
            [&mut self.momentum_by_q, &mut self.momentum_by_v, &mut self.force_by_q, &mut self.force_by_v]
        {
            matrix.fill(0.0);
        }
        derivatives.add_mass(at, momentum, &mut self.momentum_by_v);
        derivatives.add_mixed(at, (velocities, positions), 1.0, repeated, &mut self.momentum_by_q);
        // The end point has no row, and the start no column.
        if node < intervals {
            if node > 0 {
                derivatives.add_mixed(at, (positions, positions), 1.0, force, &mut self.force_by_q);
            } else {
                derivatives.add_force(at, force);
            }
            self.momentum_by_q.transpose_to(&mut self.force_by_v);
            let inputs = &state.inputs;
            derivatives.add_virtual_work_with_derivatives(
                at,
                inputs,
                (positions, positions),
                1.0,
                force,
                &mut self.force_by_q,
            );
            derivatives.add_virtual_work_with_derivatives(
                at,
                inputs,
                (positions, velocities),
                1.0,
                repeated,
                &mut self.force_by_v,
            );
        }
        let rate = |i: usize, a: usize| curves.rates[i].per_point[(node, a)];
        for i in 0..n {
            for a in 0..intervals {
                equations.residual[a * equations.block + i] -= h * weight * rate(i, a) * self.momentum[i];
            }
            if node < intervals {
                equations.residual[node * equations.block + i] -= h * h * weight * self.force[i];
            }
        }
        for j in 0..n {
            for i in 0..n {
                if node > 0 {
                    let value = weight * h * self.momentum_by_q[(i, j)];
                    for a in 0..intervals {
                        equations.add((a, i), (node - 1, j), -rate(i, a) * value);
                    }
                }
                if 0 < node && node < intervals {
                    equations.add((node, i), (node - 1, j), -weight * h * h * self.force_by_q[(i, j)]);
                }
                for b in 0..intervals {
                    let along = weight * rate(j, b + 1);
                    let value = along * self.momentum_by_v[(i, j)];
                    for a in 0..intervals {
                        equations.add((a, i), (b, j), -rate(i, a) * value);
                    }
                    if node < intervals {
                        equations.add((node, i), (b, j), -along * h * self.force_by_v[(i, j)]);
                    }
                }
            }
        }
    }

    /// Adds `Gᵀ Λ` to the rows of the node and `φ` to the equations of its point, with their derivatives.
    pub(super) fn add_constraints<S: GenericSystem>(
        &mut self,
        node: usize,
        curves: &Curves,
        points: &Points,
        work: &mut Workspace<S>,
        state: &GenericState,
        equations: &mut Blocks<'_>,
    ) {
        let (n, m, intervals) = (self.q.len(), self.constraints.len(), curves.intervals());
        if m == 0 {
            return;
        }
        let t = state.t + curves.nodes[node] * curves.h;
        let Self { q, constraints, jacobian, curvature, impulse, .. } = self;
        work.derivatives.constraints(t, q, constraints, jacobian);
        for c in 0..m {
            if node > 0 {
                equations.residual[(node - 1) * equations.block + n + c] = constraints[c];
            }
            for i in 0..n {
                if node > 0 {
                    equations.add((node - 1, n + c), (node - 1, i), jacobian[(c, i)]);
                }
                if node < intervals {
                    equations.residual[node * equations.block + i] +=
                        jacobian[(c, i)] * points.impulses[(c, node)];
                    equations.add((node, i), (node, n + c), jacobian[(c, i)]);
                }
            }
        }
        if 0 < node && node < intervals {
            impulse.copy_from_slice(points.impulses.column(node).as_slice());
            curvature.fill(0.0);
            work.derivatives.add_constraint_hessian(t, q, impulse, curvature);
            for j in 0..n {
                for i in 0..n {
                    equations.add((node, i), (node - 1, j), curvature[(i, j)]);
                }
            }
        }
    }

    /// Adds the node's part of `p⁻ − p₀` to `momentum`, from the balance of momentum:
    /// `bⱼ (h (∂L/∂q + f) + rⱼ ∂L/∂v) − Gᵀ Λ / h`, `rⱼ` the rate of constants.
    pub(super) fn add_momentum_gain<S: GenericSystem>(
        &mut self,
        node: usize,
        curves: &Curves,
        points: &Points,
        work: &mut Workspace<S>,
        state: &GenericState,
        momentum: &mut [f64],
    ) {
        let (h, weight) = (curves.h, curves.weights[node]);
        self.move_to(node, curves, points, state);
        let derivatives = &mut work.derivatives;
        let at = Point { t: state.t + curves.nodes[node] * h, q: &self.q, v: &self.v };
        self.force.fill(0.0);
        self.momentum.fill(0.0);
        derivatives.add_force(at, &mut self.force);
        derivatives.add_applied_force(at, &state.inputs, &mut self.force);
        derivatives.add_momentum(at, &mut self.momentum);
        for (i, rates) in curves.rates.iter().enumerate() {
            momentum[i] += weight * (h * self.force[i] + rates.start[node] * self.momentum[i]);
        }
        if node < curves.intervals() {
            derivatives.constraints(at.t, at.q, &mut self.constraints, &mut self.jacobian);
            for (c, impulse) in points.impulses.column(node).iter().enumerate() {
                for i in 0..momentum.len() {
                    momentum[i] -= self.jacobian[(c, i)] * impulse / h;
                }
            }
        }
    }
}
