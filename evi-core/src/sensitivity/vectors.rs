//! Derivatives at a state: vectors, which go forward, and gradients, which go back.

use std::vec::Vec;

use super::parameters::MovingConstants;
use crate::array::Array;
use crate::scalar::Tangent;
use crate::system::MechanicalSystem;

/// How a state changes along a direction: a vector tangent to the constraint manifold at the state, moved by the steps.
pub struct StateTangent<S: MechanicalSystem> {
    pub(super) q: S::PerCoordinate<f64>,
    pub(super) v: S::PerCoordinate<f64>,
    pub(super) p: S::PerCoordinate<f64>,
    pub(super) inputs: S::PerInput<f64>,
    pub(super) constants: MovingConstants<S>,
    /// Whether the constants move.
    pub(super) parameters_move: bool,
}

impl<S: MechanicalSystem> StateTangent<S> {
    /// Change of the configuration.
    pub const fn q(&self) -> &S::PerCoordinate<f64> {
        &self.q
    }

    /// Change of the velocity.
    pub const fn v(&self) -> &S::PerCoordinate<f64> {
        &self.v
    }

    /// Change of the momentum.
    pub const fn p(&self) -> &S::PerCoordinate<f64> {
        &self.p
    }

    /// The inputs of the steps from here on, changing along this direction.
    pub(super) fn moving_inputs(&self, inputs: &S::PerInput<f64>) -> S::PerInput<Tangent> {
        Array::from_fn(|k| Tangent::new(inputs[k], self.inputs[k]))
    }

    /// The constants, and whether they move.
    pub(super) const fn parts(&self) -> (&MovingConstants<S>, bool) {
        (&self.constants, self.parameters_move)
    }

    /// Whether every number is finite.
    pub(super) fn is_finite(&self) -> bool {
        [&self.q, &self.v, &self.p].iter().all(|part| part.as_ref().iter().all(|x| x.is_finite()))
    }
}

// Written out, since a derive would demand the same of `S`.
impl<S: MechanicalSystem> Clone for StateTangent<S> {
    fn clone(&self) -> Self {
        Self {
            q: self.q.clone(),
            v: self.v.clone(),
            p: self.p.clone(),
            inputs: self.inputs.clone(),
            constants: self.constants.clone(),
            parameters_move: self.parameters_move,
        }
    }
}

/// The derivatives of a number by a state, by the chosen parameters, and by the inputs of the step that begins at the state.
pub struct StateGradient<S: MechanicalSystem> {
    /// By the configuration, at fixed velocity and momentum.
    pub q: S::PerCoordinate<f64>,
    /// By the velocity.
    pub v: S::PerCoordinate<f64>,
    /// By the momentum, where the number is a function of it rather than of the velocity.
    pub p: S::PerCoordinate<f64>,
    /// By the inputs.
    pub inputs: S::PerInput<f64>,
    /// By the chosen parameters, in the order of their choice.
    pub parameters: Vec<f64>,
}

impl<S: MechanicalSystem> StateGradient<S> {
    /// No derivative by anything, for so many chosen parameters.
    pub fn zero(n_parameters: usize) -> Self {
        let none = S::PerCoordinate::<f64>::from_fn(|_| 0.0);
        Self {
            q: none.clone(),
            v: none.clone(),
            p: none,
            inputs: Array::from_fn(|_| 0.0),
            parameters: std::vec![0.0; n_parameters],
        }
    }

    /// Whether every number is finite.
    pub(super) fn is_finite(&self) -> bool {
        [&self.q, &self.v, &self.p].iter().all(|part| part.as_ref().iter().all(|x| x.is_finite()))
            && self.parameters.iter().chain(self.inputs.as_ref()).all(|x| x.is_finite())
    }
}
