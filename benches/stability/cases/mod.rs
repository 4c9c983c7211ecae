//! The cases: each a file that plans its rows.

mod energies;
mod frequencies;
mod geometry;
mod newton;
mod numbers;
mod scales;
mod steps;
mod stiffness;

use crate::rows::{Effort, Planned};

/// A case.
pub(crate) struct Case {
    /// Name on the command line and in files.
    pub(crate) name: &'static str,
    /// One sentence.
    pub(crate) summary: &'static str,
    pub(crate) rows: fn(Effort) -> Vec<Planned>,
}

/// All of them, in their order.
pub(crate) const ALL: &[Case] = &[
    Case { name: "stiffness", summary: stiffness::SUMMARY, rows: stiffness::rows },
    Case { name: "frequencies", summary: frequencies::SUMMARY, rows: frequencies::rows },
    Case { name: "scales", summary: scales::SUMMARY, rows: scales::rows },
    Case { name: "energies", summary: energies::SUMMARY, rows: energies::rows },
    Case { name: "geometry", summary: geometry::SUMMARY, rows: geometry::rows },
    Case { name: "steps", summary: steps::SUMMARY, rows: steps::rows },
    Case { name: "newton", summary: newton::SUMMARY, rows: newton::rows },
    Case { name: "numbers", summary: numbers::SUMMARY, rows: numbers::rows },
];
