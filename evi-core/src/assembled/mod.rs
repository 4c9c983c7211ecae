//! Scenes of many bodies, whose size is known when a run is prepared: a step costs time in proportion to it.

mod system;

pub use system::{AssembledSystem, Family, FamilyVisitor};
