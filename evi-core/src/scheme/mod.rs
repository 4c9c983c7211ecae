//! A scheme: where a step samples the Lagrangian, and between which curves.
//!
//! In: [`Quadrature`] (nodes and weights on `[0, 1]`), [`Frequency`] (of the interpolating curve) and the step
//! size. Out: the coefficients of the interpolant at every node, in a table that a prepared step owns.

mod about;
mod basis;
mod entire;
mod estimate;
mod fitted;
mod frequency;
#[cfg(feature = "std")]
mod gauss_tables;
mod growth;
#[cfg(feature = "std")]
mod impulse_tables;
#[cfg(feature = "std")]
mod lane_tables;
mod mode;
mod mollifier;
#[cfg(feature = "std")]
mod nodal;
#[cfg(feature = "std")]
mod point_tables;
mod quadrature;
mod resonance;
mod scene_frequencies;

pub use about::{About, AboutTable};
#[cfg(feature = "generic")]
pub(crate) use basis::check_interpolant;
#[cfg(feature = "std")]
pub(crate) use basis::checked_coefficients;
pub(crate) use basis::interpolate;
pub use basis::{
    CoordinateTable, Interpolant, InterpolationTable, Linear, LinearTable, NodeCoefficients, UniformTable,
};
pub use estimate::curvature_frequency;
pub use fitted::Fitted;
pub use frequency::Frequency;
#[cfg(feature = "std")]
pub(crate) use gauss_tables::GaussTables;
pub use growth::growth_rate;
#[cfg(feature = "std")]
pub(crate) use impulse_tables::ImpulseTables;
#[cfg(feature = "std")]
pub(crate) use lane_tables::{Columns, LaneTables, PAST};
pub(crate) use mode::ModeFlow;
pub use mollifier::Mollifier;
#[cfg(feature = "std")]
pub(crate) use nodal::LobattoNodes;
#[cfg(feature = "std")]
pub use nodal::{MOST_INTERVALS, NodalCurves, NodalTable, NodalTables};
#[cfg(feature = "std")]
pub(crate) use point_tables::PointTables;
pub use quadrature::{Quadrature, QuadratureError};
pub use resonance::Resonance;
pub(crate) use resonance::to_multiple_of_pi;
pub use scene_frequencies::{SceneFrequencies, SceneTable};

/// A scheme that does not define a step.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SchemeError {
    /// The step size is zero or not a number, or its square is.
    #[error("the step size must be finite and not zero, and its square too, got {h:?}")]
    StepSize {
        /// The step size.
        h: f64,
    },
    /// A frequency is negative or not finite.
    #[error("the frequency of coordinate {coordinate} must be finite and not negative, got {value:?}")]
    Frequency {
        /// Index of the coordinate.
        coordinate: usize,
        /// The frequency or rate, per unit of time.
        value: f64,
    },
    /// `ω h` is so close to a multiple of π that the interpolant through two points is not unique.
    #[error(
        "resonant frequency of coordinate {coordinate}: sin(ω h) = {sine:e} at ω h = {phase:?}; \
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
         {kinetic_coefficient:e} at |ω h| = {phase:?}, and 1 for small steps. Choose a smaller ω h"
    )]
    VanishingInertia {
        /// Index of the coordinate.
        coordinate: usize,
        /// `ω h`, or the rate times `h` of a hyperbolic interpolant.
        phase: f64,
        /// `Σ wⱼ (−h g₁'(cⱼ)) (h g₂'(cⱼ))`.
        kinetic_coefficient: f64,
    },
    /// `ω h` is so large that the curve oscillates between the nodes of a step.
    #[error(
        "the frequency of coordinate {coordinate} oscillates between the nodes: |ω h| = {phase:?}, at most {limit:?}"
    )]
    UnresolvedFrequency {
        /// Index of the coordinate.
        coordinate: usize,
        /// `ω h`, or the rate times `h` of a hyperbolic function.
        phase: f64,
        /// The largest that is accepted.
        limit: f64,
    },
    /// At this `ω h` the functions of a curve do not determine it by its points.
    #[error(
        "the points of a step do not determine the curve of coordinate {coordinate}: the determinant is \
         {determinant:e} at |ω h| = {phase:?}, and 1 for small steps. Choose a smaller ω h"
    )]
    IndeterminateCurve {
        /// Index of the coordinate.
        coordinate: usize,
        /// `ω h`, or the rate times `h` of a hyperbolic function.
        phase: f64,
        /// Determinant of the interpolation relative to that at `ω = 0`; `sin(ω h)/(ω h)` for one interval.
        determinant: f64,
    },
    /// The frequencies are not one per coordinate.
    #[error("{frequencies} frequencies for {coordinates} coordinates: give one for all, or one each")]
    FrequencyCount {
        /// Number of frequencies.
        frequencies: usize,
        /// Number of coordinates of the system.
        coordinates: usize,
    },
    /// There are no nodes for so many intervals.
    #[cfg(feature = "generic")]
    #[error("a Galerkin integrator has 1 to {MOST_INTERVALS} intervals, not {intervals}")]
    Intervals {
        /// Number of intervals.
        intervals: usize,
    },
    /// A reference configuration is not finite.
    #[error("the reference of coordinate {coordinate} is not finite: {value}")]
    Reference {
        /// Index of the coordinate.
        coordinate: usize,
        /// The value.
        value: f64,
    },
    /// A coordinate that nothing holds would grow on the curves of its frequency.
    #[error(
        "coordinate `{coordinate}` is free: L and the constraints do not depend on it. With the frequency \
         {frequency:?} and these nodes its motion would grow at the rate {growth_rate:e} per unit of time. Give it \
         `Frequency::ZERO`, or use the midpoint; `allow_soft_modes` takes it as it is"
    )]
    SoftCoordinate {
        /// Name of the coordinate.
        coordinate: &'static str,
        /// Its frequency, per unit of time.
        frequency: f64,
        /// Rate of growth per unit of time, `ω² |h| √(Σ wⱼ σⱼ²)` for small steps.
        growth_rate: f64,
    },
    /// `w h` of a mode is so close to a multiple of π that its flow does not determine the end of a step by its ends.
    #[error(
        "resonant mode {mode} of frequency {frequency:?}: sin(w h) = {sine:e} at w h = {phase:?}; below 1e-3 the \
         ends of a step do not determine the mode between them. Choose another step size"
    )]
    ResonantMode {
        /// Number of the mode, in ascending order of the squared frequencies.
        mode: usize,
        /// Its frequency `w`, per unit of time.
        frequency: f64,
        /// `w h`.
        phase: f64,
        /// `sin(w h)`.
        sine: f64,
    },
    /// The exact flow of a mode leaves the range of numbers.
    #[error(
        "mode {mode} with squared frequency {squared_frequency:e} grows beyond all numbers in a step of {h:?}"
    )]
    ModeOutOfRange {
        /// Number of the mode, in ascending order of the squared frequencies.
        mode: usize,
        /// Its squared frequency; negative for a mode that grows.
        squared_frequency: f64,
        /// Step size.
        h: f64,
    },
    /// The stiffness matrix of a scheme is not symmetric or has entries that are not finite.
    #[error(
        "the stiffness must be symmetric and finite, got {value:?} in row {row}, column {col} and {mirrored:?} mirrored"
    )]
    Stiffness {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        col: usize,
        /// The entry.
        value: f64,
        /// The entry with row and column exchanged.
        mirrored: f64,
    },
    /// The scene cannot be linearised where the scheme asks for it.
    #[error(transparent)]
    Linearisation(#[from] LinearisationError),
    /// The nodes of a scheme do not mirror each other, where a symmetric scheme is asked for.
    #[error(
        "a composition raises the order of symmetric schemes only: node {node} of this one lies {offset:?} from the middle of \
         the step with weight {weight:?}, its mirror image {mirrored_offset:?} with weight {mirrored_weight:?}"
    )]
    AsymmetricNodes {
        /// Index of the first node without a mirror image.
        node: usize,
        /// `cⱼ − ½`.
        offset: f64,
        /// `wⱼ`.
        weight: f64,
        /// The same of the node that stands as far from the last as this one from the first.
        mirrored_offset: f64,
        /// Its weight.
        mirrored_weight: f64,
    },
    /// The spectral radius of a generalized-α method lies outside of `[0, 1)`.
    #[error("the spectral radius at infinity must lie in [0, 1), got {value:?}")]
    SpectralRadius {
        /// `ρ∞`.
        value: f64,
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

/// A linearisation that does not exist.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinearisationError {
    /// The scene has no linearisation of the form `M ÿ + Ω y = 0`, `G y = 0`.
    #[error("a linearisation needs {requirement}")]
    UnsupportedStructure {
        /// What the scene would have to be.
        requirement: &'static str,
    },
    /// No equilibrium was found near the configuration.
    #[error(
        "no equilibrium found near the configuration: after {corrections} corrections the last one is \
         {last_correction:e} of it. A point of a motion is linearised with `linearised_along`"
    )]
    NoEquilibrium {
        /// Number of Newton corrections.
        corrections: usize,
        /// Relative length of the last one.
        last_correction: f64,
    },
    /// A number of the configuration or the velocity is not finite.
    #[error("{quantity} {index} to linearise at is not finite: {value}")]
    Point {
        /// `position` or `velocity`.
        quantity: &'static str,
        /// Index in its vector.
        index: usize,
        /// The value.
        value: f64,
    },
    /// The configuration cannot be moved onto the constraints, or mass matrix and constraints do not determine the motion there.
    #[error(
        "the configuration cannot be projected on the constraints: smallest over largest pivot {pivot_ratio:e}"
    )]
    Projection {
        /// Smallest pivot over largest of the last matrix; NaN where the projection did not converge.
        pivot_ratio: f64,
    },
    /// The mass matrix is not positive definite, so that the modes have no metric.
    #[error("the mass matrix is not positive definite: modes have no metric")]
    Mass,
    /// A number of the linearisation is not finite.
    #[error("the linearisation is not finite")]
    NotFinite,
}

impl<const K: usize> Quadrature<K> {
    /// Returns nothing if the rule is its own mirror image.
    pub(crate) fn check_symmetry(&self) -> Result<(), SchemeError> {
        let (offsets, weights) = (self.offsets(), self.weights());
        // Equality of bits, which symmetric rules have by construction.
        let has_image = |&j: &usize| offsets[j] == -offsets[K - 1 - j] && weights[j] == weights[K - 1 - j];
        match (0..K).find(|j| !has_image(j)) {
            None => Ok(()),
            Some(node) => Err(SchemeError::AsymmetricNodes {
                node,
                offset: offsets[node],
                weight: weights[node],
                mirrored_offset: offsets[K - 1 - node],
                mirrored_weight: weights[K - 1 - node],
            }),
        }
    }
}

/// Returns the step size if it defines a step. Forces enter with its square, which a normal number has to be; a sum of such steps
/// never overflows.
pub(crate) fn checked_step_size(h: f64) -> Result<f64, SchemeError> {
    if (h * h).is_normal() { Ok(h) } else { Err(SchemeError::StepSize { h }) }
}
