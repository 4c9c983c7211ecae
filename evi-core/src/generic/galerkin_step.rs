//! One step of a Galerkin variational integrator on the generic path.
//!
//! In: a state. Out: the next state in a buffer of the caller, or why there is none. The equations of the `K` points are those of the
//! specialised path, with `R` the rates of the curves:
//!
//! ```text
//! h (−∂L_d/∂q_a − p₀ δ_a0) + G_aᵀ Λ_a = 0,   a = 0 .. K−1          φ(t_a, q_a) = 0,   a = 1 .. K
//! ```
//!
//! for the differences `d_a = q_a − q₀`, `a = 1 .. K`, and `Λ_a`, `a = 0 .. K−1`, by Newton's iteration on all of them, from the curve of the last
//! step where that stays near the parabola with the acceleration of the state, else from the parabola.

use nalgebra::DMatrix;

use super::GenericSystem;
use super::galerkin::Curves;
use super::galerkin_node::{Blocks, Node};
use super::state::GenericState;
use super::workspace::Workspace;
use crate::integrator::{IterationFailure, StepError};
use crate::linear::{InPlaceLu, largest_magnitude};
use crate::mechanics::Length;
use crate::newton::{self, Converged, Tally};

/// The unknowns of a step with the tables and buffers of their equations.
pub struct GalerkinPoints {
    curves: Curves,
    /// The points that are being found, then found.
    points: Points,
    /// Those of the last step.
    past: Points,
    has_past: bool,
    /// The parabola with the acceleration of the state.
    parabola: Points,
    /// What the equations leave, then the correction; point by point, coordinates before constraints.
    residual: Vec<f64>,
    /// The matrix by columns; its factors while a correction is computed.
    entries: Vec<f64>,
    factors: InPlaceLu,
    node: Node,
}

/// Points of a curve and impulses at its nodes.
pub(super) struct Points {
    /// `d_a` in column `a − 1`.
    pub(super) differences: DMatrix<f64>,
    /// `Λ_a = h² b_a λ_a` in column `a`.
    pub(super) impulses: DMatrix<f64>,
}

impl Points {
    fn zero(n: usize, m: usize, intervals: usize) -> Self {
        Self { differences: DMatrix::zeros(n, intervals), impulses: DMatrix::zeros(m, intervals) }
    }

    fn copy_from(&mut self, other: &Self) {
        self.differences.copy_from(&other.differences);
        self.impulses.copy_from(&other.impulses);
    }

    /// Whether no point is farther from that of `other` than a tenth of the way that `other` makes.
    fn is_near(&self, other: &Self, scale: &[f64]) -> bool {
        const NEAR: f64 = 0.1;
        let (mut distance, mut way) = (Length::default(), Length::default());
        for (here, there) in self.differences.column_iter().zip(other.differences.column_iter()) {
            distance = distance.or(Length::between(here.as_slice(), there.as_slice(), scale));
            way = way.or(Length::in_units(there.as_slice(), scale));
        }
        distance.relative_to(way) <= NEAR
    }
}

impl GalerkinPoints {
    pub(super) fn new(system: &impl GenericSystem, curves: Curves) -> Self {
        let (n, m) = (system.n_coordinates(), system.n_constraints());
        let intervals = curves.intervals();
        let (points, dimension) = (|| Points::zero(n, m, intervals), intervals * (n + m));
        Self {
            points: points(),
            past: points(),
            has_past: false,
            parabola: points(),
            residual: vec![0.0; dimension],
            entries: vec![0.0; dimension * dimension],
            factors: InPlaceLu::new(dimension),
            node: Node::new(n, m),
            curves,
        }
    }

    /// Overwrites `next` with the state one step after `state`; after an error `next` means nothing.
    pub(super) fn step<S: GenericSystem>(
        &mut self,
        work: &mut Workspace<S>,
        state: &GenericState,
        next: &mut GenericState,
    ) -> Result<(), StepError> {
        self.solve(work, state)?;
        let intervals = self.curves.intervals();
        next.t = state.t + self.curves.h;
        next.inputs.copy_from_slice(&state.inputs);
        self.node.move_to(intervals, &self.curves, &self.points, state);
        next.q.copy_from_slice(&self.node.q);
        next.v.copy_from_slice(&self.node.v);
        next.p.copy_from_slice(&state.p);
        for node in 0..=intervals {
            self.node.add_momentum_gain(node, &self.curves, &self.points, work, state, &mut next.p);
        }
        work.project_end(&state.q, next, self.curves.h)?;
        if !next.is_finite() {
            return Err(StepError::NotFinite { t: next.t });
        }
        core::mem::swap(&mut self.points, &mut self.past);
        self.has_past = true;
        Ok(())
    }

    /// Finds the points of the step from `state`.
    fn solve<S: GenericSystem>(
        &mut self,
        work: &mut Workspace<S>,
        state: &GenericState,
    ) -> Result<(), StepError> {
        self.find_parabola(work, state)?;
        if self.has_past {
            let Self { curves, points, past, .. } = self;
            past.differences.mul_to(&curves.continued_differences, &mut points.differences);
            past.impulses.mul_to(&curves.continued_impulses, &mut points.impulses);
            if points.is_near(&self.parabola, work.kkt.scale()) && self.iterate(work, state).is_ok() {
                return Ok(());
            }
        }
        self.points.copy_from(&self.parabola);
        self.iterate(work, state)
    }

    /// Overwrites the parabola; the saddle-point matrix is scaled for the state from then on.
    fn find_parabola<S: GenericSystem>(
        &mut self,
        work: &mut Workspace<S>,
        state: &GenericState,
    ) -> Result<(), StepError> {
        work.solve_acceleration(state).map_err(|matrix| StepError::Singular {
            t: state.t,
            correction: 0,
            matrix,
        })?;
        let (n, h) = (state.q.len(), self.curves.h);
        let (acceleration, multipliers) = work.unknowns.split_at(n);
        for a in 0..self.curves.intervals() {
            let time = h * self.curves.nodes[a + 1];
            for i in 0..n {
                self.parabola.differences[(i, a)] = time * (state.v[i] + 0.5 * time * acceleration[i]);
            }
            for (c, multiplier) in multipliers.iter().enumerate() {
                self.parabola.impulses[(c, a)] = h * h * self.curves.weights[a] * multiplier;
            }
        }
        Ok(())
    }

    /// Corrects the points until they solve the equations of the step from `state`.
    fn iterate<S: GenericSystem>(
        &mut self,
        work: &mut Workspace<S>,
        state: &GenericState,
    ) -> Result<(), StepError> {
        let n = state.q.len();
        let mut constraint_residual = 0.0;
        let mut smallest_pivot_ratio = 1.0_f64;
        let iteration = newton::iterate(|correction| {
            self.linearize(work, state);
            let Self { points, residual, entries, factors, .. } = self;
            let scale = work.kkt.scale();
            let block = scale.len();
            let length = |x: &[f64]| Length::in_units(x, scale);
            constraint_residual =
                largest_magnitude(residual.chunks_exact(block).flat_map(|rows| rows[n..].iter().copied()));
            for (col, column) in entries.chunks_exact_mut(residual.len()).enumerate() {
                for (row, entry) in column.iter_mut().enumerate() {
                    *entry *= scale[row % block] * scale[col % block];
                }
            }
            factors.factor(entries).map_err(|matrix| IterationFailure::Singular { correction, matrix })?;
            smallest_pivot_ratio = smallest_pivot_ratio.min(factors.pivot_ratio());
            apply_scale(residual, scale);
            factors.solve(entries, residual);
            apply_scale(residual, scale);
            let (mut moved, mut reach) = (Length::default(), length(&state.q));
            for (a, update) in residual.chunks_exact(block).enumerate() {
                let (moves, impulses) = update.split_at(n);
                points.differences.column_mut(a).iter_mut().zip(moves).for_each(|(x, update)| *x -= update);
                points.impulses.column_mut(a).iter_mut().zip(impulses).for_each(|(x, update)| *x -= update);
                moved = moved.or(length(moves));
                reach = reach.or(length(points.differences.column(a).as_slice()));
            }
            Ok(moved.relative_to(reach))
        });
        match iteration {
            Ok(Converged { corrections }) => {
                work.statistics.count_corrections(corrections);
                Ok(())
            }
            Err(failure) => {
                Err(IterationFailure::at(failure, state.t, constraint_residual, smallest_pivot_ratio))
            }
        }
    }

    /// Overwrites `residual` with the left sides of the equations at the points, and `entries` with their derivative.
    fn linearize<S: GenericSystem>(&mut self, work: &mut Workspace<S>, state: &GenericState) {
        let Self { curves, points, residual, entries, node, .. } = self;
        residual.fill(0.0);
        entries.fill(0.0);
        for (row, p) in residual.iter_mut().zip(&state.p) {
            *row -= curves.h * p;
        }
        let mut equations = Blocks { residual, entries, block: work.unknowns.len() };
        for index in 0..=curves.intervals() {
            node.move_to(index, curves, points, state);
            node.add_lagrangian(index, curves, work, state, &mut equations);
            node.add_constraints(index, curves, points, work, state, &mut equations);
        }
    }
}

/// Multiplies the unknowns of every point by their scales.
fn apply_scale(unknowns: &mut [f64], scale: &[f64]) {
    for unknowns in unknowns.chunks_exact_mut(scale.len()) {
        unknowns.iter_mut().zip(scale).for_each(|(unknown, scale)| *unknown *= scale);
    }
}
