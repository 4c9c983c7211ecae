//! An assembled scene at a state.

use super::assembly::{Assembly, ConstraintsAt, Point};
use super::scene::PreparedScene;
use super::{AssembledState, AssembledStep, AssembledSystem};
use crate::integrator::{Fallbacks, StepError, Tally, steps_between};
use crate::mechanics::{norm, relative};

/// A one-step map, the scene that it moves, and the state that it has reached.
///
/// A step that fails leaves the run at the last state that was reached. Nothing is allocated under a step.
pub struct AssembledRun<S, M, T = Fallbacks> {
    pub(super) system: S,
    pub(super) scene: PreparedScene,
    pub(super) map: M,
    pub(super) state: AssembledState,
    pub(super) steps: u64,
    pub(super) tally: T,
}

impl<S: AssembledSystem, M: AssembledStep> AssembledRun<S, M> {
    pub(super) fn new(system: S, scene: PreparedScene, map: M, state: AssembledState) -> Self {
        Self { system, scene, map, state, steps: 0, tally: Fallbacks::default() }
    }
}

impl<S: AssembledSystem, M: AssembledStep, T: Tally> AssembledRun<S, M, T> {
    /// The run from where it stands, with another tally of what happens inside its steps.
    pub fn with_tally<U: Tally>(self, tally: U) -> AssembledRun<S, M, U> {
        let Self { system, scene, map, state, steps, .. } = self;
        AssembledRun { system, scene, map, state, steps, tally }
    }

    /// What has happened inside the steps, the failed one included.
    pub const fn tally(&self) -> &T {
        &self.tally
    }

    /// The scene as it was written.
    pub const fn system(&self) -> &S {
        &self.system
    }

    /// The state reached.
    pub const fn state(&self) -> &AssembledState {
        &self.state
    }

    /// Number of steps taken.
    pub const fn steps(&self) -> u64 {
        self.steps
    }

    /// The one-step map.
    pub const fn map(&self) -> &M {
        &self.map
    }

    /// Takes one step.
    ///
    /// # Errors
    /// [`StepError`]; the run then stands where it stood.
    pub fn advance(&mut self) -> Result<&AssembledState, StepError> {
        self.tally.begin_step(self.steps);
        self.map.advance(&mut self.scene, &mut self.state, &mut self.tally)?;
        self.steps += 1;
        Ok(&self.state)
    }

    /// Takes the whole number of steps that leads nearest to `t`.
    ///
    /// # Errors
    /// [`StepError`]; the run then stands at the last state that was reached.
    pub fn advance_to(&mut self, t: f64) -> Result<&AssembledState, StepError> {
        for _ in 0..self.steps_to(t)? {
            self.advance()?;
        }
        Ok(&self.state)
    }

    /// As [`advance_to`](Self::advance_to), with `see` called after every `steps` steps: trajectories of large scenes are sampled, not kept whole.
    ///
    /// # Errors
    /// What `see` returns, or the [`StepError`] of a step, of which the caller's error is made.
    pub fn advance_sampled<E: From<StepError>>(
        &mut self,
        t: f64,
        steps: u64,
        mut see: impl FnMut(&Self) -> Result<(), E>,
    ) -> Result<&AssembledState, E> {
        for _ in 0..self.steps_to(t)? {
            self.advance()?;
            if self.steps.is_multiple_of(steps) {
                see(self)?;
            }
        }
        Ok(&self.state)
    }

    /// Number of steps that lead nearest to `t`: what an [`advance_to`](Self::advance_to) takes.
    ///
    /// # Errors
    /// [`StepError`] for a time that steps do not lead to.
    pub fn steps_to(&self, t: f64) -> Result<u64, StepError> {
        steps_between(self.state.t, t, self.map.h())
    }

    /// Sets the inputs of the steps to come, in the order of [`INPUTS`](AssembledSystem::INPUTS); they are constant over a step, and zero at the start.
    ///
    /// # Panics
    /// If these are not as many as the scene has.
    pub fn set_inputs(&mut self, inputs: &[f64]) {
        self.state.inputs.copy_from_slice(inputs);
        self.scene.set_inputs(inputs);
    }

    /// The observed quantities of the state reached, in the order of [`OBSERVABLES`](AssembledSystem::OBSERVABLES).
    pub fn observe(&self) -> Vec<f64> {
        let AssembledState { t, q, v, inputs, .. } = &self.state;
        let mut quantities = vec![0.0; S::OBSERVABLES.len()];
        self.scene.assembly.observe(Point { t: *t, q, v }, inputs, &mut quantities);
        quantities
    }

    /// Energy `H = v · ∂L/∂v − L` of the state reached.
    pub fn energy(&self) -> f64 {
        self.scene.assembly.energy(Point { t: self.state.t, q: &self.state.q, v: &self.state.v })
    }

    /// The largest constraint residual `|φ(t, q)|` of the state reached, in the units of the constraints as written.
    pub fn constraint_error(&self) -> f64 {
        crate::linear::largest_magnitude(self.constraint_residual())
    }

    /// `φ(t, q)` of the state reached.
    pub(crate) fn constraint_residual(&self) -> Vec<f64> {
        let assembly = &self.scene.assembly;
        let mut values = vec![0.0; assembly.n_constraints];
        assembly.constraints(self.state.t, &self.state.q, &mut values);
        values
    }

    /// The largest residual of the hidden constraints, `|G v + ∂φ/∂t| / (‖G‖ ‖v‖ + |∂φ/∂t|)`, without unit; 0 at rest.
    pub fn hidden_constraint_error(&self) -> f64 {
        crate::linear::largest_magnitude(self.hidden_constraint_residual())
    }

    /// `|G v + ∂φ/∂t| / (‖G‖ ‖v‖ + |∂φ/∂t|)` of every constraint at the state reached.
    pub(crate) fn hidden_constraint_residual(&self) -> Vec<f64> {
        let AssembledState { t, q, v, .. } = &self.state;
        hidden_residuals(&self.scene.assembly, *t, q, v)
    }
}

/// `|G v + ∂φ/∂t| / (‖G‖ ‖v‖ + |∂φ/∂t|)` of every constraint.
pub(super) fn hidden_residuals(assembly: &Assembly, t: f64, q: &[f64], v: &[f64]) -> Vec<f64> {
    let mut at = ConstraintsAt::of(assembly);
    assembly.constraint_derivatives(t, q, &mut at);
    let mut rates = at.rates.clone();
    assembly.add_rates(&at.slopes, v, &mut rates);
    let speed = norm(v);
    let scales = assembly.gradient_norms(&at.slopes);
    let residual = |c: usize| relative(rates[c].abs(), scales[c] * speed + at.rates[c].abs());
    (0..assembly.n_constraints).map(residual).collect()
}
