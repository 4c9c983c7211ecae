//! What comparisons need to know of a scene beside its equations.

use std::fmt;

use evi_core::generic::GenericSystem;
use evi_core::prelude::*;

/// A scene of the gallery with its standard motion.
pub trait Scene: MechanicalSystem + GenericSystem + Clone + Send + Sync + 'static {
    /// Name on the command line and in files, in snake case.
    const NAME: &'static str;
    /// One sentence of physics.
    const SUMMARY: &'static str;
    /// Where the equations and the numbers of the standard motion come from.
    const ORIGIN: &'static str;
    /// Duration of the standard motion.
    const HORIZON: f64;
    /// Whether every motion conserves the energy `v·∂L/∂v − L`.
    const CONSERVES_ENERGY: bool;
    /// The momenta that every motion conserves.
    const MOMENTA: &'static [Momentum<Self>] = &[];

    /// Parameters of the standard motion.
    fn standard() -> Self;

    /// Position and velocity at the start of the standard motion, at time 0.
    fn standard_motion(&self) -> (Self::PerCoordinate<f64>, Self::PerCoordinate<f64>);

    /// The end of the standard motion.
    fn reference() -> Reference<Self>;

    /// An equilibrium that the motion oscillates about, if there is one: the linearisation there gives the members with frequencies
    /// theirs.
    fn equilibrium(&self) -> Option<Self::PerCoordinate<f64>> {
        None
    }
}

/// A conserved momentum: the moment map of a symmetry, by Noether's theorem.
pub struct Momentum<S> {
    /// Its name.
    pub name: &'static str,
    /// Its value at `(q, p)`.
    pub value: fn(system: &S, q: &[f64], p: &[f64]) -> f64,
}

/// Where a motion is at the [horizon](Scene::HORIZON).
pub struct Reference<S: MechanicalSystem> {
    /// How it is known.
    pub origin: ReferenceOrigin,
    /// Configuration.
    pub q: S::PerCoordinate<f64>,
    /// Velocity.
    pub v: S::PerCoordinate<f64>,
}

/// How the end of a motion is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReferenceOrigin {
    /// Computed by independent means: Taylor series in 256-bit arithmetic, cross-checked in other coordinates and by an extrapolation
    /// code; all digits of `f64` agree.
    Certified,
    /// A solution in closed form.
    ClosedForm,
    /// Computed with the scene's own kernels in octuple precision by extrapolation of the index-1 equations, with two step sizes that
    /// agree beyond the digits of `f64`: `cargo run --release --example reference`.
    Octuple,
}

impl fmt::Display for ReferenceOrigin {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Certified => "certified",
            Self::ClosedForm => "closed form",
            Self::Octuple => "octuple precision",
        })
    }
}

/// What to do with scenes of any type, one after the other.
pub trait Visitor {
    /// Visits one scene.
    fn visit<S: Scene>(&mut self);
}
