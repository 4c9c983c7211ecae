//! A simulation at a state.

#[cfg(feature = "std")]
use super::trajectory::{Interrupted, Trajectory};
use super::{OneStep, StepError, Tally};
#[cfg(feature = "std")]
use crate::comparison::{Failure, Solver};
use crate::mechanics::{Mechanics, State};
use crate::newton::Fallbacks;
use crate::system::MechanicalSystem;

/// Number of whole steps of size `h` nearest to the span from `t` to `target`.
///
/// # Errors
/// [`StepError::OppositeTime`] if `target` lies a step or more on the other side, [`StepError::UnreachableTime`] if no number of
/// steps leads there.
pub(crate) fn steps_between(t: f64, target: f64, h: f64) -> Result<u64, StepError> {
    /// Up to here every whole number is a float.
    const MOST_STEPS: f64 = (1_u64 << f64::MANTISSA_DIGITS) as f64;
    let steps = (target - t) / h;
    let is_reachable = steps.abs() < MOST_STEPS;
    if !is_reachable {
        Err(StepError::UnreachableTime { target, h })
    } else if steps <= -1.0 {
        Err(StepError::OppositeTime { t, target, h })
    } else {
        // The cast saturates: what is behind by less than a step is 0.
        Ok((steps + 0.5) as u64)
    }
}

/// A one-step map and the state that it has reached.
///
/// A step that fails leaves the run at the last state that was reached.
pub struct Run<S: MechanicalSystem, M, T = Fallbacks> {
    map: M,
    /// Of the map, which may be asked for its own in the middle of a step: what is read once need not be kept until its end.
    h: f64,
    state: State<S>,
    start_time: f64,
    steps: u64,
    tally: T,
}

impl<S: MechanicalSystem, M: OneStep<S>> Run<S, M> {
    pub(crate) fn new(map: M, state: State<S>) -> Self {
        let start_time = state.t;
        Self { h: map.h(), map, state, start_time, steps: 0, tally: Fallbacks::default() }
    }
}

impl<S: MechanicalSystem, M: OneStep<S>, T: Tally> Run<S, M, T> {
    /// The run that has come from `start_time` to `state` in so many steps.
    #[cfg(feature = "std")]
    pub(super) fn resumed(map: M, state: State<S>, start_time: f64, steps: u64, tally: T) -> Self {
        Self { h: map.h(), map, state, start_time, steps, tally }
    }

    /// Time of the state that the run has started from.
    pub const fn start_time(&self) -> f64 {
        self.start_time
    }

    /// The run from where it stands, with another tally of what happens inside its steps:
    /// `run.with_tally(Statistics::default())` counts Newton's corrections too.
    pub fn with_tally<U: Tally>(self, tally: U) -> Run<S, M, U> {
        let Self { map, h, state, start_time, steps, .. } = self;
        Run { map, h, state, start_time, steps, tally }
    }

    /// What has happened inside the steps, the failed one included; without more ado, how often the pivoted dense solve had to help.
    pub const fn tally(&self) -> &T {
        &self.tally
    }

    /// The state reached.
    pub const fn state(&self) -> &State<S> {
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

    /// The scene's mechanics: energies, residuals, accelerations as functions of a state.
    pub fn mechanics(&self) -> &Mechanics<S> {
        self.map.mechanics()
    }

    /// Energy of the state reached.
    pub fn energy(&self) -> f64 {
        self.mechanics().energy(&self.state)
    }

    /// The quantities that the scene observes, by its items `observe`, at the state reached; in the order of
    /// [`OBSERVABLES`](MechanicalSystem::OBSERVABLES).
    pub fn observe(&self) -> S::PerObservable<f64> {
        self.mechanics().observe(&self.state)
    }

    /// Sets the scene's inputs, in the order of [`INPUTS`](MechanicalSystem::INPUTS), for the steps from here on.
    ///
    /// Inputs are constant over a step, as the output of a digital controller is. A smooth signal `u(t)` is sampled at the
    /// middle of the step, `u(t + ½h)`: that is of second order, sampling at its start of first order. A signal that
    /// is a formula of `t` is better written into the force itself. A step with inputs that are not finite fails.
    ///
    /// ```
    /// use evi_core::prelude::*;
    /// #[derive(MechanicalSystem)]
    /// #[evi(
    ///     coordinates(x),
    ///     kinetic = 0.5 * m * der(x).powi(2),
    ///     potential = 0.0,
    ///     input(thrust),
    ///     force(x: thrust),
    /// )]
    /// struct Cart { m: f64 }
    /// let mut run = Simulation::new(Cart { m: 2.0 }, Evi::midpoint(0.1)).start([0.0], [0.0])?;
    /// for _ in 0..100 {
    ///     let away = 1.0 - run.state().q()[0];
    ///     run.set_inputs([2.0 * away - 3.0 * run.state().v()[0]]);
    ///     run.advance()?;
    /// }
    /// assert!((run.state().q()[0] - 1.0).abs() < 1e-2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn set_inputs(&mut self, inputs: impl Into<S::PerInput<f64>>) {
        self.state.inputs = inputs.into();
    }

    /// The scene's inputs for the steps from here on, to change one by one; as for [`set_inputs`](Self::set_inputs).
    pub fn inputs_mut(&mut self) -> &mut S::PerInput<f64> {
        &mut self.state.inputs
    }

    /// Takes one step.
    ///
    /// # Errors
    /// [`StepError`]; the run then stands where it stood.
    #[inline]
    pub fn advance(&mut self) -> Result<&State<S>, StepError> {
        self.advance_by(|map, state, tally| map.advance(state, tally))?;
        Ok(&self.state)
    }

    /// Takes one step, as `take` does it.
    #[inline(always)]
    pub(crate) fn advance_by<R, E: From<StepError>>(
        &mut self,
        take: impl FnOnce(&mut M, &mut State<S>, &mut T) -> Result<R, E>,
    ) -> Result<R, E> {
        if S::N_INPUTS > 0 {
            self.check_inputs()?;
        }
        self.tally.begin_step(self.steps);
        let taken = take(&mut self.map, &mut self.state, &mut self.tally)?;
        self.steps += 1;
        // A product, since a sum of 1e6 step sizes loses six digits.
        // The cast of a signed number is one instruction; no run has 2⁶³ steps.
        self.state.t = self.start_time + self.steps as i64 as f64 * self.h;
        Ok(taken)
    }

    /// Overwrites the state, the memory of the map and the number of steps taken with those of an earlier moment of this run.
    #[cfg(feature = "std")]
    pub(crate) fn go_back(&mut self, steps: u64, recall: impl FnOnce(&mut M, &mut State<S>)) {
        recall(&mut self.map, &mut self.state);
        self.steps = steps;
    }

    /// Refuses inputs that are not finite.
    fn check_inputs(&self) -> Result<(), StepError> {
        for (name, &value) in S::INPUTS.iter().zip(self.state.inputs.as_ref()) {
            if !value.is_finite() {
                return Err(StepError::Input { name, value });
            }
        }
        Ok(())
    }

    /// Takes steps until the next one would end beyond `t` by more than half a step.
    ///
    /// # Errors
    /// [`StepError`] of the first step that fails; the run stands before it. [`StepError::UnreachableTime`] and
    /// [`StepError::OppositeTime`] before any step.
    pub fn advance_to(&mut self, t: f64) -> Result<&State<S>, StepError> {
        for _ in 0..self.steps_to(t)? {
            self.advance()?;
        }
        Ok(&self.state)
    }

    /// Takes the steps of a time span and keeps every state with its observed quantities, the present one first.
    ///
    /// # Errors
    /// [`Interrupted`] with the states up to the step that failed.
    #[cfg(feature = "std")]
    pub fn integrate(&mut self, duration: f64) -> Result<Trajectory<S>, Interrupted<S>> {
        let (steps, unreachable) = match self.steps_to(self.state.t + duration) {
            Ok(steps) => (steps, None),
            Err(error) => (0, Some(error)),
        };
        let mut trajectory = Trajectory::expecting(steps);
        trajectory.push(self.state.clone(), self.observe());
        if let Some(error) = unreachable {
            return Err(Interrupted { error, trajectory });
        }
        for _ in 0..steps {
            if let Err(error) = self.advance() {
                return Err(Interrupted { error, trajectory });
            }
            trajectory.push(self.state.clone(), self.observe());
        }
        Ok(trajectory)
    }

    /// Number of whole steps nearest to the span from here to `t`.
    pub(crate) fn steps_to(&self, t: f64) -> Result<u64, StepError> {
        steps_between(self.state.t, t, self.map.h())
    }
}

#[cfg(feature = "std")]
impl<S: MechanicalSystem, M: OneStep<S>, T: Tally> Solver for Run<S, M, T> {
    fn t(&self) -> f64 {
        self.state.t
    }

    fn q(&self) -> &[f64] {
        self.state.q.as_ref()
    }

    fn v(&self) -> &[f64] {
        self.state.v.as_ref()
    }

    fn p(&self) -> &[f64] {
        self.state.p.as_ref()
    }

    fn steps(&self) -> u64 {
        self.steps
    }

    fn advance_to(&mut self, t: f64) -> Result<(), Failure> {
        Run::advance_to(self, t)?;
        Ok(())
    }

    fn advance_visiting(&mut self, t: f64, visit: &mut dyn FnMut(&dyn Solver)) -> Result<(), Failure> {
        for _ in 0..self.steps_to(t)? {
            self.advance()?;
            visit(self);
        }
        Ok(())
    }
}
