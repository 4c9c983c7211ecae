//! Derivatives of a run: of its states, and of numbers made of them, by its start, parameters and inputs.
//!
//! In: a [`Simulation`](crate::integrator::Simulation) whose steps are [`Differentiable`]. Out, by the implicit function theorem on the equations that a step
//! has solved, and so exact for the discrete motion:
//!
//! - forward, for few directions and all states: [`TangentRun`];
//! - backwards, for one number and all that it follows from: [`Simulation::gradient_of`](crate::integrator::Simulation::gradient_of), in the time of
//!   three to five runs and with `O(√N)` states kept of `N` steps;
//! - Lyapunov exponents: [`LyapunovRun`];
//! - a run as a function with a gradient, for optimizers: [`Objective`].

mod composition;
mod differentiable;
mod direction;
mod error;
mod evaluation;
mod evi;
mod galerkin;
mod gauss;
mod gradient;
mod kicks;
mod landing;
mod lyapunov;
mod matrix_evi;
mod nodes;
mod objective;
mod parameters;
mod points;
mod tangent_run;
mod vectors;

pub use differentiable::{Backwards, Differentiable};
pub use direction::Direction;
pub use error::DerivativeError;
pub use galerkin::GalerkinWorkspace;
pub use gauss::{GaussWorkspace, TakenGaussStep};
pub use gradient::{Cost, Course, Gradient};
pub use lyapunov::LyapunovRun;
pub use objective::{Design, Objective};
pub use parameters::ParameterChoice;
pub use points::TakenStep;
pub use tangent_run::{Differentiate, TangentRun};
pub use vectors::{StateGradient, StateTangent};
