//! Exponential variational integrators for constrained mechanical systems.
//!
//! Write a Lagrangian and holonomic constraints on a struct, and integrate it:
//!
//! ```
//! use evi_core::prelude::*;
//!
//! /// Planar double pendulum: point masses, massless rods, y upwards; SI units.
//! #[derive(MechanicalSystem)]
//! #[evi(
//!     coordinates(x1, y1, x2, y2),
//!     kinetic   = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2))
//!               + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2)),
//!     potential = g * (m1 * y1 + m2 * y2),
//!     constraint(rod1: x1.powi(2) + y1.powi(2) == l1.powi(2)),
//!     constraint(rod2: (x2 - x1).powi(2) + (y2 - y1).powi(2) == l2.powi(2)),
//! )]
//! struct DoublePendulum { m1: f64, m2: f64, l1: f64, l2: f64, g: f64 }
//!
//! let system = DoublePendulum { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g: 9.81 };
//! let mut run = Simulation::new(system, Evi::midpoint(0.01)).start([1.0, 0.0, 2.0, 0.0], [0.0; 4])?;
//! let trajectory = run.integrate(1.0)?;
//! let rods = run.mechanics().constraint_residual(trajectory.last());
//! assert!(rods.iter().all(|residual| residual.abs() < 1e-14));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The derive differentiates the equations at compile time and implements [`system::MechanicalSystem`]; the
//! integrators are generic over it and monomorphised for each scene.
//!
//! # Layers
//!
//! [`mod@array`], [`scalar`], [`memory`], [`system`] and [`scheme`] stand at the bottom; above them `newton` and [`linear`], then
//! [`mechanics`] (energies, projections, the equations of one step), then [`integrator`] (one-step maps and runs),
//! and beside the integrators [`assembled`] for scenes of many bodies, [`baseline`], [`generic`], [`comparison`], [`report`], [`sensitivity`] and
//! [`watch`]; [`ensemble`] moves many members at once, [`columns`] has tables and their files. Imports point downwards.
//!
//! # Features
//!
//! | feature | default | effect |
//! |---|---|---|
//! | `std` | yes | trajectories on the heap; comparisons; elementary functions of the platform. Without it the crate is `no_std` |
//! | `dispatch` | yes | `Galerkin` and `Gauss` steps, and ensembles, in the vector instructions of the machine that the program runs on |
//! | `derive` | yes | re-exports `#[derive(MechanicalSystem)]` |
//! | `serde` | no | [`integrator::Checkpoint`] can be serialised |
//! | `rayon` | no | ensembles on many threads |
//! | `parquet` | no | [`columns::Table::save`] writes Parquet |
//! | `mpi` | no | ensembles on several processes, by the MPI of the system |
//! | `source` | no | [`system::MechanicalSystem::SOURCE`] holds the generated code, to read |
//! | `sparse` | no | `assembled` scenes whose bodies hold each other in large nets: elimination with pivoting by faer |
//! | `argmin` | no | `sensitivity::Objective` is a cost function with a gradient of the crate argmin |
//! | `generic` | no | `generic::GenericEvi` for systems of run-time size; [`scalar::Scalar`] for the dual numbers of num-dual |

#![cfg_attr(not(feature = "std"), no_std)]

// Lets the derive's `::evi_core` paths resolve inside this crate's own tests.
#[cfg(test)]
extern crate self as evi_core;

pub mod array;
#[cfg(feature = "std")]
pub mod assembled;
pub mod baseline;
#[cfg(feature = "std")]
pub mod columns;
#[cfg(feature = "std")]
pub mod comparison;
#[cfg(feature = "std")]
pub mod ensemble;
pub mod generic;
pub mod integrator;
pub mod linear;
pub mod mechanics;
pub mod memory;
mod newton;
pub mod report;
pub mod scalar;
pub mod scheme;
#[cfg(feature = "std")]
pub mod sensitivity;
pub mod system;
pub mod watch;

#[doc(hidden)]
pub mod __private;

/// What a simulation needs: the derive, schemes, and runs.
pub mod prelude {
    #[cfg(feature = "std")]
    pub use crate::integrator::{Checkpoint, ResumeError};
    pub use crate::integrator::{
        Compensable, Composition, Evi, OneStep, Run, Scheme, Simulation, StartError, StepError, Symmetric,
    };
    #[cfg(feature = "std")]
    pub use crate::integrator::{Galerkin, Gauss};
    pub use crate::mechanics::State;
    pub use crate::scheme::{Frequency, Mollifier, Quadrature, SchemeError};
    pub use crate::system::MechanicalSystem;
    #[cfg(feature = "derive")]
    pub use evi_macros::MechanicalSystem;
}
