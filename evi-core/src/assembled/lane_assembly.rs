//! What a scene adds up at all nodes of a step at once, a node per lane.

use std::ops::Range;

use super::assembly::Assembly;
use super::elements::LanePoint;
use crate::scalar::{InstructionSet, Lanes};

impl Assembly {
    /// Adds `∂L/∂q + f` of some elements of every family at a node per lane.
    #[inline(always)]
    pub(super) fn add_lane_force(
        &self,
        instructions: InstructionSet,
        elements: impl Fn(usize) -> Range<usize>,
        (t, q, v): (Lanes, &[Lanes], Option<&[Lanes]>),
        force: &mut [Lanes],
    ) {
        for (index, family) in self.families.iter().enumerate() {
            let elements = elements(index);
            if !elements.is_empty() && family.has_force() {
                family.elements.add_lane_force(instructions, elements, t, q, v, force);
            }
        }
    }

    /// Overwrites `∂L/∂q + f` and `∂L/∂v` at a node per lane.
    pub(super) fn lane_gradient(
        &self,
        instructions: InstructionSet,
        at: LanePoint<'_>,
        force: &mut [Lanes],
        momentum: &mut [Lanes],
    ) {
        force.fill(Lanes::ZERO);
        momentum.fill(Lanes::ZERO);
        for family in &self.families {
            family.elements.add_lane_gradient(instructions, at, force, momentum);
        }
    }

    /// All elements of a family.
    pub(super) fn all(&self) -> impl Fn(usize) -> Range<usize> {
        |family| 0..self.families[family].elements.count()
    }

    /// Overwrites `φ(t, q)` of some elements of every family at a node per lane.
    #[inline(always)]
    pub(super) fn lane_constraints(
        &self,
        instructions: InstructionSet,
        elements: impl Fn(usize) -> Range<usize>,
        (t, q): (Lanes, &[Lanes]),
        values: &mut [Lanes],
    ) {
        for (index, family) in self.families.iter().enumerate() {
            let elements = elements(index);
            let rows = family.rows_of(elements.clone());
            if !rows.is_empty() {
                family.elements.lane_constraints(instructions, elements, t, q, &mut values[rows]);
            }
        }
    }

    /// Overwrites `φ(t, q)` and its slopes at a node per lane.
    pub(super) fn lane_constraint_derivatives(
        &self,
        instructions: InstructionSet,
        t: Lanes,
        q: &[Lanes],
        values: &mut [Lanes],
        slopes: &mut [Lanes],
    ) {
        for family in self.families.iter().filter(|family| !family.rows.is_empty()) {
            let values = &mut values[family.rows.clone()];
            let slopes = &mut slopes[family.slopes.clone()];
            family.elements.lane_constraint_derivatives(instructions, t, q, values, slopes);
        }
    }

    /// Subtracts `Gᵀ x` of some elements of every family from `force` at a node per lane.
    #[inline(always)]
    pub(super) fn subtract_lane_pull(
        &self,
        instructions: InstructionSet,
        elements: impl Fn(usize) -> Range<usize>,
        (t, q): (Lanes, &[Lanes]),
        x: &[Lanes],
        force: &mut [Lanes],
    ) {
        for (index, family) in self.families.iter().enumerate() {
            let elements = elements(index);
            let rows = family.rows_of(elements.clone());
            if !rows.is_empty() {
                family.elements.subtract_lane_pull(instructions, elements, t, q, &x[rows], force);
            }
        }
    }
}
