//! What there is to tell about a scene of many bodies, as data; [`crate::report`] puts it into words.

use super::run::AssembledRun;
use super::scene::PreparedScene;
use super::sparse::Effort;
use super::{AssembledStep, AssembledSystem};
use crate::integrator::Tally;
use crate::system::{Equation, SystemReport};

/// The equations of a scene and the families that it is a sum of; printing it is the way to read it. It is written by the derive, for any number of bodies.
///
/// ```
/// use evi_core::assembled::AssembledSystem;
/// use evi_core::prelude::*;
///
/// const N: usize = 1_000;
///
/// #[derive(MechanicalSystem)]
/// #[evi(
///     coordinates(p: [N, 2]),
///     kinetic = 0.5 * m * sum(0..N, |i| der(p[i]).norm_squared()),
///     potential = m * g * sum(0..N, |i| p[i][1]),
///     constraint(link[i in 1..N]: (p[i] - p[i - 1]).norm_squared() == l.powi(2)),
/// )]
/// struct Chain { m: f64, l: f64, g: f64 }
///
/// let report = Chain::REPORT.to_string();
/// assert!(report.contains("i in 1..N"), "{report}");
/// ```
#[derive(Clone, Copy, Debug)]
pub struct AssembledReport {
    /// Name of the struct.
    pub name: &'static str,
    /// The arrays of coordinates, with their sizes.
    pub coordinates: &'static [&'static str],
    /// Names of the inputs.
    pub inputs: &'static [&'static str],
    /// Names of the observed quantities.
    pub observables: &'static [&'static str],
    /// The equations as the user wrote them.
    pub equations: &'static [Equation],
    /// What the scene is a sum of.
    pub families: &'static [FamilyReport],
}

impl AssembledReport {
    /// Of a scene that is written by hand: there is nothing to tell before it is prepared.
    pub const UNKNOWN: Self =
        Self { name: "", coordinates: &[], inputs: &[], observables: &[], equations: &[], families: &[] };
}

/// A repeated element.
#[derive(Clone, Copy, Debug)]
pub struct FamilyReport {
    /// Its indices and their ranges; empty for a single element.
    pub indices: &'static str,
    /// Where its coordinates lie.
    pub coordinates: &'static [&'static str],
    /// The element, as a scene.
    pub element: SystemReport,
}

/// A scene with its numbers, as a run has prepared it; printing it is the way to read it.
#[derive(Clone, Debug)]
pub struct RunReport {
    /// What is known without numbers.
    pub scene: AssembledReport,
    /// Number of coordinates.
    pub n_coordinates: usize,
    /// Number of constraints.
    pub n_constraints: usize,
    /// How many elements each family has, and what they are.
    pub families: Vec<(usize, SystemReport)>,
    /// Whether masses are eliminated before a run, so that multipliers are found alone.
    pub has_constant_mass: bool,
    /// The linear systems that steps solve: of what, and what an elimination takes.
    pub systems: Vec<(&'static str, Effort)>,
}

impl PreparedScene {
    fn systems(&self) -> Vec<(&'static str, Effort)> {
        let multipliers =
            self.inertia.iter().map(|inertia| ("multipliers", inertia.gram.pattern.elimination.effort()));
        let saddle = self.saddle.iter().map(|saddle| ("positions and multipliers", saddle.effort()));
        let points =
            self.points.iter().map(|points| ("all points of a step, if passes fail", points.effort()));
        multipliers.chain(saddle).chain(points).collect()
    }
}

impl<S: AssembledSystem, M: AssembledStep, T: Tally> AssembledRun<S, M, T> {
    /// The scene with its numbers, and how steps solve their equations.
    pub fn report(&self) -> RunReport {
        let assembly = &self.scene.assembly;
        let families = assembly.families.iter().map(|family| &family.elements);
        RunReport {
            scene: S::REPORT,
            n_coordinates: assembly.n_coordinates,
            n_constraints: assembly.n_constraints,
            families: families.map(|elements| (elements.count(), elements.report())).collect(),
            has_constant_mass: self.scene.inertia.is_some(),
            systems: self.scene.systems(),
        }
    }
}
