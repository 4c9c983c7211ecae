//! Why a run of an assembled scene cannot start.

use crate::integrator::ResumeError;
use crate::linear::SingularMatrix;
use crate::mechanics::ProjectionError;
use crate::scheme::SchemeError;

/// A run that cannot start. Coordinates and constraints are called by the names that the scene gives them.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AssemblyError {
    /// The scheme defines no step for the scene.
    #[error(transparent)]
    Scheme(#[from] SchemeError),
    /// The scheme takes the frequencies of a scene that gives none.
    #[error(
        "the scene gives no frequencies for the curves of `.scene_frequencies()`: give one in the attribute, `frequency(coordinate: expression)`, or in \
         the scheme, `.frequency(..)`"
    )]
    NoFrequencies,
    /// A coordinate that nothing holds has a frequency.
    #[error(
        "nothing in the scene holds coordinate {coordinate}: on curves of the frequency {frequency:?} and these nodes its motion would grow at the rate \
         {growth_rate:e} per unit of time. Give it a straight line, or allow this by `.allow_soft_modes()`"
    )]
    SoftCoordinate {
        /// The coordinate, counted from 0.
        coordinate: usize,
        /// Its frequency.
        frequency: f64,
        /// The rate at which a motion along it would grow.
        growth_rate: f64,
    },
    /// A coordinate of an element lies where the scene has none.
    #[error(
        "coordinate {coordinate} of element {element} of family {family} lies at {place}, the scene has {n_coordinates} coordinates"
    )]
    Place {
        /// The family, counted from 0 in the order of declaration.
        family: usize,
        /// The element.
        element: usize,
        /// Its coordinate.
        coordinate: usize,
        /// Where it was to lie.
        place: usize,
        /// Number of coordinates of the scene.
        n_coordinates: usize,
    },
    /// Two coordinates of an element lie at one place.
    #[error("element {element} of family {family} names coordinate {name} of the scene twice")]
    RepeatedPlace {
        /// The family, counted from 0 in the order of declaration.
        family: usize,
        /// The element.
        element: usize,
        /// The coordinate of the scene.
        name: String,
    },
    /// No element gives a coordinate inertia.
    #[error("coordinate {name} has no mass: no element's kinetic energy has its velocity")]
    NoInertia {
        /// The coordinate.
        name: String,
    },
    /// A parameter that the equations name is not finite.
    #[error("parameter `{name}` of element {element} of family {family} is not finite: {value}")]
    Parameter {
        /// The family, counted from 0 in the order of declaration.
        family: usize,
        /// The element.
        element: usize,
        /// The field of the element.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// An element has other inputs than the scene.
    #[error(
        "elements of family {family} have {found} inputs, the scene has {expected}: an element has all of them or none"
    )]
    Inputs {
        /// The family, counted from 0 in the order of declaration.
        family: usize,
        /// Number of inputs of the scene.
        expected: usize,
        /// Number of inputs of an element.
        found: usize,
    },
    /// Positions or velocities are not one per coordinate.
    #[error("{quantity} of the start has {found} values, the scene {expected} coordinates")]
    Length {
        /// `position` or `velocity`.
        quantity: &'static str,
        /// Number of coordinates.
        expected: usize,
        /// Number of values.
        found: usize,
    },
    /// A number of the start is not finite.
    #[error("{quantity} {name} of the start is not finite: {value}")]
    NotFinite {
        /// `position`, `velocity`, `momentum`, `energy` or `time`.
        quantity: &'static str,
        /// The coordinate; empty for energy and time.
        name: String,
        /// The value.
        value: f64,
    },
    /// The position violates a constraint.
    #[error("the start violates constraint {constraint}: residual {residual:e}, allowed {allowed:e}")]
    InconsistentPosition {
        /// The constraint.
        constraint: String,
        /// `φ(t₀, q₀)`.
        residual: f64,
        /// Largest residual that passes.
        allowed: f64,
    },
    /// The velocity leads away from a constraint.
    #[error(
        "the start velocity leaves constraint {constraint}: G v + ∂φ/∂t is {residual:e} of its terms, allowed {allowed:e}"
    )]
    InconsistentVelocity {
        /// The constraint.
        constraint: String,
        /// `|G v + ∂φ/∂t| / (‖G‖ ‖v‖ + |∂φ/∂t|)`.
        residual: f64,
        /// Largest residual that passes.
        allowed: f64,
    },
    /// A constraint follows from others.
    #[error(
        "constraint {constraint} follows from those that are eliminated before it: {pivot_ratio:e} is left of its own gradient"
    )]
    DependentConstraint {
        /// The constraint.
        constraint: String,
        /// What is left of it as a share of what it was, squared.
        pivot_ratio: f64,
    },
    /// The masses and the constraints do not determine the motion at the start.
    #[error("the masses and constraints do not determine the motion at the start: {0}")]
    Singular(#[from] SingularMatrix),
    /// The start cannot be brought onto the constraints to the last digit.
    #[error("start: {0}")]
    Projection(#[from] ProjectionError),
    /// The checkpoint does not belong to the simulation.
    #[error(transparent)]
    Checkpoint(#[from] ResumeError),
    /// Elimination fills in too much.
    #[error(
        "{unknowns} unknowns are coupled so much that elimination takes more than {most} products; the feature `sparse` of evi-core has a \
         factorisation for such nets"
    )]
    TooMuchFill {
        /// Number of unknowns.
        unknowns: usize,
        /// As many products as are accepted.
        most: usize,
    },
}
