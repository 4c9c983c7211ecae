//! Methods beside methods on the scenes of the gallery: the common ground of the programs that compare.
//!
//! [`methods`] is the table of methods, generic over the scene. [`scenes`] joins it with a scene and erases the type; what lies above
//! ([`measure`]) sees solvers and numbers only, and is compiled once.

pub mod measure;
pub mod methods;
pub mod scenes;

/// A method that is not there, or not for this scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// Left out when the program was compiled.
    #[error("not built: needs the feature `{feature}`")]
    NotBuilt {
        /// Name of the feature.
        feature: &'static str,
    },
    /// For scenes with an equilibrium to linearise at.
    #[error("not applicable: the motion oscillates about no equilibrium")]
    NoEquilibrium,
    /// Not on this machine, or not asked for.
    #[error("not run: {reason}")]
    NotRun {
        /// Why.
        reason: String,
    },
}
