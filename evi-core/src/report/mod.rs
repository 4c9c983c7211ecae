//! Statistics of runs.

mod drift;

pub use drift::Drift;
