//! A scene as a sum of repeated elements: the contract between those who write it, or the compiler that does, and the runtime.
//!
//! ```text
//! L(t, q, v) = Σ_f Σ_e L_f(t, q_{f,e}, v_{f,e})        φ(t, q) = (φ_{f,e}(t, q_{f,e}))
//! ```
//!
//! An element is an ordinary small scene with local coordinates and its own parameters; a family is an element, how often it is repeated, and
//! where the coordinates of each copy lie among those of the scene. Numbers of bodies are known when a run is prepared.

use super::report::AssembledReport;
use crate::system::MechanicalSystem;

/// A scene that is a sum of repeated elements.
///
/// Its constraints are those of the families in the order of [`visit_families`](Self::visit_families), element by element. See the
/// [module](super) for an example.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not an `AssembledSystem`",
    note = "a struct with sizes of numbers alone is a `MechanicalSystem`: `Simulation` starts it",
    note = "one with a size that is a constant's name derives `AssembledSystem` by `#[derive(MechanicalSystem)]`"
)]
pub trait AssembledSystem: Sized {
    /// Names of the inputs, which the caller of a run sets; elements have all of them or none.
    const INPUTS: &'static [&'static str] = &[];

    /// Names of the observed quantities.
    const OBSERVABLES: &'static [&'static str] = &[];

    /// Equations and families as text and data.
    const REPORT: AssembledReport = AssembledReport::UNKNOWN;

    /// Number of coordinates, `n`.
    fn n_coordinates(&self) -> usize;

    /// The name of a coordinate, for errors and headers.
    fn coordinate_name(&self, index: usize) -> String {
        format!("q[{index}]")
    }

    /// The name of a constraint, for errors and headers.
    fn constraint_name(&self, index: usize) -> String {
        format!("constraint[{index}]")
    }

    /// Shows every family to the visitor, by `visitor.family::<F>()`, in the order of declaration.
    fn visit_families<V: FamilyVisitor<Self>>(&self, visitor: &mut V);

    /// Shows the terms of every observed quantity to the visitor, by `visitor.term::<F>(quantity)`: families of which each element adds its own observed
    /// quantities.
    fn visit_observed<V: ObservedVisitor<Self>>(&self, visitor: &mut V) {
        let _ = visitor;
    }

    /// Shows families whose only observed quantity is the frequency of the curves of their coordinates, a function of parameters; coordinates of none
    /// take straight lines.
    fn visit_frequencies<V: FrequencyVisitor<Self>>(&self, visitor: &mut V) {
        let _ = visitor;
    }
}

/// A repeated element of a scene `S`.
///
/// A term without an index is a family of one element; a family by two indices numbers its pairs. What a run needs of this is asked once, when it is
/// prepared.
pub trait Family<S> {
    /// What is repeated. No coordinate of theirs needs inertia where other elements give it some.
    type Element: MechanicalSystem + 'static;

    /// Number of elements.
    fn count(system: &S) -> usize;

    /// Element `index` with its parameters.
    fn element(system: &S, index: usize) -> Self::Element;

    /// Where the coordinates of element `index` lie among those of the scene: different places, each below
    /// [`n_coordinates`](AssembledSystem::n_coordinates).
    fn coordinates(system: &S, index: usize) -> <Self::Element as MechanicalSystem>::PerCoordinate<usize>;
}

/// Sees the families of a scene.
pub trait FamilyVisitor<S> {
    /// Sees the next one.
    fn family<F: Family<S>>(&mut self);
}

/// Sees the families that give frequencies.
pub trait FrequencyVisitor<S> {
    /// Sees the next one.
    fn frequency<F: Family<S>>(&mut self);
}

/// Sees the terms of the observed quantities of a scene.
pub trait ObservedVisitor<S> {
    /// Sees the next one, and which quantity of [`OBSERVABLES`](AssembledSystem::OBSERVABLES) it is a term of.
    fn term<F: Family<S>>(&mut self, quantity: usize);
}
