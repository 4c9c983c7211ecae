//! Runs of the generic path.
//!
//! In: a scheme, a system and a start. Out: a run, which holds the last state that was reached.

use num_dual::Dual64;

use super::GenericSystem;
use super::acceleration::GenericAcceleration;
use super::scheme::GenericScheme;
use super::state::GenericState;
use super::step::GenericStep;
use super::workspace::Workspace;
use crate::comparison::{Failure, Solver};
use crate::integrator::{CONSISTENCY, ConstraintLabel, StartError, StepError, steps_between};
use crate::linear::SingularMatrix;
use crate::mechanics::relative;
use crate::newton::Statistics;

/// A system, the one-step map of a [`GenericScheme`] for it, and the state that it has reached.
///
/// A step allocates nothing beside what the system's own functions allocate; one that fails leaves the run at the last
/// state that was reached. As a [`Solver`] it stands beside the runs of other methods.
pub struct GenericRun<S> {
    step: GenericStep<S>,
    state: GenericState,
    /// Where a step writes; becomes the state when the step has succeeded.
    next: GenericState,
    h: f64,
    start_time: f64,
    steps: u64,
}

impl<S: GenericSystem> GenericRun<S> {
    pub(super) fn start_consistent(
        scheme: &(impl GenericScheme + ?Sized),
        system: S,
        start: (f64, &[f64], &[f64]),
    ) -> Result<Self, StartError> {
        let mut run = Self::at(scheme, system, start)?;
        run.check_position()?;
        run.check_velocity()?;
        run.step.work.project_velocity(&mut run.state)?;
        Ok(run)
    }

    pub(super) fn start_projected(
        scheme: &(impl GenericScheme + ?Sized),
        system: S,
        start: (f64, &[f64], &[f64]),
    ) -> Result<Self, StartError> {
        let mut run = Self::at(scheme, system, start)?;
        run.step.work.project_configuration(&mut run.state)?;
        run.step.work.project_velocity(&mut run.state)?;
        Ok(run)
    }

    /// A run whose momentum is still to be found.
    fn at(
        scheme: &(impl GenericScheme + ?Sized),
        system: S,
        (t, q, v): (f64, &[f64], &[f64]),
    ) -> Result<Self, StartError> {
        let n = system.n_coordinates();
        let (mut state, next) = (GenericState::zero(&system), GenericState::zero(&system));
        let equations = scheme.prepare(&system)?;
        let step = GenericStep { work: Workspace::new(system), equations };
        for (quantity, values) in [("position", q), ("velocity", v)] {
            if values.len() != n {
                return Err(StartError::Length { quantity, expected: n, found: values.len() });
            }
        }
        state.t = t;
        state.q.copy_from_slice(q);
        state.v.copy_from_slice(v);
        let run = Self { step, state, next, h: scheme.step_size(), start_time: t, steps: 0 };
        let numbers = [("time", &[t][..]), ("position", q), ("velocity", v), ("energy", &[run.energy()])];
        for (quantity, values) in numbers {
            if let Some(index) = values.iter().position(|value| !value.is_finite()) {
                return Err(StartError::NotFinite { quantity, index, value: values[index] });
            }
        }
        Ok(run)
    }

    /// Compares `φ` with `‖G‖ ‖q‖`, what a displacement of the size of the configuration would make of it.
    fn check_position(&mut self) -> Result<(), StartError> {
        let Self { step, state: GenericState { t, q, jacobian, .. }, .. } = self;
        let Workspace { derivatives, time_rates: residuals, .. } = &mut step.work;
        derivatives.constraints(*t, q, residuals, jacobian);
        for (c, &residual) in residuals.iter().enumerate() {
            let allowed: f64 = (0..q.len()).map(|i| CONSISTENCY * (jacobian[(c, i)] * q[i]).abs()).sum();
            // Compared this way round, so that a NaN fails.
            let passes = residual.abs() <= allowed;
            if !passes {
                let constraint = ConstraintLabel::Index(c);
                return Err(StartError::InconsistentPosition { constraint, residual, allowed });
            }
        }
        Ok(())
    }

    /// After [`check_position`](Self::check_position), which evaluates the Jacobian.
    fn check_velocity(&self) -> Result<(), StartError> {
        for (c, residual) in self.hidden_constraint_residual().into_iter().enumerate() {
            let passes = residual <= CONSISTENCY;
            if !passes {
                let (constraint, allowed) = (ConstraintLabel::Index(c), CONSISTENCY);
                return Err(StartError::InconsistentVelocity { constraint, residual, allowed });
            }
        }
        Ok(())
    }

    /// The system that moves.
    pub const fn system(&self) -> &S {
        self.step.work.derivatives.system()
    }

    /// Step size.
    pub const fn h(&self) -> f64 {
        self.h
    }

    /// Time.
    pub const fn t(&self) -> f64 {
        self.state.t
    }

    /// Configuration.
    pub fn q(&self) -> &[f64] {
        &self.state.q
    }

    /// Velocity.
    pub fn v(&self) -> &[f64] {
        &self.state.v
    }

    /// Momentum `p = ∂L/∂v`.
    pub fn p(&self) -> &[f64] {
        &self.state.p
    }

    /// The inputs for the steps from here on, zero until they are set; constant over a step.
    pub fn inputs(&self) -> &[f64] {
        &self.state.inputs
    }

    /// The inputs for the steps from here on, to be set.
    pub fn inputs_mut(&mut self) -> &mut [f64] {
        &mut self.state.inputs
    }

    /// Number of steps taken.
    pub const fn steps(&self) -> u64 {
        self.steps
    }

    /// Newton's corrections under the steps taken. Every solve is the pivoted dense one: no fallbacks.
    pub const fn statistics(&self) -> Statistics {
        self.step.work.statistics
    }

    /// Energy `H = v·∂L/∂v − L` of the state reached.
    pub fn energy(&self) -> f64 {
        let GenericState { t, q, v, .. } = &self.state;
        // Along v itself, one infinitesimal gives v·∂L/∂v and L together.
        let position: Vec<_> = q.iter().map(|&q| Dual64::from_re(q)).collect();
        let velocity: Vec<_> = v.iter().map(|&v| Dual64::new(v, v)).collect();
        let value = self.system().lagrangian(Dual64::from_re(*t), &position, &velocity);
        value.eps - value.re
    }

    /// Constraint residuals `φ(t, q)`, in the units of the constraints as written.
    pub fn constraint_residual(&self) -> Vec<f64> {
        let mut residuals = vec![0.0; self.system().n_constraints()];
        self.system().constraints(self.state.t, &self.state.q, &mut residuals);
        residuals
    }

    /// Residuals of the hidden constraints, `|G v + ∂φ/∂t|ᵢ / (‖Gᵢ‖ ‖v‖ + |∂φᵢ/∂t|)`, without unit; 0 at rest.
    pub fn hidden_constraint_residual(&self) -> Vec<f64> {
        let GenericState { t, q, v, jacobian, .. } = &self.state;
        let system = self.system();
        let along_time: Vec<_> = q.iter().map(|&q| Dual64::from_re(q)).collect();
        let mut rates = vec![Dual64::from_re(0.0); system.n_constraints()];
        system.constraints(Dual64::from_re(*t).derivative(), &along_time, &mut rates);
        let speed = v.iter().map(|v| v * v).sum::<f64>().sqrt();
        let residual = |(c, rate): (usize, &Dual64)| {
            let along: f64 = (0..v.len()).map(|i| jacobian[(c, i)] * v[i]).sum();
            relative((along + rate.eps).abs(), jacobian.row(c).norm() * speed + rate.eps.abs())
        };
        rates.iter().enumerate().map(residual).collect()
    }

    /// Accelerations and multipliers of the continuous motion at the state reached, as
    /// [`Mechanics::acceleration`](crate::mechanics::Mechanics::acceleration) gives them; in buffers of the step.
    ///
    /// # Errors
    /// [`SingularMatrix`] where mass matrix and constraints do not determine the acceleration.
    pub fn acceleration(&mut self) -> Result<GenericAcceleration, SingularMatrix> {
        self.step.work.acceleration(&self.state)
    }

    /// Takes one step.
    ///
    /// # Errors
    /// [`StepError`]; the run then stands where it stood.
    pub fn advance(&mut self) -> Result<(), StepError> {
        self.step.step(&self.state, &mut self.next)?;
        self.steps += 1;
        // A product, since a sum of 1e6 step sizes loses six digits.
        self.next.t = self.start_time + self.steps as f64 * self.h;
        core::mem::swap(&mut self.state, &mut self.next);
        Ok(())
    }

    /// Takes steps until the next one would end beyond `t` by more than half a step.
    ///
    /// # Errors
    /// [`StepError`] of the first step that fails; the run stands before it. [`StepError::UnreachableTime`] before any
    /// step.
    pub fn advance_to(&mut self, t: f64) -> Result<(), StepError> {
        for _ in 0..steps_between(self.state.t, t, self.h)? {
            self.advance()?;
        }
        Ok(())
    }
}

impl<S: GenericSystem> Solver for GenericRun<S> {
    fn t(&self) -> f64 {
        Self::t(self)
    }

    fn q(&self) -> &[f64] {
        Self::q(self)
    }

    fn v(&self) -> &[f64] {
        Self::v(self)
    }

    fn p(&self) -> &[f64] {
        Self::p(self)
    }

    fn steps(&self) -> u64 {
        Self::steps(self)
    }

    fn advance_to(&mut self, t: f64) -> Result<(), Failure> {
        Self::advance_to(self, t)?;
        Ok(())
    }

    fn advance_visiting(&mut self, t: f64, visit: &mut dyn FnMut(&dyn Solver)) -> Result<(), Failure> {
        for _ in 0..steps_between(self.state.t, t, self.h)? {
            self.advance()?;
            visit(self);
        }
        Ok(())
    }
}
