//! Scenes of many bodies as text.

use core::fmt::{self, Display, Formatter};

use super::Latex;
use super::system::{write_equations, write_kernels};
use super::words::{LISTED_NAMES, List, write_structure};
use crate::assembled::{AssembledReport, FamilyReport, RunReport};
use crate::system::SystemReport;

impl Display for AssembledReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.name)?;
        let names =
            [("coordinates", self.coordinates), ("inputs", self.inputs), ("observed", self.observables)];
        for (what, names) in names.into_iter().filter(|(_, names)| !names.is_empty()) {
            writeln!(f, "  {what:<12} {}", List(|| names.iter(), LISTED_NAMES))?;
        }
        write_equations(self.equations, f)?;
        for FamilyReport { indices, coordinates, element } in self.families {
            if indices.is_empty() {
                writeln!(f, "\nOne element")?;
            } else {
                writeln!(f, "\nFor {indices}")?;
            }
            writeln!(f, "  coordinates  {}", List(|| coordinates.iter(), LISTED_NAMES))?;
            write_element(element, f)?;
        }
        Ok(())
    }
}

/// The structure of an element, and what its kernels take.
fn write_element(element: &SystemReport, f: &mut Formatter<'_>) -> fmt::Result {
    write_structure(element, f)?;
    write_kernels(element.kernels, f)
}

impl AssembledReport {
    /// The equations as a LaTeX environment `aligned`, to stand in math mode.
    pub const fn latex(&self) -> Latex<'_> {
        Latex(self.equations)
    }
}

impl Display for RunReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let name = self.scene.name;
        let of = if name.is_empty() { "scene" } else { name };
        writeln!(f, "{of}: {} coordinates, {} constraints", self.n_coordinates, self.n_constraints)?;
        for (count, element) in &self.families {
            let (coordinates, constraints) = (element.coordinates.len(), element.constraints.len());
            writeln!(f, "  {count:>6} × coordinates {coordinates}, constraints {constraints}")?;
        }
        let mass = if self.has_constant_mass {
            "constant, of small blocks, inverted once"
        } else {
            "eliminated in steps"
        };
        writeln!(f, "  mass matrix: {mass}")?;
        for (unknowns, effort) in &self.systems {
            write!(f, "  {unknowns}: {} unknowns, ", effort.unknowns)?;
            if effort.is_pivoted {
                writeln!(f, "rows exchanged as faer finds")?;
            } else {
                let per_unknown = effort.products as f64 / effort.unknowns.max(1) as f64;
                writeln!(
                    f,
                    "{} entries below the diagonal, {per_unknown:.1} products per unknown",
                    effort.below
                )?;
            }
        }
        Ok(())
    }
}
