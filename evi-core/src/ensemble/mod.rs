//! Many members of one scene at once, each with its own parameters and start.
//!
//! In: [`Members`], a scheme that moves them ([`LaneScheme`]), and what is to be kept ([`Gather`]). Out: what was gathered, and every
//! member that came to no end with its reason ([`Outcome`]). Steps are those of [`integrator`](crate::integrator): eight members side by side in vector
//! lanes where the scheme has such steps, one by one elsewhere; on many threads with the feature `rayon`.
//!
//! What a member does depends on nothing but its index: a lane that has converged is frozen while others go on, and a step that is not found
//! in company is taken alone.

mod chunk;
mod composed_lanes;
mod evi_lanes;
mod failure;
mod galerkin_landing;
mod galerkin_lanes;
mod galerkin_passes;
mod gather;
mod journal;
mod kicks;
mod lane_kkt;
mod lane_map;
mod lane_matrix;
mod lane_reach;
mod lane_span;
mod lane_state;
mod mask;
mod members;
mod multiplier_lanes;
mod multiplier_search;
mod newton_lanes;
mod node_lanes;
#[cfg(feature = "mpi")]
mod processes;
mod projection;
mod run;
mod section;
mod sketch;
mod summary;
mod tables;
mod tree;

pub use failure::{Failure, MemberError};
pub use gather::{Gather, Part, Sight};
pub use journal::{Journal, JournalError};
pub use lane_map::{LaneMap, LaneScheme};
pub use lane_state::LaneState;
pub use mask::LaneMask;
pub use members::{ByIndex, Family, FamilyError, Member, Members};
pub use run::{Ensemble, EnsembleError, Outcome, Progress};
pub use section::{NoSection, Section, Surface};
pub use sketch::Sketch;
pub use summary::{Extreme, Histogram, Quantity, Summaries, Summary, SummaryPart};
pub use tables::{Crossings, Ends, States};
