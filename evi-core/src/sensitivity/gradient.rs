//! The gradient of a number that is made of the states of a run, by going back over its steps once.
//!
//! The discrete adjoint: a gradient at the end of a step becomes one at its start through the transposed derivative of the step. The states on the way back are
//! those of the way there: the run is kept at every `√N`th of its `N` steps, and taken from there again, to the last bit, a stretch of `√N` steps at
//! a time (two levels of Griewank & Walther, ACM Trans. Math. Softw. 26 (2000) 19). So at most `2 √N + 1` states are kept, and no step is taken more than twice.

use std::vec::Vec;

use super::landing::Landing;
use super::parameters::Seeds;
use super::{Backwards, DerivativeError, Differentiable, ParameterChoice, StateGradient};
use crate::integrator::{Run, Scheme, Simulation};
use crate::mechanics::State;
use crate::memory::{Memory, Recall, Record};
use crate::system::MechanicalSystem;

/// A number made of the states of a run: a sum of what each of them adds.
///
/// Implemented for closures `Fn(u64, &State<S>, &mut StateGradient<S>) -> f64`.
pub trait Cost<S: MechanicalSystem> {
    /// What the state after so many steps adds to the number. Its derivatives are added to `gradient`: by `q` and `v` of the state (or by its `p`, in the place of
    /// `v`), by the inputs of the step that begins at the state, and by the chosen parameters themselves.
    fn add(&self, steps: u64, state: &State<S>, gradient: &mut StateGradient<S>) -> f64;
}

impl<S: MechanicalSystem, F: Fn(u64, &State<S>, &mut StateGradient<S>) -> f64> Cost<S> for F {
    fn add(&self, steps: u64, state: &State<S>, gradient: &mut StateGradient<S>) -> f64 {
        self(steps, state, gradient)
    }
}

/// A run from a start over a number of steps, and what a number made of it is differentiated by beside the start.
pub struct Course<S: MechanicalSystem> {
    q: S::PerCoordinate<f64>,
    v: S::PerCoordinate<f64>,
    steps: u64,
    inputs: Vec<S::PerInput<f64>>,
    parameters: ParameterChoice,
}

impl<S: MechanicalSystem> Course<S> {
    /// From positions and velocities at time 0, on the constraints, over so many steps.
    pub fn new(q: impl Into<S::PerCoordinate<f64>>, v: impl Into<S::PerCoordinate<f64>>, steps: u64) -> Self {
        let (q, v) = (q.into(), v.into());
        Self { q, v, steps, inputs: Vec::new(), parameters: ParameterChoice::none() }
    }

    /// The same course with these inputs, for every step its own.
    #[must_use]
    pub fn with_inputs(self, inputs: Vec<S::PerInput<f64>>) -> Self {
        Self { inputs, ..self }
    }

    /// The same course, to be differentiated by these parameters.
    #[must_use]
    pub fn by_parameters(self, parameters: ParameterChoice) -> Self {
        Self { parameters, ..self }
    }

    fn check(&self) -> Result<(), DerivativeError> {
        let found = self.inputs.len();
        match usize::try_from(self.steps) {
            Ok(steps) if found != 0 && found != steps => Err(DerivativeError::InputCount { steps, found }),
            _ => Ok(()),
        }
    }

    /// Sets the inputs of the step after so many.
    fn set_inputs<M: Differentiable<S>>(&self, run: &mut Run<S, M>, steps: u64) {
        if let Some(inputs) = usize::try_from(steps).ok().and_then(|step| self.inputs.get(step)) {
            *run.inputs_mut() = inputs.clone();
        }
    }
}

/// A number made of the states of a run, with its derivatives.
pub struct Gradient<S: MechanicalSystem> {
    /// The number.
    pub cost: f64,
    /// Its derivatives by positions and velocities of the start, which is projected on the constraints where they move, and by the chosen parameters in
    /// the order of their choice.
    pub start: StateGradient<S>,
    /// Its derivatives by the inputs of every step; empty without inputs.
    pub inputs: Vec<S::PerInput<f64>>,
    /// Steps taken for it, those that were taken again included.
    pub steps_taken: u64,
    /// The largest number of states that were kept at once.
    pub states_kept: usize,
}

impl<S: MechanicalSystem, F: Scheme<S, Step: Differentiable<S>>> Simulation<S, F> {
    /// The number of a course alone: one run.
    ///
    /// # Errors
    /// [`DerivativeError`] of a run that does not start, or of the first step that fails.
    pub fn cost_of(&self, course: &Course<S>, cost: &impl Cost<S>) -> Result<f64, DerivativeError> {
        course.check()?;
        let mut run = self.start(course.q.clone(), course.v.clone())?;
        let mut unwanted = StateGradient::zero(course.parameters.len());
        let mut sum = 0.0;
        for step in 0..course.steps {
            course.set_inputs(&mut run, step);
            sum += cost.add(step, run.state(), &mut unwanted);
            run.advance()?;
        }
        Ok(sum + cost.add(course.steps, run.state(), &mut unwanted))
    }

    /// The number of a course with all of its derivatives: in the time of three to five runs, of which five parameters take up to one.
    ///
    /// # Errors
    /// As for [`cost_of`](Self::cost_of); and where the equations of a step do not determine its derivative.
    pub fn gradient_of(
        &self,
        course: &Course<S>,
        cost: &impl Cost<S>,
    ) -> Result<Gradient<S>, DerivativeError> {
        course.check()?;
        let run = self.start(course.q.clone(), course.v.clone())?;
        if !course.parameters.is_empty() {
            run.map().check_parameters()?;
        }
        let start = run.state().clone();
        let seeds = Seeds::new(self.system(), run.mechanics(), &course.parameters, &start);
        let mut sweep = Sweep {
            workspace: run.map().workspace(),
            gradient: StateGradient::zero(seeds.n_parameters),
            inputs: Vec::new(),
            stretch: Vec::new(),
            run,
            course,
            cost,
            seeds: &seeds,
        };
        let mut gradient = sweep.there_and_back()?;
        let landing = Landing::new(sweep.run.mechanics(), None, &start)?;
        landing.back_to_start(&seeds, &mut gradient.start);
        if gradient.start.is_finite() { Ok(gradient) } else { Err(DerivativeError::NotFinite { t: start.t }) }
    }
}

/// A run, with what is kept of it on the way there and back.
struct Sweep<'a, S: MechanicalSystem, M: Differentiable<S>, C> {
    run: Run<S, M>,
    course: &'a Course<S>,
    cost: &'a C,
    seeds: &'a Seeds<S>,
    workspace: M::Workspace,
    gradient: StateGradient<S>,
    inputs: Vec<S::PerInput<f64>>,
    /// The steps of the stretch that is gone back over, each with its start.
    stretch: Vec<(State<S>, M::Taken)>,
}

/// State and memory of a run, as words.
struct Kept {
    steps: u64,
    words: Vec<u64>,
}

impl<S: MechanicalSystem, M: Differentiable<S>, C: Cost<S>> Sweep<'_, S, M, C> {
    fn there_and_back(&mut self) -> Result<Gradient<S>, DerivativeError> {
        let steps = self.course.steps;
        let length = steps.isqrt().max(1);
        let mut unwanted = StateGradient::zero(self.seeds.n_parameters);
        let mut sum = 0.0;
        let mut kept = Vec::new();
        // The last stretch is gone over with notes at once.
        let last = steps.saturating_sub(1) / length * length;
        for step in 0..last {
            if step % length == 0 {
                kept.push(self.keep());
            }
            self.course.set_inputs(&mut self.run, step);
            sum += self.cost.add(step, self.run.state(), &mut unwanted);
            self.run.advance()?;
        }
        sum += self.take_notes(steps)?;
        sum += self.cost.add(steps, self.run.state(), &mut self.gradient);
        let mut states_kept = kept.len() + self.stretch.len() + 1;
        let mut steps_taken = steps;
        self.go_back()?;
        while let Some(Kept { steps: from, words }) = kept.pop() {
            let mut words = words.into_iter();
            let mut source = || words.next().unwrap_or_default();
            self.run.go_back(from, |map, state| {
                let mut words = Recall::from(&mut source);
                state.recall(&mut words);
                map.recall(&mut words);
            });
            self.take_notes(from + length)?;
            states_kept = states_kept.max(kept.len() + self.stretch.len() + 1);
            steps_taken += length;
            self.go_back()?;
        }
        self.inputs.reverse();
        let start = core::mem::replace(&mut self.gradient, StateGradient::zero(0));
        let inputs = core::mem::take(&mut self.inputs);
        Ok(Gradient { cost: sum, start, inputs, steps_taken, states_kept })
    }

    fn keep(&self) -> Kept {
        let mut words = Vec::new();
        let mut sink = |word| words.push(word);
        let mut record = Record::to(&mut sink);
        self.run.state().record(&mut record);
        self.run.map().record(&mut record);
        Kept { steps: self.run.steps(), words }
    }

    /// Takes the steps up to so many with notes, and returns what their starts add to the cost.
    fn take_notes(&mut self, until: u64) -> Result<f64, DerivativeError> {
        let mut unwanted = StateGradient::zero(self.seeds.n_parameters);
        let mut sum = 0.0;
        for step in self.run.steps()..until {
            self.course.set_inputs(&mut self.run, step);
            let start = self.run.state().clone();
            sum += self.cost.add(step, &start, &mut unwanted);
            let workspace = &mut self.workspace;
            let taken =
                self.run.advance_by(|map, state, tally| map.advance_taking_notes(workspace, state, tally))?;
            self.stretch.push((start, taken));
        }
        Ok(sum)
    }

    /// Moves the gradient at the end of the stretch to its start.
    fn go_back(&mut self) -> Result<(), DerivativeError> {
        let mut step = self.run.steps();
        while let Some((start, taken)) = self.stretch.pop() {
            step -= 1;
            self.run.map().pull_back(
                &mut self.workspace,
                &taken,
                &Backwards(self.seeds),
                &mut self.gradient,
            )?;
            self.cost.add(step, &start, &mut self.gradient);
            if S::N_INPUTS > 0 {
                self.inputs.push(self.gradient.inputs.clone());
                self.gradient.inputs = crate::array::Array::from_fn(|_| 0.0);
            }
        }
        Ok(())
    }
}
