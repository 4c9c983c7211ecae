//! The elements of one family, prepared: their constants and places on the heap, and loops over their kernels.
//!
//! What is known of a scene's elements at compile time ends here: above, a family is a [`Elements`], and a run is the same code for every scene.

mod loops;
mod observed;
mod repeated;

pub(super) use observed::{ObservedElement, ObservedElements, Term};
pub(super) use repeated::Repeated;

use std::ops::Range;

use super::Point;
use super::sparse::Symmetric;
use crate::memory::Digest;
use crate::scalar::{InstructionSet, Lanes};
use crate::scheme::NodeCoefficients;
use crate::system::{Structure, SystemReport};

/// A family whose kernels add to vectors of the whole scene.
pub(super) trait Elements {
    /// What is known of one element.
    fn structure(&self) -> &'static Structure;

    /// The element as a scene of its own.
    fn report(&self) -> SystemReport;

    /// Sets what forces take from the caller.
    fn set_inputs(&mut self, inputs: &[f64]);

    /// Number of inputs of an element.
    fn n_inputs(&self) -> usize;

    /// Number of elements.
    fn count(&self) -> usize;

    /// Number of coordinates of an element.
    fn n_coordinates(&self) -> usize;

    /// Number of constraints of an element.
    fn n_constraints(&self) -> usize;

    /// Where a coordinate of an element lies.
    fn place(&self, element: usize, coordinate: usize) -> usize;

    /// The first parameter that is not finite: its element, name and value.
    fn parameter_that_is_not_finite(&self) -> Option<(usize, &'static str, f64)>;

    /// Adds to the digest what tells this family from one of other equations or places, and to the constants those of every element.
    fn tell(&self, equations: &mut Digest, constants: &mut Vec<u64>);

    /// `Σ v · ∂L/∂v − L`.
    fn energy(&self, at: Point<'_>) -> f64;

    /// Adds `∂L/∂q + f` and `∂L/∂v`.
    fn add_gradient(&self, at: Point<'_>, force: &mut [f64], momentum: &mut [f64]);

    /// Adds `∂L/∂q + f`.
    fn add_force(&self, at: Point<'_>, force: &mut [f64]);

    /// Adds the second derivatives of `L` and `f`, each times its weight, to `entries`, at the `places` that follow each other as
    /// [`for_each_second_derivative`] does.
    fn add_second_derivatives(
        &self,
        at: Point<'_>,
        weights: &SecondWeights<'_>,
        places: &[u32],
        entries: &mut [f64],
    );

    /// Calls `visit(row, col)` for every number that the second derivatives of constraints of an element add to a matrix over coordinates.
    fn for_each_curved_pair(&self, visit: &mut dyn FnMut(usize, usize));

    /// Adds the second derivatives of `μᵀφ` to `entries`, at the `places` that follow each other as [`for_each_curved_pair`](Self::for_each_curved_pair)
    /// does; `multipliers` are those of this family.
    fn add_bends(&self, t: f64, q: &[f64], multipliers: &[f64], places: &[u32], entries: &mut [f64]);

    /// Overwrites `φ`, the nonzero slopes `∂φ/∂q` of its pattern, and `∂φ/∂t` of this family.
    fn constraint_derivatives(
        &self,
        t: f64,
        q: &[f64],
        values: &mut [f64],
        slopes: &mut [f64],
        rates: &mut [f64],
    );

    /// Overwrites `φ` of this family.
    fn constraints(&self, t: f64, q: &[f64], values: &mut [f64]);

    /// Overwrites `γ = vᵀ φ_qq v + 2 φ_qt v + φ_tt` of this family.
    fn curvature(&self, at: Point<'_>, values: &mut [f64]);

    /// [`add_force`](Self::add_force) of some elements, at a node per lane.
    fn add_lane_force(
        &self,
        instructions: InstructionSet,
        elements: Range<usize>,
        t: Lanes,
        q: &[Lanes],
        v: Option<&[Lanes]>,
        force: &mut [Lanes],
    );

    /// [`add_gradient`](Self::add_gradient) at a node per lane.
    fn add_lane_gradient(
        &self,
        instructions: InstructionSet,
        at: LanePoint<'_>,
        force: &mut [Lanes],
        momentum: &mut [Lanes],
    );

    /// Adds `∂²L/∂v²` at a node per lane, entry by entry of its pattern, the lower or upper triangle, at the `places` in a matrix.
    fn add_lane_mass(
        &self,
        instructions: InstructionSet,
        at: LanePoint<'_>,
        places: &[u32],
        matrix: &mut Symmetric<Lanes>,
    );

    /// [`constraints`](Self::constraints) of some elements, at a node per lane.
    fn lane_constraints(
        &self,
        instructions: InstructionSet,
        elements: Range<usize>,
        t: Lanes,
        q: &[Lanes],
        values: &mut [Lanes],
    );

    /// [`constraint_derivatives`](Self::constraint_derivatives) at a node per lane, without those by time.
    fn lane_constraint_derivatives(
        &self,
        instructions: InstructionSet,
        t: Lanes,
        q: &[Lanes],
        values: &mut [Lanes],
        slopes: &mut [Lanes],
    );

    /// Subtracts `Gᵀ x` of some elements from `force` at a node per lane; `x` is theirs.
    fn subtract_lane_pull(
        &self,
        instructions: InstructionSet,
        elements: Range<usize>,
        t: Lanes,
        q: &[Lanes],
        x: &[Lanes],
        force: &mut [Lanes],
    );
}

/// Points of a motion, a node per lane.
#[derive(Clone, Copy)]
pub(super) struct LanePoint<'a> {
    pub(super) t: Lanes,
    pub(super) q: &'a [Lanes],
    pub(super) v: &'a [Lanes],
}

/// What second derivatives are multiplied with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SecondWeights<'c> {
    /// `∂²L/∂v²`.
    pub(super) vv: f64,
    /// `∂²L/∂v∂q`, row of `v`.
    pub(super) vq: f64,
    /// `∂²L/∂q∂v`, row of `q`.
    pub(super) qv: f64,
    /// `∂²L/∂q²`.
    pub(super) qq: f64,
    /// `∂f/∂q`.
    pub(super) fq: f64,
    /// `∂f/∂v`.
    pub(super) fv: f64,
    /// Where curves of a frequency are varied, with the end of a step in a column and with its start in a row: derivatives by `q` are multiplied with
    /// `g₂` and `g₁`, those by `v` with `h g₂'` and `−h g₁'`.
    pub(super) curves: Option<&'c [NodeCoefficients]>,
}

impl SecondWeights<'_> {
    /// The weight of `∂²L/∂v²`, between coordinates of the scene; the others likewise.
    #[inline]
    fn vv(&self, row: usize, col: usize) -> f64 {
        self.vv * self.curves.map_or(1.0, |of| -of[row].start_rate() * of[col].end_rate())
    }

    #[inline]
    fn vq(&self, row: usize, col: usize) -> f64 {
        self.vq * self.curves.map_or(1.0, |of| -of[row].start_rate() * of[col].end())
    }

    #[inline]
    fn qv(&self, row: usize, col: usize) -> f64 {
        self.qv * self.of_start_and_rate(row, col)
    }

    #[inline]
    fn qq(&self, row: usize, col: usize) -> f64 {
        self.qq * self.of_start_and_end(row, col)
    }

    #[inline]
    fn fq(&self, row: usize, col: usize) -> f64 {
        self.fq * self.of_start_and_end(row, col)
    }

    #[inline]
    fn fv(&self, row: usize, col: usize) -> f64 {
        self.fv * self.of_start_and_rate(row, col)
    }

    #[inline]
    fn of_start_and_rate(&self, row: usize, col: usize) -> f64 {
        self.curves.map_or(1.0, |of| of[row].start() * of[col].end_rate())
    }

    #[inline]
    fn of_start_and_end(&self, row: usize, col: usize) -> f64 {
        self.curves.map_or(1.0, |of| of[row].start() * of[col].end())
    }
}

/// Calls `visit(row, col)` for every number that second derivatives of an element add to a matrix over coordinates.
pub(super) fn for_each_second_derivative(structure: &Structure, mut visit: impl FnMut(usize, usize)) {
    for block in [structure.hessian.vv, structure.hessian.qq] {
        for entry in block {
            visit(entry.row, entry.col);
            if entry.row != entry.col {
                visit(entry.col, entry.row);
            }
        }
    }
    for entry in structure.hessian.vq {
        visit(entry.row, entry.col);
        visit(entry.col, entry.row);
    }
    for entry in structure.forces.q.iter().chain(structure.forces.v) {
        visit(entry.row, entry.col);
    }
}

/// How many numbers that are.
pub(super) fn n_second_derivatives(structure: &Structure) -> usize {
    let mut count = 0;
    for_each_second_derivative(structure, |_, _| count += 1);
    count
}
