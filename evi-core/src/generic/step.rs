//! One step of the generic path, in one stage or in those of a composition.
//!
//! In: a state. Out: the next state in a buffer of the caller, or why there is none. The equations of a stage, their scaling and the
//! stopping rule are those of the specialised path:
//!
//! ```text
//! h (−D₁L_d(q₀, q₀ + d) − f⁻ − p₀) + G₀ᵀ Λ = 0        φ(t₁, q₀ + d) = 0        p⁻ = D₂L_d(q₀, q₁) + f⁺
//! ```
//!
//! for `(d, Λ)` by Newton's iteration with `[hA G₀ᵀ; G₁ 0]`, `A = −D₁D₂L_d − ∂f⁻/∂q₁`, from `d = h v₀`. The projection of `p⁻` is
//! left to [`projection`](super::projection).

use nalgebra::DMatrix;

use super::GenericSystem;
use super::derivatives::{Derivatives, Point};
use super::kkt::Kkt;
use super::scheme::Nodes;
use crate::integrator::{IterationFailure, StepError};
use crate::linear::largest_magnitude;
use crate::mechanics::relative;
use crate::newton::{self, Converged, Statistics, Tally};

/// A point of a motion; constraints and hidden constraints hold to round-off.
pub(super) struct GenericState {
    pub(super) t: f64,
    pub(super) q: Vec<f64>,
    pub(super) v: Vec<f64>,
    pub(super) p: Vec<f64>,
    /// Constant over the step that begins here.
    pub(super) inputs: Vec<f64>,
    /// `G(t, q)`: the end of one step is the start of the next.
    pub(super) jacobian: DMatrix<f64>,
}

impl GenericState {
    pub(super) fn zero(system: &impl GenericSystem) -> Self {
        let n = system.n_coordinates();
        let zeros = || vec![0.0; n];
        let jacobian = DMatrix::zeros(system.n_constraints(), n);
        let inputs = vec![0.0; system.n_inputs()];
        Self { t: 0.0, q: zeros(), v: zeros(), p: zeros(), inputs, jacobian }
    }

    /// A state of no system, which takes the place of one that is lent. Without memory.
    fn empty() -> Self {
        let [q, v, p, inputs] = [Vec::new(), Vec::new(), Vec::new(), Vec::new()];
        Self { t: 0.0, q, v, p, inputs, jacobian: DMatrix::zeros(0, 0) }
    }

    fn is_finite(&self) -> bool {
        [&self.q, &self.v, &self.p].into_iter().flatten().all(|number| number.is_finite())
    }
}

/// The one-step map with every buffer that it needs.
pub(super) struct GenericStep<S> {
    pub(super) derivatives: Derivatives<S>,
    stages: Vec<Nodes>,
    /// The stage that is being taken.
    stage: usize,
    /// Where the stage begins that is being taken, but for the first.
    between: GenericState,
    pub(super) kkt: Kkt,
    /// Right-hand side, then solution, of a linear solve: coordinates, then constraints.
    pub(super) unknowns: Vec<f64>,
    /// `Λ` of the step, then `N` of the projection.
    pub(super) impulse: Vec<f64>,
    /// `∂φ/∂t` at the end of the step.
    pub(super) time_rates: Vec<f64>,
    difference: Vec<f64>,
    /// Position and velocity at a node.
    x: Vec<f64>,
    v: Vec<f64>,
    pub(super) statistics: Statistics,
}

impl<S: GenericSystem> GenericStep<S> {
    pub(super) fn new(system: S, stages: Vec<Nodes>) -> Self {
        let (n, m) = (system.n_coordinates(), system.n_constraints());
        Self {
            between: GenericState::zero(&system),
            derivatives: Derivatives::new(system),
            stages,
            stage: 0,
            kkt: Kkt::new(n, m),
            unknowns: vec![0.0; n + m],
            impulse: vec![0.0; m],
            time_rates: vec![0.0; m],
            difference: vec![0.0; n],
            x: vec![0.0; n],
            v: vec![0.0; n],
            statistics: Statistics::default(),
        }
    }

    /// Overwrites `next` with the state one step after `state`; after an error `next` means nothing.
    pub(super) fn step(&mut self, state: &GenericState, next: &mut GenericState) -> Result<(), StepError> {
        self.stage = 0;
        self.take_stage(state, next)?;
        while self.stage + 1 < self.stages.len() {
            self.stage += 1;
            let mut start = core::mem::replace(&mut self.between, GenericState::empty());
            core::mem::swap(&mut start, next);
            let outcome = self.take_stage(&start, next);
            self.between = start;
            outcome?;
        }
        Ok(())
    }

    /// Overwrites `next` with the state one stage after `state`.
    fn take_stage(&mut self, state: &GenericState, next: &mut GenericState) -> Result<(), StepError> {
        let h = self.stages[self.stage].h;
        self.solve(state, next)?;
        next.t = state.t + h;
        next.inputs.copy_from_slice(&state.inputs);
        for i in 0..state.q.len() {
            next.q[i] = state.q[i] + self.difference[i];
            next.v[i] = self.difference[i] / h;
        }
        self.end_momentum(state, &mut next.p);
        self.project_momentum(next).map_err(|cause| StepError::Projection { t: next.t, cause })?;
        if next.is_finite() { Ok(()) } else { Err(StepError::NotFinite { t: next.t }) }
    }

    /// Finds the difference `d = q₁ − q₀`; uses the configuration and the Jacobian of `end` as buffers.
    fn solve(&mut self, state: &GenericState, end: &mut GenericState) -> Result<(), StepError> {
        let (n, h) = (state.q.len(), self.stages[self.stage].h);
        for (difference, velocity) in self.difference.iter_mut().zip(&state.v) {
            *difference = h * velocity;
        }
        self.impulse.fill(0.0);
        let mut constraint_residual = 0.0;
        let mut smallest_pivot_ratio = 1.0_f64;
        let iteration = newton::iterate(|correction| {
            self.linearize(state, end);
            constraint_residual = largest_magnitude(self.unknowns[n..].iter().copied());
            self.kkt.factor().map_err(|matrix| IterationFailure::Singular { correction, matrix })?;
            smallest_pivot_ratio = smallest_pivot_ratio.min(self.kkt.pivot_ratio());
            self.kkt.solve(&mut self.unknowns);
            let (moves, impulses) = self.unknowns.split_at(n);
            for (difference, update) in self.difference.iter_mut().zip(moves) {
                *difference -= update;
            }
            for (impulse, update) in self.impulse.iter_mut().zip(impulses) {
                *impulse -= update;
            }
            let scale = self.kkt.scaled_length(&state.q).max(self.kkt.scaled_length(&self.difference));
            Ok(relative(self.kkt.scaled_length(&self.unknowns), scale))
        });
        match iteration {
            Ok(Converged { corrections }) => {
                self.statistics.count_corrections(corrections);
                Ok(())
            }
            Err(failure) => {
                Err(IterationFailure::at(failure, state.t, constraint_residual, smallest_pivot_ratio))
            }
        }
    }

    /// Overwrites `unknowns` with the residual of the step equations at `(d, Λ)`, and `kkt` with their derivative.
    fn linearize(&mut self, state: &GenericState, end: &mut GenericState) {
        let Self { derivatives, stages, stage, kkt, unknowns, impulse, difference, x, v, .. } = self;
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
    fn end_momentum(&mut self, state: &GenericState, momentum: &mut [f64]) {
        let Self { derivatives, stages, stage, difference, x, v, .. } = self;
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
