//! Derivatives of a run: of its states, and of numbers made of them, by its start, parameters and inputs.
//!
//! In: a [`Simulation`](crate::integrator::Simulation) whose steps are [`Differentiable`]. Out, by the implicit function theorem on the equations that a step
//! has solved, and so exact for the discrete motion:
//!
//! - forward, for few directions and all states: [`TangentRun`];
//! - backwards, for one number and all that it follows from: [`Simulation::gradient_of`](crate::integrator::Simulation::gradient_of);

mod composition;
mod differentiable;
mod direction;
mod error;
mod evaluation;
mod evi;
mod gradient;
mod landing;
mod nodes;
mod parameters;
mod tangent_run;
mod vectors;

pub use differentiable::{Backwards, Differentiable};
pub use direction::Direction;
pub use error::DerivativeError;
pub use gradient::{Cost, Course, Gradient};
pub use nodes::TakenStep;
pub use parameters::ParameterChoice;
pub use tangent_run::{Differentiate, TangentRun};
pub use vectors::{StateGradient, StateTangent};
