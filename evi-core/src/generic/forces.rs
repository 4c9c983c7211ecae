//! Forces that are no derivatives of `L`, on the generic path.
//!
//! In: a point, the inputs, and the directions of a node. Out: the node's part of `f⁻` or `f⁺` and of the derivative of
//! `h f⁻`, added to buffers of the caller. Nothing is evaluated for a system without forces.

use nalgebra::DMatrix;

use super::GenericSystem;
use super::chunk::{CHUNK, Gradient, Mixed, add_block, add_scaled, infinitesimal};
use super::derivatives::{Derivatives, Point, Seed};

impl<S: GenericSystem> Derivatives<S> {
    /// Adds `f` to `force`.
    pub(super) fn add_applied_force(&mut self, at: Point<'_>, inputs: &[f64], force: &mut [f64]) {
        let along_itself = |_| 1.0;
        self.add_weighted_force(at, inputs, along_itself, force);
    }

    /// Adds `weight rows[i].q fᵢ` to `sum[i]`: the virtual work along the directions in which the positions move.
    pub(super) fn add_virtual_work(
        &mut self,
        at: Point<'_>,
        inputs: &[f64],
        rows: &[Seed],
        weight: f64,
        sum: &mut [f64],
    ) {
        self.add_weighted_force(at, inputs, |i| weight * rows[i].q, sum);
    }

    /// Adds `weight(i) fᵢ` to `sum[i]`.
    fn add_weighted_force(
        &mut self,
        at: Point<'_>,
        inputs: &[f64],
        weight: impl Fn(usize) -> f64,
        sum: &mut [f64],
    ) {
        if S::HAS_FORCES {
            let n = self.n_coordinates;
            self.force[..n].fill(0.0);
            self.system.add_forces(at.t, at.q, at.v, inputs, &mut self.force);
            for i in 0..n {
                sum[i] += weight(i) * self.force[i];
            }
        }
        if S::HAS_DISSIPATION {
            for first in (0..self.n_coordinates).step_by(CHUNK) {
                for i in 0..self.n_coordinates {
                    self.gradient_q[i] = Gradient::from_re(at.q[i]);
                    self.gradient_v[i] = Gradient::new(at.v[i], infinitesimal(i, first, Seed::VELOCITY.v));
                }
                let t = Gradient::from_re(at.t);
                let slopes = self.system.dissipation(t, &self.gradient_q, &self.gradient_v).eps.0;
                for (i, slope) in (first..self.n_coordinates).zip(slopes.iter().flatten()) {
                    sum[i] -= weight(i) * slope;
                }
            }
        }
    }

    /// Adds `weight rows[i].q fᵢ` to `sum[i]` and `weight rows[i].q ∂fᵢ/∂δⱼ` to `block[(i, j)]`, where `columns` are the directions
    /// of `δ`.
    pub(super) fn add_virtual_work_with_derivatives(
        &mut self,
        at: Point<'_>,
        inputs: &[f64],
        (rows, columns): (&[Seed], &[Seed]),
        weight: f64,
        sum: &mut [f64],
        block: &mut DMatrix<f64>,
    ) {
        self.add_virtual_work(at, inputs, rows, weight, sum);
        let n = self.n_coordinates;
        if S::HAS_FORCES {
            for (input, &value) in self.gradient_inputs.iter_mut().zip(inputs) {
                *input = Gradient::from_re(value);
            }
            for first in (0..n).step_by(CHUNK) {
                for i in 0..n {
                    self.gradient_q[i] = Gradient::new(at.q[i], infinitesimal(i, first, columns[i].q));
                    self.gradient_v[i] = Gradient::new(at.v[i], infinitesimal(i, first, columns[i].v));
                    self.gradient_force[i] = Gradient::from_re(0.0);
                }
                let t = Gradient::from_re(at.t);
                let Self { system, gradient_q, gradient_v, gradient_inputs, gradient_force, .. } = self;
                system.add_forces(t, gradient_q, gradient_v, gradient_inputs, gradient_force);
                for i in 0..n {
                    let mut row = [0.0; CHUNK];
                    add_scaled(self.gradient_force[i].eps, weight * rows[i].q, &mut row);
                    for (j, slope) in (first..n).zip(row) {
                        block[(i, j)] += slope;
                    }
                }
            }
        }
        if S::HAS_DISSIPATION {
            for row in (0..n).step_by(CHUNK) {
                for col in (0..n).step_by(CHUNK) {
                    // Along v alone in the rows: scaled, it is the row's weight of the virtual work.
                    let along = |i: usize| Seed { q: 0.0, v: rows[i].q };
                    self.set_mixed(at, (row, along), (col, |j| columns[j]));
                    let t = Mixed::from_re(at.t);
                    let value = self.system.dissipation(t, &self.mixed_q, &self.mixed_v);
                    add_block(&value, -weight, (row, col), block);
                }
            }
        }
    }
}
