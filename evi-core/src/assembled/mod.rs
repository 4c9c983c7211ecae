//! Scenes of many bodies, whose number is known when a run is prepared: a step costs time in proportion to it.
//!
//! In: an [`AssembledSystem`], a scene as a sum of repeated elements, each an ordinary small scene, and a scheme. Out: an [`AssembledRun`]. Everything is
//! prepared once and lies on the heap: constants and places of the elements, the order in which unknowns are eliminated (chains, trees and rings at
//! a cost proportional to their number), and the storage of a step, under which nothing is allocated. Steps are those of
//! [`Simulation`](crate::integrator::Simulation) to round-off.
//!
//! ```
//! use evi_core::assembled::{AssembledSimulation, AssembledSystem, Family, FamilyVisitor};
//! use evi_core::prelude::*;
//!
//! /// A rod on the pivot at the origin, half of its mass at either end.
//! #[derive(MechanicalSystem)]
//! #[evi(
//!     coordinates(x, y),
//!     kinetic = 0.25 * m * (der(x).powi(2) + der(y).powi(2)),
//!     potential = 0.5 * m * g * y,
//!     constraint(length: x.powi(2) + y.powi(2) == l.powi(2)),
//! )]
//! struct Top { m: f64, l: f64, g: f64 }
//!
//! /// A rod between two joints.
//! #[derive(MechanicalSystem)]
//! #[evi(
//!     coordinates(xa, ya, xb, yb),
//!     kinetic = 0.25 * m * (der(xa).powi(2) + der(ya).powi(2) + der(xb).powi(2) + der(yb).powi(2)),
//!     potential = 0.5 * m * g * (ya + yb),
//!     constraint(length: (xb - xa).powi(2) + (yb - ya).powi(2) == l.powi(2)),
//! )]
//! struct Link { m: f64, l: f64, g: f64 }
//!
//! /// A chain of rods. Joint `i` has the coordinates `2 i` and `2 i + 1`.
//! #[derive(Clone)]
//! struct Chain { masses: Vec<f64>, l: f64, g: f64 }
//!
//! impl Family<Chain> for Top {
//!     type Element = Self;
//!     fn count(_: &Chain) -> usize { 1 }
//!     fn element(chain: &Chain, _: usize) -> Self { Self { m: chain.masses[0], l: chain.l, g: chain.g } }
//!     fn coordinates(_: &Chain, _: usize) -> [usize; 2] { [0, 1] }
//! }
//!
//! impl Family<Chain> for Link {
//!     type Element = Self;
//!     fn count(chain: &Chain) -> usize { chain.masses.len() - 1 }
//!     fn element(chain: &Chain, i: usize) -> Self { Self { m: chain.masses[i + 1], l: chain.l, g: chain.g } }
//!     fn coordinates(_: &Chain, i: usize) -> [usize; 4] { [2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 3] }
//! }
//!
//! impl AssembledSystem for Chain {
//!     fn n_coordinates(&self) -> usize { 2 * self.masses.len() }
//!     fn visit_families<V: FamilyVisitor<Self>>(&self, visitor: &mut V) {
//!         visitor.family::<Top>();
//!         visitor.family::<Link>();
//!     }
//! }
//!
//! let n = 100;
//! let chain = Chain { masses: vec![0.01; n], l: 1.0 / n as f64, g: 9.81 };
//! let horizontal: Vec<f64> = (1..=n).flat_map(|i| [i as f64 / n as f64, 0.0]).collect();
//! let simulation = AssembledSimulation::new(chain, Evi::midpoint(1e-3).composed(Composition::suzuki_4()));
//! let mut run = simulation.start(horizontal, vec![0.0; 2 * n])?;
//! run.advance_sampled(0.1, 25, |run| -> Result<(), StepError> {
//!     println!("t = {:.3}, tip at height {:+.4}, H = {:+.6}", run.state().t(), run.state().q()[2 * n - 1], run.energy());
//!     Ok(())
//! })?;
//! assert!(run.energy().abs() < 1e-5 && run.constraint_error() < 1e-14);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod assembly;
mod checkpoint;
mod curves;
mod elements;
mod error;
mod failure;
mod galerkin;
mod gram;
mod history;
mod implicit;
mod kicked;
mod lane_assembly;
mod lane_saddle;
mod mass;
mod nodes;
mod number;
mod projection;
mod report;
mod rescue;
mod run;
mod saddle;
mod scene;
mod scheme;
mod sparse;
mod start;
mod state;
mod system;
mod writer;

use assembly::Point;
pub use curves::AssembledCurves;
pub use error::AssemblyError;
pub use galerkin::AssembledGalerkin;
pub use report::{AssembledReport, FamilyReport, RunReport};
pub use rescue::AssembledRescued;
pub use run::AssembledRun;
pub use scene::PreparedScene;
pub use scheme::{AssembledComposed, AssembledEvi, AssembledScheme, AssembledStep};
pub use sparse::Effort;
pub use start::AssembledSimulation;
pub use state::AssembledState;
pub use system::{AssembledSystem, Family, FamilyVisitor, FrequencyVisitor, ObservedVisitor};
#[cfg(feature = "parquet")]
pub use writer::ParquetStates;
pub use writer::StateWriter;
