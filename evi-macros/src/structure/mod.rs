//! What is zero, constant, or varying in the derivatives.
//!
//! In: [`Equations`]. Out: for every nonzero second derivative of `L` and first derivative of `φ` its place, and whether
//! its value is computed once from the parameters or by a kernel; and the kind of the equations as a whole.

mod classify;

pub(crate) use classify::{Block, Classification, ConstraintStructure, MassShape, Potential};

mod elimination;
mod matching;

use std::collections::BTreeSet;

pub(crate) use elimination::Elimination;

use crate::diagnostics::Diagnostics;
use crate::expr::{Dependence, ExprId, Graph};
use crate::mechanics::{Equations, Partial};
use crate::model::{Model, Named};

/// The sparsity of a system.
pub(crate) struct Structure {
    pub(crate) hessian_qq: Vec<Entry>,
    pub(crate) hessian_vq: Vec<Entry>,
    pub(crate) hessian_vv: Vec<Entry>,
    pub(crate) hessian_vt: Vec<Entry>,
    pub(crate) jacobian_q: Vec<Entry>,
    pub(crate) jacobian_t: Vec<Entry>,
    pub(crate) force_q: Vec<Entry>,
    pub(crate) force_v: Vec<Entry>,
    /// Coordinates on which a force acts that is no derivative of `L`.
    pub(crate) forced: Vec<usize>,
    /// Entries of matrices that depend on parameters alone; an entry's slot is its index here.
    pub(crate) constant_entries: Vec<ExprId>,
    /// Varying entries of the Hessian, in the order of the kernel's output.
    pub(crate) hessian_entries: Vec<ExprId>,
    /// What the entries of the Jacobian are to be multiplied with.
    pub(crate) content: f64,
    /// Varying entries of the Jacobian, in the order of the kernel's output.
    pub(crate) jacobian_entries: Vec<ExprId>,
    /// Varying entries of the forces' derivatives, in the order of the kernel's output.
    pub(crate) force_entries: Vec<ExprId>,
    /// What `∂²L/∂v²` depends on.
    pub(crate) mass: Dependence,
    /// What `L` depends on.
    pub(crate) lagrangian: Dependence,
    /// What `φ` depends on.
    pub(crate) constraints: Dependence,
    /// What the forces depend on.
    pub(crate) forces: Dependence,
    /// The kind of the equations.
    pub(crate) classification: Classification,
}

impl Structure {
    /// Reports constraints without a gradient: of what they contain, nothing is left.
    pub(crate) fn check_gradients(&self, model: &Model, diagnostics: &mut Diagnostics) {
        let each = &self.classification.each_constraint;
        for (Named { name, span, .. }, constraint) in model.constraints.iter().zip(each) {
            if constraint.gradient == Block::Zero {
                let message =
                    format!("constraint `{name}` constrains nothing: no coordinate is left in `LHS - RHS`");
                diagnostics.report(*span, message);
            }
        }
    }
}

/// A nonzero entry of a matrix.
#[derive(Clone, Copy)]
pub(crate) struct Entry {
    pub(crate) row: usize,
    pub(crate) col: usize,
    pub(crate) value: EntryValue,
}

/// Where an entry's value comes from.
#[derive(Clone, Copy)]
pub(crate) enum EntryValue {
    Constant(usize),
    Varying(usize),
}

/// Classifies every derivative.
pub(crate) fn analyze(graph: &Graph, equations: &Equations) -> Structure {
    let mut constant_entries = Vec::new();
    let (mut hessian_entries, mut jacobian_entries) = (Vec::new(), Vec::new());
    let mut hessian = |partials| places(graph, partials, &mut constant_entries, &mut hessian_entries);
    let (hessian_qq, hessian_vq) = (hessian(&equations.hessian_qq), hessian(&equations.hessian_vq));
    let (hessian_vv, hessian_vt) = (hessian(&equations.hessian_vv), hessian(&equations.hessian_vt));
    let mut jacobian = |partials| places(graph, partials, &mut constant_entries, &mut jacobian_entries);
    let (jacobian_q, jacobian_t) = (jacobian(&equations.jacobian_q), jacobian(&equations.jacobian_t));
    let forces = &equations.forces;
    let mut force_entries = Vec::new();
    let mut force = |partials| places(graph, partials, &mut constant_entries, &mut force_entries);
    let (force_q, force_v) = (force(&forces.by_q), force(&forces.by_v));
    let is_forced = |&i: &usize| graph.as_number(forces.values[i]) != Some(0.0);
    Structure {
        hessian_qq,
        hessian_vq,
        hessian_vv,
        hessian_vt,
        jacobian_q,
        jacobian_t,
        force_q,
        force_v,
        forced: (0..forces.values.len()).filter(is_forced).collect(),
        constant_entries,
        hessian_entries,
        content: equations.content,
        jacobian_entries,
        force_entries,
        mass: union(graph, equations.hessian_vv.iter().map(|partial| partial.value)),
        lagrangian: graph.dependence(equations.lagrangian),
        constraints: union(graph, equations.constraints.iter().copied()),
        forces: union(graph, forces.values.iter().copied()),
        classification: classify::classify(graph, equations),
    }
}

fn union(graph: &Graph, roots: impl Iterator<Item = ExprId>) -> Dependence {
    roots.fold(Dependence::default(), |union, root| union.union(graph.dependence(root)))
}

fn places(
    graph: &Graph,
    partials: &[Partial],
    constants: &mut Vec<ExprId>,
    varying: &mut Vec<ExprId>,
) -> Vec<Entry> {
    let place = |&Partial { row, col, value }: &Partial| {
        let value = if graph.is_constant(value) {
            EntryValue::Constant(index_of(constants, value))
        } else {
            EntryValue::Varying(index_of(varying, value))
        };
        Entry { row, col, value }
    };
    partials.iter().map(place).collect()
}

/// The index of `value`, which is appended if it is new: equal entries are computed and stored once.
fn index_of(values: &mut Vec<ExprId>, value: ExprId) -> usize {
    values.iter().position(|&known| known == value).unwrap_or_else(|| {
        values.push(value);
        values.len() - 1
    })
}

impl Structure {
    /// Places of the step matrix `A = −D₁D₂L_d` and its transpose: wherever `L` couples two coordinates.
    fn coupled_coordinates(&self) -> BTreeSet<(usize, usize)> {
        let blocks = self.hessian_qq.iter().chain(&self.hessian_vq).chain(&self.hessian_vv);
        blocks.flat_map(|entry| [(entry.row, entry.col), (entry.col, entry.row)]).collect()
    }

    /// The elimination of the saddle-point matrix `[A Gᵀ; G 0]`; forces couple coordinates in `A`, without symmetry.
    pub(crate) fn kkt_elimination(&self, n_coordinates: usize, n_constraints: usize) -> Option<Elimination> {
        let mut entries = self.coupled_coordinates();
        for entry in self.force_q.iter().chain(&self.force_v) {
            entries.extend([(entry.row, entry.col), (entry.col, entry.row)]);
        }
        for entry in &self.jacobian_q {
            entries.insert((n_coordinates + entry.row, entry.col));
            entries.insert((entry.col, n_coordinates + entry.row));
        }
        Elimination::of(n_coordinates + n_constraints, entries)
    }

    /// The elimination of the mass matrix, or of a constant step matrix.
    pub(crate) fn mass_elimination(&self, n_coordinates: usize) -> Option<Elimination> {
        Elimination::of(n_coordinates, self.coupled_coordinates())
    }

    /// The elimination of `G A⁻¹ Gᵀ`: constraints are coupled when they share a coordinate, or all of them when `A⁻¹` is full.
    pub(crate) fn gram_elimination(&self, n_constraints: usize) -> Option<Elimination> {
        let is_diagonal = self.coupled_coordinates().iter().all(|(row, col)| row == col);
        let coupled = |first: &Entry, second: &Entry| !is_diagonal || first.col == second.col;
        let entries = self.jacobian_q.iter().flat_map(|first| {
            self.jacobian_q
                .iter()
                .filter(move |second| coupled(first, second))
                .map(|second| (first.row, second.row))
        });
        Elimination::of(n_constraints, entries.collect())
    }
}
