//! Why a simulation does not go on from a checkpoint.

use std::string::String;

use crate::scheme::SchemeError;

/// A checkpoint that a simulation cannot go on from.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ResumeError {
    /// The scheme defines no step.
    #[error(transparent)]
    Scheme(#[from] SchemeError),
    /// Another version of the crate wrote the checkpoint.
    #[error("the checkpoint has format {found}, this version reads format {expected}")]
    Format {
        /// That of the checkpoint.
        found: u32,
        /// That of this version.
        expected: u32,
    },
    /// The checkpoint has changed since it was taken.
    #[error(
        "the checkpoint is damaged: its contents add up to {found:016x}, its checksum is {expected:016x}"
    )]
    Damaged {
        /// Checksum of the contents.
        found: u64,
        /// The checksum in the checkpoint.
        expected: u64,
    },
    /// The checkpoint is one of another scene.
    #[error("the checkpoint is one of the scene `{checkpoint}`, the simulation one of `{simulation}`")]
    OtherScene {
        /// That of the checkpoint.
        checkpoint: String,
        /// That of the simulation.
        simulation: String,
    },
    /// The scene has the same name, but other equations.
    #[error("the equations of the scene `{scene}` are not those that the checkpoint was taken with")]
    OtherEquations {
        /// The scene.
        scene: String,
    },
    /// The scene has other parameters.
    #[error(
        "the scene has other parameters: a value that its equations take from them was {checkpoint:e} when the checkpoint was \
         taken, and is {simulation:e}"
    )]
    OtherParameters {
        /// The first value that differs, when the checkpoint was taken.
        checkpoint: f64,
        /// The same in the simulation.
        simulation: f64,
    },
    /// The scheme is of another kind.
    #[error("the checkpoint is one of the map `{checkpoint}`, the simulation has `{simulation}`")]
    OtherMap {
        /// That of the checkpoint.
        checkpoint: String,
        /// That of the simulation.
        simulation: String,
    },
    /// The steps have another size.
    #[error("the checkpoint is one of steps of h = {checkpoint:?}, the simulation takes h = {simulation:?}")]
    StepSize {
        /// That of the checkpoint.
        checkpoint: f64,
        /// That of the simulation.
        simulation: f64,
    },
    /// The scheme is of the same kind, but has other nodes, frequencies or matrices.
    #[error("the scheme has other numbers (nodes, frequencies, matrices) than that of the checkpoint")]
    OtherScheme,
    /// What happened inside the steps was counted by another tally; see
    /// [`Simulation::resume_with`](crate::integrator::Simulation::resume_with).
    #[error("the run of the checkpoint has the tally `{checkpoint}`, to be resumed with `{resumed}`")]
    OtherTally {
        /// That of the checkpoint.
        checkpoint: String,
        /// That of the run to be resumed.
        resumed: String,
    },
    /// The checkpoint does not hold as many words as the run remembers.
    #[error("the checkpoint holds {found} words of the {part}, the run remembers {expected}")]
    Length {
        /// `state`, `map` or `tally`.
        part: &'static str,
        /// Number of words in the checkpoint.
        found: usize,
        /// Number of words that the run remembers.
        expected: usize,
    },
}
