//! Scenes of many bodies, whose number is known when a run is prepared: a step costs time in proportion to it.

mod assembly;
mod elements;
mod error;
mod failure;
mod gram;
mod history;
mod implicit;
mod kicked;
mod mass;
mod nodes;
mod number;
mod projection;
mod run;
mod saddle;
mod scene;
mod scheme;
mod sparse;
mod start;
mod state;
mod system;

use assembly::Point;
pub use error::AssemblyError;
pub use run::AssembledRun;
pub use scene::PreparedScene;
pub use scheme::{AssembledComposed, AssembledEvi, AssembledScheme, AssembledStep};
pub use start::AssembledSimulation;
pub use state::AssembledState;
pub use system::{AssembledSystem, Family, FamilyVisitor};
