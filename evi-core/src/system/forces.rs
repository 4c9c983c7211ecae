//! What a scene may have beside a Lagrangian and constraints.

use super::{Dependence, Entry, MechanicalSystem, Operations};
use crate::scalar::Scalar;

/// The structure of the forces `f(t, q, v, u)` that are no derivatives of `L`.
#[derive(Clone, Copy, Debug)]
pub struct ForceStructure {
    /// Coordinates on which one acts.
    pub forced: &'static [usize],
    /// `∂f/∂q`: row of the force, column of the coordinate.
    pub q: &'static [Entry],
    /// `∂f/∂v`: row of the force, column of the velocity.
    pub v: &'static [Entry],
    /// On what `f` depends.
    pub on: Dependence,
    /// Whether `f` depends on inputs.
    pub on_inputs: bool,
    /// Operations of [`MechanicalSystem::forces`].
    pub values: Operations,
    /// Operations of [`MechanicalSystem::force_derivatives`].
    pub derivatives: Operations,
}

impl ForceStructure {
    /// No forces: the scene moves by its Lagrangian and its constraints alone.
    pub const NONE: Self = Self {
        forced: &[],
        q: &[],
        v: &[],
        on: Dependence { on_q: false, on_v: false, on_t: false },
        on_inputs: false,
        values: Operations::NONE,
        derivatives: Operations::NONE,
    };

    /// Whether some force acts.
    pub const fn exist(&self) -> bool {
        !self.forced.is_empty()
    }
}

/// A scene that gives frequencies for its interpolating curves, by the item `frequency(COORDINATE: EXPR)`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` gives no frequencies",
    label = "no coordinate of this scene has a frequency",
    note = "give one in the attribute, `frequency(coordinate: expression)`, or in the scheme, `.frequency(..)`"
)]
pub trait HasFrequencies: MechanicalSystem {
    /// The angular frequency of every coordinate, in radians per unit of time; 0 for those without one.
    fn frequencies<T: Scalar>(constants: &Self::PerConstant<T>) -> Self::PerCoordinate<T>;
}
