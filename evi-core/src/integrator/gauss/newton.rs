//! Newton's iteration on all nodes of a Gauss step at once.
//!
//! For the velocities `Vᵢ`, with `Qᵢ = q₀ + h Σⱼ Aᵢⱼ Vⱼ`, it solves
//!
//! ```text
//! ∂L/∂v(Qᵢ, Vᵢ) − p₀ − h Σⱼ Aᵢⱼ (∂L/∂q + f)(Qⱼ, Vⱼ) = 0
//! ```

use crate::array::Array;
use crate::integrator::{IterationFailure, StepError, Tally};
use crate::linear::{InPlaceLu, SingularMatrix};
use crate::mechanics::{ForcePoint, GaussEnd, Length, Mechanics, State};
use crate::newton::{self, Converged};
use crate::scalar::LANES;
use crate::scheme::GaussTables;
use crate::system::MechanicalSystem;

/// The iteration with its storage.
pub(crate) struct GaussNewton<S: MechanicalSystem, const K: usize> {
    tables: GaussTables,
    /// The matrix by columns, in units in which its unknowns are comparable; its factors while a correction is computed.
    entries: Vec<f64>,
    /// These units.
    scale: S::PerUnknown<f64>,
    /// Node by node.
    residual: [S::PerCoordinate<f64>; K],
    /// The same in the order of the matrix.
    ordered: Vec<f64>,
    /// `Vᵢ`.
    velocities: [S::PerCoordinate<f64>; K],
    factors: InPlaceLu,
}

impl<S: MechanicalSystem, const K: usize> GaussNewton<S, K> {
    pub(crate) fn new(h: f64) -> Self {
        let dimension = K * S::N_COORDINATES;
        Self {
            tables: GaussTables::new::<K>(h),
            entries: vec![0.0; dimension * dimension],
            scale: Array::filled(1.0),
            residual: nothing(),
            ordered: vec![0.0; dimension],
            velocities: nothing(),
            factors: InPlaceLu::new(dimension),
        }
    }

    /// What the step from `start` changes.
    pub(crate) fn solve(
        &mut self,
        mechanics: &Mechanics<S>,
        start: &State<S>,
        tally: &mut impl Tally,
    ) -> Result<GaussEnd<S>, StepError> {
        let n = S::N_COORDINATES;
        self.scale = mechanics.unit_scale(start.t, &start.q, &start.v);
        let scale = self.scale.clone();
        let in_units = |x: &[f64]| Length::in_units(x, scale.as_ref());
        self.velocities = core::array::from_fn(|_| start.v.clone());
        let h = self.tables.weights.sum().abs();
        let mut smallest_pivot_ratio = 1.0_f64;
        tally.begin_iteration();
        let iteration = newton::iterate(|correction| {
            self.linearize(mechanics, start);
            self.factors
                .factor(&mut self.entries)
                .map_err(|matrix| IterationFailure::Singular { correction, matrix })?;
            smallest_pivot_ratio = smallest_pivot_ratio.min(self.factors.pivot_ratio());
            tally.see_pivot_ratio(self.factors.pivot_ratio());
            self.solve_residual(|factors, entries, rhs| factors.solve(entries, rhs));
            let (mut length, mut reach) = (Length::default(), in_units(start.q.as_ref()));
            for (velocities, update) in self.velocities.iter_mut().zip(&self.residual) {
                for i in 0..n {
                    velocities[i] -= update[i];
                }
                length = length.or(in_units(update.as_ref()).times(h));
                reach = reach.or(in_units(velocities.as_ref()).times(h));
            }
            let length = length.relative_to(reach);
            tally.see_correction(|| length);
            Ok(length)
        });
        match iteration {
            Ok(Converged { corrections }) => {
                tally.count_corrections(corrections);
                Ok(self.end(mechanics, start, corrections))
            }
            Err(failure) => Err(IterationFailure::at(failure, start.t, 0.0, smallest_pivot_ratio)),
        }
    }

    /// `h Aᵢⱼ`.
    pub(crate) fn stage(&self, i: usize, j: usize) -> f64 {
        self.tables.stages[j].to_array()[i]
    }

    /// `tᵢ`, `Qᵢ` and `Vᵢ`.
    fn node(&self, start: &State<S>, i: usize) -> (f64, S::PerCoordinate<f64>, S::PerCoordinate<f64>) {
        let way = |k: usize| (0..K).map(|j| self.stage(i, j) * self.velocities[j][k]).sum::<f64>();
        let q = Array::from_fn(|k| start.q[k] + way(k));
        (start.t + self.tables.nodes.to_array()[i], q, self.velocities[i].clone())
    }

    /// `h bᵢ`.
    pub(crate) fn weight(&self, i: usize) -> f64 {
        self.tables.weights.to_array()[i]
    }

    /// `h cᵢ`.
    pub(crate) fn time(&self, i: usize) -> f64 {
        self.tables.nodes.to_array()[i]
    }

    /// `Vᵢ` of the last step that was solved.
    pub(crate) fn velocities(&self) -> [S::PerCoordinate<f64>; K] {
        self.velocities.clone()
    }

    /// Factors the matrix of the equations at these velocities of the step from `start`.
    pub(crate) fn factor(
        &mut self,
        mechanics: &Mechanics<S>,
        start: &State<S>,
        velocities: &[S::PerCoordinate<f64>; K],
    ) -> Result<(), SingularMatrix> {
        self.velocities.clone_from(velocities);
        self.scale = mechanics.unit_scale(start.t, &start.q, &start.v);
        self.linearize(mechanics, start);
        self.factors.factor(&mut self.entries)
    }

    /// Overwrites right-hand sides, node by node, with the solution for the factored matrix.
    pub(crate) fn solve_rows(&mut self, rows: &mut [S::PerCoordinate<f64>; K]) {
        self.solve_by(rows, |factors, entries, rhs| factors.solve(entries, rhs));
    }

    /// The same for the transposed matrix.
    pub(crate) fn solve_transposed_rows(&mut self, rows: &mut [S::PerCoordinate<f64>; K]) {
        self.solve_by(rows, |factors, entries, rhs| factors.solve_transposed(entries, rhs));
    }

    fn solve_by(
        &mut self,
        rows: &mut [S::PerCoordinate<f64>; K],
        solve: impl FnOnce(&InPlaceLu, &[f64], &mut [f64]),
    ) {
        self.residual.clone_from(rows);
        self.solve_residual(solve);
        rows.clone_from(&self.residual);
    }

    /// Overwrites the residual with what `solve` makes of it by the factors.
    fn solve_residual(&mut self, solve: impl FnOnce(&InPlaceLu, &[f64], &mut [f64])) {
        let scale = || self.scale.as_ref().iter().cycle();
        let rows = self.residual.iter().flat_map(AsRef::as_ref).zip(scale());
        for (value, (residual, scale)) in self.ordered.iter_mut().zip(rows) {
            *value = residual * scale;
        }
        solve(&self.factors, &self.entries, &mut self.ordered);
        let values = self.ordered.iter().zip(scale());
        for (residual, (value, scale)) in self.residual.iter_mut().flat_map(AsMut::as_mut).zip(values) {
            *residual = value * scale;
        }
    }

    /// Overwrites `residual` with the left sides of the equations and `entries` with their derivative.
    fn linearize(&mut self, mechanics: &Mechanics<S>, start: &State<S>) {
        let n = S::N_COORDINATES;
        let dimension = K * n;
        let constants = &mechanics.constants;
        self.residual = nothing();
        self.entries.fill(0.0);
        let stages: [[f64; LANES]; K] = core::array::from_fn(|j| self.tables.stages[j].to_array());
        for node in 0..K {
            let (t, q, v) = self.node(start, node);
            let from_node = stages[node];
            let to_node: [f64; K] = core::array::from_fn(|j| stages[j][node]);
            let (mut gradient, hessian) = S::lagrangian_derivatives(constants, t, &q, &v);
            // What a change of `Qₘ` or `Vₘ` of node `m` does to its momentum and to its force, whose share of row `i` is `−h Aᵢₘ`.
            let mut add = |row: usize, col: usize, (of_momentum, of_force): (f64, f64), is_by_q: bool| {
                for i in 0..K {
                    let share = if i == node { of_momentum } else { 0.0 } - from_node[i] * of_force;
                    for j in 0..K {
                        let way = if is_by_q {
                            to_node[j]
                        } else if j == node {
                            1.0
                        } else {
                            0.0
                        };
                        // There is one for every row and column, which the optimiser need not find out.
                        if let Some(entry) = self.entries.get_mut((j * n + col) * dimension + i * n + row) {
                            *entry += share * way;
                        }
                    }
                }
            };
            let value = |entry: &crate::system::Entry| entry.number(constants.as_ref(), hessian.as_ref());
            for entry in S::STRUCTURE.hessian.qq {
                add(entry.row, entry.col, (0.0, value(entry)), true);
                if entry.row != entry.col {
                    add(entry.col, entry.row, (0.0, value(entry)), true);
                }
            }
            for entry in S::STRUCTURE.hessian.vq {
                add(entry.row, entry.col, (value(entry), 0.0), true);
                add(entry.col, entry.row, (0.0, value(entry)), false);
            }
            for entry in S::STRUCTURE.hessian.vv {
                add(entry.row, entry.col, (value(entry), 0.0), false);
                if entry.row != entry.col {
                    add(entry.col, entry.row, (value(entry), 0.0), false);
                }
            }
            if S::STRUCTURE.forces.exist() {
                let at = ForcePoint { t, q: &q, v: &v, inputs: &start.inputs };
                let derivatives = mechanics.add_force_with_derivatives(at, &mut gradient.force);
                derivatives.for_each_by_q(|row, col, value| add(row, col, (0.0, value), true));
                derivatives.for_each_by_v(|row, col, value| add(row, col, (0.0, value), false));
            }
            for k in 0..n {
                self.residual[node][k] += gradient.momentum[k] - start.p[k];
                for i in 0..K {
                    self.residual[i][k] -= from_node[i] * gradient.force[k];
                }
            }
        }
        let scale = || self.scale.as_ref().iter().cycle();
        for (column, of_column) in self.entries.chunks_exact_mut(dimension.max(1)).zip(scale()) {
            for (entry, of_row) in column.iter_mut().zip(scale()) {
                *entry *= of_row * of_column;
            }
        }
    }

    fn end(&self, mechanics: &Mechanics<S>, start: &State<S>, passes: usize) -> GaussEnd<S> {
        let (mut difference, mut gain) =
            (S::PerCoordinate::<f64>::filled(0.0), S::PerCoordinate::<f64>::filled(0.0));
        for node in 0..K {
            let (t, q, v) = self.node(start, node);
            let mut force = S::lagrangian_gradient(&mechanics.constants, t, &q, &v).force;
            mechanics.add_force(ForcePoint { t, q: &q, v: &v, inputs: &start.inputs }, &mut force);
            let weight = self.tables.weights.to_array()[node];
            for i in 0..S::N_COORDINATES {
                difference[i] += weight * v[i];
                gain[i] += weight * force[i];
            }
        }
        GaussEnd { difference, gain, passes }
    }
}

/// Zeros, one per coordinate at every node.
fn nothing<A: Array<f64>, const K: usize>() -> [A; K] {
    core::array::from_fn(|_| A::filled(0.0))
}
