//! A run as a function of a list of numbers, with its gradient: what optimizers ask for.

use std::vec::Vec;

use super::{Cost, Course, DerivativeError, Differentiable, Gradient};
use crate::integrator::{Scheme, Simulation};
use crate::system::MechanicalSystem;

/// How a list of numbers (parameters, a start, inputs) becomes a run, and how the gradient of the run becomes one by the numbers.
pub trait Design {
    /// The scene.
    type System: MechanicalSystem;
    /// The scheme.
    type Scheme: Scheme<Self::System, Step: Differentiable<Self::System>>;

    /// The simulation of the numbers.
    fn simulation(&self, x: &[f64]) -> Simulation<Self::System, Self::Scheme>;

    /// Its course.
    fn course(&self, x: &[f64]) -> Course<Self::System>;

    /// What is to become small.
    fn cost(&self, x: &[f64]) -> impl Cost<Self::System>;

    /// The derivatives of the cost by the numbers, from those by start, parameters and inputs: the chain rule over the functions above.
    fn chain(&self, x: &[f64], gradient: &Gradient<Self::System>) -> Vec<f64>;
}

/// The cost of a [`Design`] as a function with a gradient.
///
/// With the feature `argmin` it is a `CostFunction` and a `Gradient` of the crate argmin. There a run that does not start, or a step that has no solution,
/// costs infinity, so that a line search turns back; other failures are errors.
#[derive(Clone, Copy, Debug)]
pub struct Objective<D>(pub D);

impl<D: Design> Objective<D> {
    /// The cost: one run.
    ///
    /// # Errors
    /// [`DerivativeError`] of a run that does not start, or of the first step that fails.
    pub fn value(&self, x: &[f64]) -> Result<f64, DerivativeError> {
        self.0.simulation(x).cost_of(&self.0.course(x), &self.0.cost(x))
    }

    /// The cost and its gradient: some runs (see [`Simulation::gradient_of`]).
    ///
    /// # Errors
    /// As for [`value`](Self::value), and where a step has no derivative.
    pub fn value_and_gradient(&self, x: &[f64]) -> Result<(f64, Vec<f64>), DerivativeError> {
        let gradient = self.0.simulation(x).gradient_of(&self.0.course(x), &self.0.cost(x))?;
        Ok((gradient.cost, self.0.chain(x, &gradient)))
    }
}

#[cfg(feature = "argmin")]
mod hooks {
    use std::vec::Vec;

    use super::{Design, Objective};
    use crate::sensitivity::DerivativeError;

    impl<D: Design> argmin::core::CostFunction for Objective<D> {
        type Param = Vec<f64>;
        type Output = f64;

        fn cost(&self, x: &Vec<f64>) -> Result<f64, argmin::core::Error> {
            match self.value(x) {
                Ok(value) => Ok(value),
                Err(DerivativeError::Start(_) | DerivativeError::Step(_)) => Ok(f64::INFINITY),
                Err(error) => Err(error.into()),
            }
        }
    }

    impl<D: Design> argmin::core::Gradient for Objective<D> {
        type Param = Vec<f64>;
        type Gradient = Vec<f64>;

        fn gradient(&self, x: &Vec<f64>) -> Result<Vec<f64>, argmin::core::Error> {
            Ok(self.value_and_gradient(x)?.1)
        }
    }
}
