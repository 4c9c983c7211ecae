//! What a run is differentiated along: changes of its start, of parameters, of inputs.

use super::landing::{Landing, Moved};
use super::parameters::{moving_constants, parameter_index};
use super::{DerivativeError, StateTangent};
use crate::array::Array;
use crate::mechanics::{Mechanics, State};
use crate::system::MechanicalSystem;

/// A direction in the space of all that a run follows from: positions and velocities (or momenta) of its start, parameters, inputs.
///
/// On constrained scenes the start moves along the manifold: what a direction says of it is projected, in the metric of the mass, as
/// [`Simulation::start_projected`](crate::integrator::Simulation::start_projected) projects a start. So a rod that grows carries its mass with it.
///
/// ```
/// use evi_core::prelude::*;
/// use evi_core::sensitivity::Direction;
/// # #[derive(MechanicalSystem)]
/// # #[evi(coordinates(x), kinetic = 0.5 * m * der(x).powi(2), potential = 0.5 * k * x.powi(2))]
/// # struct Oscillator { m: f64, k: f64 }
/// let faster = Direction::<Oscillator>::of_start([0.0], [1.0]);
/// let stiffer = Direction::<Oscillator>::of_parameter("k")?;
/// # let _ = (faster, stiffer);
/// # Ok::<(), evi_core::sensitivity::DerivativeError>(())
/// ```
pub struct Direction<S: MechanicalSystem> {
    q: S::PerCoordinate<f64>,
    motion: Motion<S>,
    parameters: S::PerParameter<f64>,
    inputs: S::PerInput<f64>,
}

enum Motion<S: MechanicalSystem> {
    Velocity(S::PerCoordinate<f64>),
    Momentum(S::PerCoordinate<f64>),
}

impl<S: MechanicalSystem> Direction<S> {
    fn with_motion(q: S::PerCoordinate<f64>, motion: Motion<S>) -> Self {
        Self { q, motion, parameters: Array::from_fn(|_| 0.0), inputs: Array::from_fn(|_| 0.0) }
    }

    /// Changes of positions and velocities at the start.
    pub fn of_start(q: impl Into<S::PerCoordinate<f64>>, v: impl Into<S::PerCoordinate<f64>>) -> Self {
        Self::with_motion(q.into(), Motion::Velocity(v.into()))
    }

    /// Changes of positions and momenta at the start.
    pub fn of_phase(q: impl Into<S::PerCoordinate<f64>>, p: impl Into<S::PerCoordinate<f64>>) -> Self {
        Self::with_motion(q.into(), Motion::Momentum(p.into()))
    }

    fn at_rest() -> Self {
        let none = || Array::from_fn(|_| 0.0);
        Self::with_motion(none(), Motion::Velocity(none()))
    }

    /// The change of a parameter by one unit.
    ///
    /// # Errors
    /// [`DerivativeError::UnknownParameter`] for a name that the equations of the scene do not use.
    pub fn of_parameter(name: &str) -> Result<Self, DerivativeError> {
        let index = parameter_index::<S>(name)?;
        let mut direction = Self::at_rest();
        direction.parameters[index] = 1.0;
        Ok(direction)
    }

    /// Changes of the inputs of every step.
    pub fn of_inputs(inputs: impl Into<S::PerInput<f64>>) -> Self {
        Self { inputs: inputs.into(), ..Self::at_rest() }
    }

    /// The same direction with these changes of the parameters, in the order of [`PARAMETERS`](MechanicalSystem::PARAMETERS).
    #[must_use]
    pub fn with_parameters(self, parameters: impl Into<S::PerParameter<f64>>) -> Self {
        Self { parameters: parameters.into(), ..self }
    }

    pub(super) fn moves_parameters(&self) -> bool {
        // Equality to the exact zero of what was not asked for.
        self.parameters.as_ref().iter().any(|rate| *rate != 0.0)
    }

    /// The vector at the start of a run.
    pub(super) fn at(
        &self,
        system: &S,
        mechanics: &Mechanics<S>,
        state: &State<S>,
    ) -> Result<StateTangent<S>, DerivativeError> {
        let landing = Landing::new(mechanics, None, state)?;
        let constants = moving_constants(system, &self.parameters);
        let moving = (&constants, self.moves_parameters());
        let mut q = self.q.clone();
        let none = S::PerCoordinate::<f64>::from_fn(|_| 0.0);
        let Moved { mut v, mut p } = match &self.motion {
            Motion::Velocity(v) => landing.start(moving, &mut q, v),
            Motion::Momentum(_) => landing.start(moving, &mut q, &none),
        };
        if let Motion::Momentum(arriving) = &self.motion {
            let unmoved = Array::from_fn(|_| 0.0);
            Moved { v, p } = landing.forward(moving, &unmoved, &q, arriving);
        }
        let parameters_move = self.moves_parameters();
        let tangent = StateTangent { q, v, p, inputs: self.inputs.clone(), constants, parameters_move };
        if tangent.is_finite() { Ok(tangent) } else { Err(DerivativeError::NotFinite { t: state.t }) }
    }
}
