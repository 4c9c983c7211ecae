//! One step of an exponential variational integrator on the generic path, in one stage or in those of a composition.
//!
//! In: a state. Out: the next state in a buffer of the caller, or why there is none. The equations of a stage, their scaling and the
//! stopping rule are those of the specialised path:
//!
//! ```text
//! h (−D₁L_d(q₀, q₀ + d) − f⁻ − p₀) + G₀ᵀ Λ = 0        φ(t₁, q₀ + d) = 0        p⁻ = D₂L_d(q₀, q₁) + f⁺
//! ```
//!
//! for `(d, Λ)` by Newton's iteration with `[hA G₀ᵀ; G₁ 0]`, `A = −D₁D₂L_d − ∂f⁻/∂q₁`, from `d = h v₀`.

use super::GenericSystem;
use super::derivatives::Point;
use super::evi::Nodes;
use super::state::GenericState;
use super::workspace::Workspace;
use crate::integrator::{IterationFailure, StepError};
use crate::linear::largest_magnitude;
use crate::newton::{self, Converged, Tally};

/// The stages of a step, with buffers.
pub struct EviStages {
    stages: Vec<Nodes>,
    /// The stage that is being taken.
    stage: usize,
    /// Where the stage begins that is being taken, but for the first.
    between: GenericState,
    difference: Vec<f64>,
    /// Position and velocity at a node.
    x: Vec<f64>,
    v: Vec<f64>,
}

impl EviStages {
    pub(super) fn new(system: &impl GenericSystem, stages: Vec<Nodes>) -> Self {
        let zeros = || vec![0.0; system.n_coordinates()];
        let (difference, x, v) = (zeros(), zeros(), zeros());
        Self { stages, stage: 0, between: GenericState::zero(system), difference, x, v }
    }

    /// Overwrites `next` with the state one step after `state`; after an error `next` means nothing.
    pub(super) fn step<S: GenericSystem>(
        &mut self,
        work: &mut Workspace<S>,
        state: &GenericState,
        next: &mut GenericState,
    ) -> Result<(), StepError> {
        self.stage = 0;
        self.take_stage(work, state, next)?;
        while self.stage + 1 < self.stages.len() {
            self.stage += 1;
            let mut start = core::mem::replace(&mut self.between, GenericState::empty());
            core::mem::swap(&mut start, next);
            let outcome = self.take_stage(work, &start, next);
            self.between = start;
            outcome?;
        }
        Ok(())
    }

    /// Overwrites `next` with the state one stage after `state`.
    fn take_stage<S: GenericSystem>(
        &mut self,
        work: &mut Workspace<S>,
        state: &GenericState,
        next: &mut GenericState,
    ) -> Result<(), StepError> {
        let h = self.stages[self.stage].h;
        self.solve(work, state, next)?;
        next.t = state.t + h;
        next.inputs.copy_from_slice(&state.inputs);
        for i in 0..state.q.len() {
            next.q[i] = state.q[i] + self.difference[i];
            next.v[i] = self.difference[i] / h;
        }
        self.end_momentum(work, state, &mut next.p);
        work.project_end(&state.q, next, h)?;
        if next.is_finite() { Ok(()) } else { Err(StepError::NotFinite { t: next.t }) }
    }

    /// Finds the difference `d = q₁ − q₀`; uses the configuration and the Jacobian of `end` as buffers.
    fn solve<S: GenericSystem>(
        &mut self,
        work: &mut Workspace<S>,
        state: &GenericState,
        end: &mut GenericState,
    ) -> Result<(), StepError> {
        let (n, h) = (state.q.len(), self.stages[self.stage].h);
        for (difference, velocity) in self.difference.iter_mut().zip(&state.v) {
            *difference = h * velocity;
        }
        work.impulse.fill(0.0);
        let mut constraint_residual = 0.0;
        let mut smallest_pivot_ratio = 1.0_f64;
        let iteration = newton::iterate(|correction| {
            self.linearize(work, state, end);
            constraint_residual = largest_magnitude(work.unknowns[n..].iter().copied());
            work.kkt.factor().map_err(|matrix| IterationFailure::Singular { correction, matrix })?;
            smallest_pivot_ratio = smallest_pivot_ratio.min(work.kkt.pivot_ratio());
            work.kkt.solve(&mut work.unknowns);
            let (moves, impulses) = work.unknowns.split_at(n);
            for (difference, update) in self.difference.iter_mut().zip(moves) {
                *difference -= update;
            }
            for (impulse, update) in work.impulse.iter_mut().zip(impulses) {
                *impulse -= update;
            }
            Ok(work.kkt.relative_length(&work.unknowns, [&state.q, &self.difference]))
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

    /// Overwrites `unknowns` with the residual of the step equations at `(d, Λ)`, and `kkt` with their derivative.
    fn linearize<S: GenericSystem>(
        &mut self,
        work: &mut Workspace<S>,
        state: &GenericState,
        end: &mut GenericState,
    ) {
        let Self { stages, stage, difference, x, v, .. } = self;
        let Workspace { derivatives, kkt, unknowns, impulse, .. } = work;
        let nodes = &stages[*stage];
        let (n, h) = (state.q.len(), nodes.h);
        let (momentum_row, constraint_row) = unknowns.split_at_mut(n);
        kkt.clear();
        momentum_row.fill(0.0);
        for node in &nodes.nodes {
            node.interpolate(h, &state.q, difference, x, v);
            let at = Point { t: state.t + (0.5 + node.offset) * h, q: x, v };
            derivatives.add_mixed(
                at,
                (&node.starts, &node.ends),
                -node.weight,
                momentum_row,
                &mut kkt.matrix,
            );
            derivatives.add_virtual_work_with_derivatives(
                at,
                &state.inputs,
                (&node.starts, &node.ends),
                -node.weight,
                momentum_row,
                &mut kkt.matrix,
            );
        }
        for i in 0..n {
            momentum_row[i] = h * (momentum_row[i] - state.p[i]);
            for (c, impulse) in impulse.iter().enumerate() {
                momentum_row[i] += state.jacobian[(c, i)] * impulse;
            }
            end.q[i] = state.q[i] + difference[i];
        }
        derivatives.constraints(state.t + h, &end.q, constraint_row, &mut end.jacobian);
        kkt.set_jacobians(&state.jacobian, &end.jacobian);
    }

    /// Overwrites `momentum` with `p⁻ = D₂L_d(q₀, q₀ + d) + f⁺`.
    fn end_momentum<S: GenericSystem>(
        &mut self,
        work: &mut Workspace<S>,
        state: &GenericState,
        momentum: &mut [f64],
    ) {
        let Self { stages, stage, difference, x, v, .. } = self;
        let derivatives = &mut work.derivatives;
        let nodes = &stages[*stage];
        momentum.fill(0.0);
        for node in &nodes.nodes {
            node.interpolate(nodes.h, &state.q, difference, x, v);
            let at = Point { t: state.t + (0.5 + node.offset) * nodes.h, q: x, v };
            derivatives.add_gradient(at, &node.ends, node.weight, momentum);
            derivatives.add_virtual_work(at, &state.inputs, &node.ends, node.weight, momentum);
        }
    }
}
