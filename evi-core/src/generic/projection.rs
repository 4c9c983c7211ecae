//! Projections of the generic path onto the constraint manifold.
//!
//! In: a momentum or a configuration beside the manifold. Out: the nearest one on it in the metric of the mass matrix.
//! Whether a start may be projected at all is left to [`run`](super::run).

use super::GenericSystem;
use super::derivatives::Point;
use super::state::GenericState;
use super::workspace::Workspace;
use crate::integrator::StepError;
use crate::linear::largest_magnitude;
use crate::mechanics::{ProjectionError, relative};
use crate::newton;

/// Velocities are on the hidden constraints to round-off. What is farther beside them than this share of their terms is round-off of an impulse that
/// exceeds the momentum by all of its digits.
const BESIDE: f64 = 1e-3;
/// Of the configuration, a length far above round-off and far below a step: velocities of less than that per step are at rest.
const SLIGHT: f64 = 1e-10;

impl<S: GenericSystem> Workspace<S> {
    /// Removes from the momentum of `state` the impulse that makes the motion leave the constraints, and overwrites its
    /// velocity, the first guess, and its Jacobian.
    ///
    /// Solves `∂L/∂v(t, q, v) + Gᵀ N = p⁻`, `G v + ∂φ/∂t = 0` for `(v, N)`; then `p = p⁻ − Gᵀ N`.
    ///
    /// Linear for an `L` quadratic in `v`, which nobody says here. Every second correction keeps the factors of the one
    /// before: where the problem is linear, it is the refinement that the specialised path makes too, its length shows
    /// that nothing is left, and no second Hessian is evaluated.
    pub(super) fn project_momentum(&mut self, state: &mut GenericState) -> Result<(), ProjectionError> {
        let Self { derivatives, kkt, unknowns, impulse, time_rates, .. } = self;
        let n = state.q.len();
        let GenericState { t, q, v, p, jacobian, .. } = state;
        derivatives.constraints(*t, q, time_rates, jacobian);
        derivatives.constraint_time_rates(*t, q, time_rates);
        impulse.fill(0.0);
        newton::iterate(|correction| -> Result<f64, ProjectionError> {
            let (momentum_row, constraint_row) = unknowns.split_at_mut(n);
            let at = Point { t: *t, q, v };
            momentum_row.fill(0.0);
            if correction % 2 == 1 {
                kkt.clear();
                derivatives.add_mass(at, momentum_row, &mut kkt.matrix);
                kkt.set_jacobians(jacobian, jacobian);
                kkt.factor()?;
            } else {
                derivatives.add_momentum(at, momentum_row);
            }
            for i in 0..n {
                let constraint_momentum: f64 =
                    impulse.iter().enumerate().map(|(c, impulse)| jacobian[(c, i)] * impulse).sum();
                momentum_row[i] = p[i] - momentum_row[i] - constraint_momentum;
            }
            for (c, row) in constraint_row.iter_mut().enumerate() {
                let along: f64 = (0..n).map(|i| jacobian[(c, i)] * v[i]).sum();
                *row = -(time_rates[c] + along);
            }
            kkt.solve(unknowns);
            for (velocity, update) in v.iter_mut().zip(&unknowns[..n]) {
                *velocity += update;
            }
            for (impulse, update) in impulse.iter_mut().zip(&unknowns[n..]) {
                *impulse += update;
            }
            // Near a turning point the velocity is a small difference of momenta: their round-off is no reason to go on.
            let scale = kkt.scaled_length(v).max(kkt.scaled_momentum(p));
            Ok(relative(kkt.scaled_length(unknowns), scale))
        })?;
        for i in 0..n {
            p[i] -= impulse.iter().enumerate().map(|(c, impulse)| jacobian[(c, i)] * impulse).sum::<f64>();
        }
        Ok(())
    }

    /// Projects the momentum at the end of a step of size `h` that began at the configuration `start`.
    ///
    /// # Errors
    /// [`StepError::Projection`] where that is not done, or its velocity is beside the hidden constraints.
    pub(super) fn project_end(
        &mut self,
        start: &[f64],
        end: &mut GenericState,
        h: f64,
    ) -> Result<(), StepError> {
        let t = end.t;
        self.project_momentum(end).map_err(|cause| StepError::Projection { t, cause })?;
        let slight = SLIGHT * largest_magnitude(end.q.iter().copied());
        for (c, &rate) in self.time_rates.iter().enumerate() {
            let (mut along, mut terms) = (rate, rate.abs());
            for i in 0..start.len() {
                let slope = end.jacobian[(c, i)];
                along += slope * end.v[i];
                let moved = (end.q[i] - start[i]).abs() + slight;
                terms += slope.abs() * (end.v[i].abs() + moved / h.abs());
            }
            let beside = relative(along.abs(), terms);
            // Written so that a NaN is refused.
            let is_on_constraint = beside <= BESIDE;
            if !is_on_constraint {
                let cause = ProjectionError::NotConverged { corrections: 1, last_correction: beside };
                return Err(StepError::Projection { t, cause });
            }
        }
        Ok(())
    }

    /// Overwrites momentum and velocity of `state` with the velocity that satisfies the hidden constraints nearest to its
    /// velocity, and the momentum of that.
    pub(super) fn project_velocity(&mut self, state: &mut GenericState) -> Result<(), ProjectionError> {
        state.p.fill(0.0);
        let at = Point { t: state.t, q: &state.q, v: &state.v };
        self.derivatives.add_momentum(at, &mut state.p);
        self.project_momentum(state)
    }

    /// Moves the configuration of `state` to the nearest one on the manifold.
    ///
    /// Newton's iteration on `M (q − start) + Gᵀ μ = 0`, `φ(q) = 0`, with the mass matrix at the start.
    pub(super) fn project_configuration(&mut self, state: &mut GenericState) -> Result<(), ProjectionError> {
        let Self { derivatives, kkt, unknowns, impulse: multipliers, .. } = self;
        let n = state.q.len();
        let GenericState { t, q, v, jacobian, .. } = state;
        if multipliers.is_empty() {
            return Ok(());
        }
        let start = q.clone();
        kkt.clear();
        derivatives.add_mass(Point { t: *t, q: &start, v }, &mut unknowns[..n], &mut kkt.matrix);
        let mass = kkt.matrix.view((0, 0), (n, n)).into_owned();
        multipliers.fill(0.0);
        newton::iterate(|_| -> Result<f64, ProjectionError> {
            let (pull, constraint_row) = unknowns.split_at_mut(n);
            derivatives.constraints(*t, q, constraint_row, jacobian);
            kkt.clear();
            kkt.matrix.view_mut((0, 0), (n, n)).copy_from(&mass);
            derivatives.add_constraint_hessian(*t, q, multipliers, &mut kkt.matrix);
            kkt.set_jacobians(jacobian, jacobian);
            kkt.factor()?;
            for i in 0..n {
                let inertia: f64 = (0..n).map(|j| mass[(i, j)] * (q[j] - start[j])).sum();
                let force: f64 = multipliers.iter().enumerate().map(|(c, m)| jacobian[(c, i)] * m).sum();
                pull[i] = inertia + force;
            }
            kkt.solve(unknowns);
            for (position, update) in q.iter_mut().zip(&unknowns[..n]) {
                *position -= update;
            }
            for (multiplier, update) in multipliers.iter_mut().zip(&unknowns[n..]) {
                *multiplier -= update;
            }
            Ok(kkt.relative_length(unknowns, [q, &start]))
        })?;
        Ok(())
    }
}
