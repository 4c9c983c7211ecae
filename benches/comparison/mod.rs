//! Methods beside methods on the scenes of the gallery: the common ground of the programs that compare.
//!
//! [`methods`] is the table of methods, generic over the system of a [`Motion`]. [`scenes`] joins it with a scene and erases the type; what lies above
//! ([`measure`]) sees solvers and numbers only, and is compiled once.

pub mod measure;
pub mod methods;
pub mod scenes;

use evi_core::generic::GenericSystem;
use evi_core::prelude::*;
use evi_examples::Scene;

/// What every method of the table can be tried on.
pub trait Subject: MechanicalSystem + GenericSystem + Clone + Send + Sync + 'static {}

impl<S: MechanicalSystem + GenericSystem + Clone + Send + Sync + 'static> Subject for S {}

/// What a method is asked to follow: a system from a start at time 0, and what is known of its oscillations.
#[derive(Clone)]
pub struct Motion<S: MechanicalSystem> {
    /// The system with its parameters.
    pub system: S,
    /// Configuration at the start.
    pub q: S::PerCoordinate<f64>,
    /// Velocity at the start.
    pub v: S::PerCoordinate<f64>,
    /// An equilibrium that it oscillates about, for methods that linearise there.
    pub equilibrium: Option<S::PerCoordinate<f64>>,
    /// A frequency for the curves of all coordinates.
    pub frequency: Option<Frequency>,
}

impl<S: Scene> Motion<S> {
    /// The standard motion of a scene of the gallery.
    pub fn standard() -> Self {
        let system = S::standard();
        let (q, v) = system.standard_motion();
        let equilibrium = system.equilibrium();
        Self { system, q, v, equilibrium, frequency: None }
    }
}

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
    /// For motions with a frequency that their curves can have.
    #[error("not applicable: the motion has no frequency to give its curves")]
    NoFrequency,
    /// Not on this machine, or not asked for.
    #[error("not run: {reason}")]
    NotRun {
        /// Why.
        reason: String,
    },
}
