//! A run with vectors that it carries along: derivatives forward, for few directions.

use std::vec::Vec;

use super::{DerivativeError, Differentiable, Direction, StateTangent};
use crate::integrator::{Run, Scheme, Simulation, StepError};
use crate::mechanics::State;
use crate::system::MechanicalSystem;

/// A run that carries tangent vectors along: the derivatives of its state along some [`Direction`]s.
///
/// The run itself takes the steps that it takes without them, to the last bit. A step costs one factorization more and, per direction, two
/// evaluations of the gradient of `L` on numbers with rates at every node.
///
/// ```
/// use evi_core::prelude::*;
/// use evi_core::sensitivity::{Differentiate, Direction};
/// # #[derive(MechanicalSystem)]
/// # #[evi(coordinates(x), kinetic = 0.5 * m * der(x).powi(2), potential = 0.5 * k * x.powi(2))]
/// # struct Oscillator { m: f64, k: f64 }
/// let simulation = Simulation::new(Oscillator { m: 2.0, k: 8.0 }, Evi::simpson(0.01));
/// let stiffer = Direction::of_parameter("k")?;
/// let mut run = simulation.start_with_tangents([1.0], [0.0], &[stiffer])?;
/// run.advance_to(1.0)?;
/// // x = cos ωt with ω² = k/m, of which the derivative by k is −sin ωt · t/(2 ω m).
/// assert!((run.tangents()[0].q()[0] + 2.0_f64.sin() / 8.0).abs() < 1e-4);
/// # Ok::<(), evi_core::sensitivity::DerivativeError>(())
/// ```
pub struct TangentRun<S: MechanicalSystem, M: Differentiable<S>> {
    run: Run<S, M>,
    tangents: Vec<StateTangent<S>>,
    /// The vectors that a step is moving: those of the state stand until it is taken.
    moving: Vec<StateTangent<S>>,
    workspace: M::Workspace,
}

/// Simulations whose steps have derivatives.
pub trait Differentiate<S: MechanicalSystem> {
    /// The one-step map.
    type Step: Differentiable<S>;

    /// A run from positions and velocities at time 0 that carries vectors along these directions.
    ///
    /// # Errors
    /// [`DerivativeError`]: the run does not start, the motion has fewer directions, or the scheme follows parameters that a direction changes.
    fn start_with_tangents(
        &self,
        q: impl Into<S::PerCoordinate<f64>>,
        v: impl Into<S::PerCoordinate<f64>>,
        directions: &[Direction<S>],
    ) -> Result<TangentRun<S, Self::Step>, DerivativeError>;

    /// A run of this simulation from where it stands, carrying vectors along these directions.
    ///
    /// # Errors
    /// As for [`start_with_tangents`](Self::start_with_tangents).
    fn with_tangents(
        &self,
        run: Run<S, Self::Step>,
        directions: &[Direction<S>],
    ) -> Result<TangentRun<S, Self::Step>, DerivativeError>;
}

impl<S: MechanicalSystem, F: Scheme<S, Step: Differentiable<S>>> Differentiate<S> for Simulation<S, F> {
    type Step = F::Step;

    fn start_with_tangents(
        &self,
        q: impl Into<S::PerCoordinate<f64>>,
        v: impl Into<S::PerCoordinate<f64>>,
        directions: &[Direction<S>],
    ) -> Result<TangentRun<S, F::Step>, DerivativeError> {
        self.with_tangents(self.start(q, v)?, directions)
    }

    fn with_tangents(
        &self,
        run: Run<S, F::Step>,
        directions: &[Direction<S>],
    ) -> Result<TangentRun<S, F::Step>, DerivativeError> {
        if directions.iter().any(Direction::moves_parameters) {
            run.map().check_parameters()?;
        }
        let vectors =
            directions.iter().map(|direction| direction.at(self.system(), run.mechanics(), run.state()));
        let tangents = vectors.collect::<Result<Vec<_>, _>>()?;
        Ok(TangentRun { workspace: run.map().workspace(), moving: tangents.clone(), tangents, run })
    }
}

impl<S: MechanicalSystem, M: Differentiable<S>> TangentRun<S, M> {
    /// The run.
    pub const fn run(&self) -> &Run<S, M> {
        &self.run
    }

    /// The state reached.
    pub const fn state(&self) -> &State<S> {
        self.run.state()
    }

    /// The derivatives of the state, in the order of the directions.
    pub fn tangents(&self) -> &[StateTangent<S>] {
        &self.tangents
    }

    pub(super) fn tangents_mut(&mut self) -> &mut [StateTangent<S>] {
        &mut self.tangents
    }

    /// Sets the inputs of the steps from here on, as [`Run::set_inputs`] does.
    pub fn set_inputs(&mut self, inputs: impl Into<S::PerInput<f64>>) {
        self.run.set_inputs(inputs);
    }

    /// Sets how the inputs of the steps from here on change along a direction.
    ///
    /// # Panics
    /// If there is no such direction.
    pub fn set_input_rates(&mut self, direction: usize, rates: impl Into<S::PerInput<f64>>) {
        self.tangents[direction].inputs = rates.into();
    }

    /// Takes one step.
    ///
    /// # Errors
    /// [`DerivativeError`]; state and vectors stand where they stood.
    pub fn advance(&mut self) -> Result<&State<S>, DerivativeError> {
        let Self { run, tangents, moving, workspace } = self;
        for (moving, tangent) in moving.iter_mut().zip(&*tangents) {
            moving.clone_from(tangent);
        }
        run.advance_by(|map, state, tally| {
            let mut end = state.clone();
            let taken = map.advance_taking_notes(workspace, &mut end, tally)?;
            map.push_forward(workspace, &taken, moving)?;
            if !moving.iter().all(StateTangent::is_finite) {
                return Err(DerivativeError::NotFinite { t: end.t });
            }
            *state = end;
            Ok(())
        })?;
        core::mem::swap(tangents, moving);
        Ok(self.run.state())
    }

    /// Takes steps until the next one would end beyond `t` by more than half a step.
    ///
    /// # Errors
    /// [`DerivativeError`] of the first step that fails; state and vectors are those before it.
    pub fn advance_to(&mut self, t: f64) -> Result<&State<S>, DerivativeError> {
        for _ in 0..self.steps_to(t)? {
            self.advance()?;
        }
        Ok(self.run.state())
    }

    pub(super) fn steps_to(&self, t: f64) -> Result<u64, StepError> {
        self.run.steps_to(t)
    }

    /// Step size.
    pub fn h(&self) -> f64 {
        self.run.map().h()
    }
}
