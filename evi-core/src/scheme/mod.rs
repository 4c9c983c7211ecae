//! A scheme: where a step samples the Lagrangian, and between which curves.
//!
//! In: [`Quadrature`] (nodes and weights on `[0, 1]`), [`Frequency`] (of the interpolating curve) and the step
//! size. Out: the coefficients of the interpolant at every node, in a table that a prepared step owns.

mod basis;
mod frequency;
mod quadrature;
mod scene_frequencies;

#[cfg(feature = "generic")]
pub(crate) use basis::check_interpolant;
pub(crate) use basis::interpolate;
pub use basis::{
    CoordinateTable, Interpolant, InterpolationTable, Linear, LinearTable, NodeCoefficients, UniformTable,
};
pub use frequency::Frequency;
pub use quadrature::{Quadrature, QuadratureError};
pub use scene_frequencies::{SceneFrequencies, SceneTable};

/// A scheme that does not define a step.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SchemeError {
    /// The step size is zero or not a number.
    #[error("the step size must be finite and not zero, got {h}")]
    StepSize {
        /// The step size.
        h: f64,
    },
    /// A frequency is negative or not finite.
    #[error("the frequency of coordinate {coordinate} must be finite and not negative, got {value}")]
    Frequency {
        /// Index of the coordinate.
        coordinate: usize,
        /// The frequency or rate, per unit of time.
        value: f64,
    },
    /// `ω h` is so close to a multiple of π that the interpolant through two points is not unique.
    #[error(
        "resonant frequency of coordinate {coordinate}: sin(ω h) = {sine:e} at ω h = {phase}; \
         below 1e-3 the interpolant is not determined. Choose ω h well below π/2"
    )]
    ResonantFrequency {
        /// Index of the coordinate.
        coordinate: usize,
        /// `ω h`.
        phase: f64,
        /// `sin(ω h)`.
        sine: f64,
    },
    /// At this `ω h` the kinetic energy of the nodes does not determine the end of a step.
    #[error(
        "the nodes do not see the inertia of coordinate {coordinate}: its kinetic coefficient is \
         {kinetic_coefficient:e} at |ω h| = {phase}, and 1 for small steps. Choose a smaller ω h"
    )]
    VanishingInertia {
        /// Index of the coordinate.
        coordinate: usize,
        /// `ω h`, or the rate times `h` of a hyperbolic interpolant.
        phase: f64,
        /// `Σ wⱼ (−h g₁'(cⱼ)) (h g₂'(cⱼ))`.
        kinetic_coefficient: f64,
    },
    /// The frequencies are not one per coordinate.
    #[error("{frequencies} frequencies for {coordinates} coordinates: give one for all, or one each")]
    FrequencyCount {
        /// Number of frequencies.
        frequencies: usize,
        /// Number of coordinates of the system.
        coordinates: usize,
    },
    /// The scheme asks for a structure that the scene does not have.
    #[error("{scheme} needs {requirement}")]
    UnsupportedStructure {
        /// Name of the scheme.
        scheme: &'static str,
        /// What the scene would have to be.
        requirement: &'static str,
    },
}

/// Returns the step size if it defines a step.
pub(crate) fn checked_step_size(h: f64) -> Result<f64, SchemeError> {
    if h.is_finite() && h != 0.0 { Ok(h) } else { Err(SchemeError::StepSize { h }) }
}
