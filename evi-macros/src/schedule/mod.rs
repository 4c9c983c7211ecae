//! From the graph to straight-line programs.
//!
//! In: the roots of every kernel. Out: one [`Program`] per kernel: which shared nodes get a name, in which order they
//! are computed, and in which bounded scope. What depends on parameters alone is moved to the program `constants`.

mod program;

pub(crate) use program::{Operations, Place, Program, Statement};

use std::collections::HashMap;

use crate::expr::{ExprId, Graph, Node, Symbol};
use crate::mechanics::{CentralForce, Equations};
use crate::structure::Structure;

/// Every kernel of a system, with the structure it belongs to.
pub(crate) struct Programs {
    pub(crate) structure: Structure,
    /// Nodes that depend on parameters alone, by slot; the matrices' constant entries first.
    pub(crate) slots: ConstantSlots,
    pub(crate) constants: Program,
    pub(crate) lagrangian: Program,
    pub(crate) lagrangian_gradient: Program,
    pub(crate) lagrangian_derivatives: Program,
    pub(crate) constraints: Program,
    pub(crate) constraint_slopes: Program,
    pub(crate) constraint_curvature: Program,
    /// The forces, and the forces with the varying entries of their derivatives; if there are any.
    pub(crate) forces: Option<ForcePrograms>,
    /// The quantities to record, if there are any.
    pub(crate) observables: Option<Program>,
    /// The frequencies of all coordinates, all of them constants; empty if there are none.
    pub(crate) frequencies: Vec<ExprId>,
    /// The one force that acts along a distance, where there is no other.
    pub(crate) central_force: Option<CentralForcePrograms>,
}

/// The kernels of forces that are no derivatives of `L`.
pub(crate) struct ForcePrograms {
    pub(crate) values: Program,
    pub(crate) derivatives: Program,
}

/// The kernels of a central force.
pub(crate) struct CentralForcePrograms {
    /// `r²` and `r ∂r/∂q`.
    pub(crate) squared_distance: Program,
    /// `F'(r)` and `F''(r)`.
    pub(crate) force: Program,
    /// `½ ∂²r²/∂q²`, by rows, all of them constants.
    pub(crate) metric: Vec<ExprId>,
    /// The force beside it, constants.
    pub(crate) uniform: Vec<ExprId>,
    /// Whether `F''` is a constant.
    pub(crate) is_linear: bool,
    /// Whether there is a force beside it.
    pub(crate) is_beside_uniform_force: bool,
}

impl Programs {
    /// Every kernel by the name of its function, in the order of the trait.
    pub(crate) fn kernels(&self) -> Vec<(&'static str, &Program)> {
        let always = [
            ("constants", &self.constants),
            ("lagrangian", &self.lagrangian),
            ("lagrangian_gradient", &self.lagrangian_gradient),
            ("lagrangian_derivatives", &self.lagrangian_derivatives),
            ("constraints", &self.constraints),
            ("constraint_slopes", &self.constraint_slopes),
            ("constraint_curvature", &self.constraint_curvature),
        ];
        let forces = self
            .forces
            .iter()
            .flat_map(|forces| [("forces", &forces.values), ("force_derivatives", &forces.derivatives)]);
        let observables = self.observables.iter().map(|program| ("observables", program));
        let central = self.central_force.iter().flat_map(|central| {
            [("squared_distance", &central.squared_distance), ("central_force", &central.force)]
        });
        always.into_iter().chain(forces).chain(observables).chain(central).collect()
    }
}

/// The values that are computed once from the parameters.
#[derive(Default)]
pub(crate) struct ConstantSlots {
    nodes: Vec<ExprId>,
    slots: HashMap<ExprId, usize>,
}

impl ConstantSlots {
    fn new(nodes: &[ExprId]) -> Self {
        let slots = nodes.iter().enumerate().map(|(slot, &node)| (node, slot)).collect();
        Self { nodes: nodes.to_vec(), slots }
    }

    /// Number of slots.
    pub(crate) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// The slot of a node, if it has one.
    pub(crate) fn get(&self, node: ExprId) -> Option<usize> {
        self.slots.get(&node).copied()
    }

    /// Gives a slot to every constant below the roots that a varying node uses, or that is a root.
    fn add_constants_of(&mut self, graph: &Graph, roots: &[ExprId]) {
        for id in graph.reachable(roots, |id| graph.is_constant(id)) {
            if graph.is_constant(id) && graph.as_number(id).is_none() && !self.slots.contains_key(&id) {
                self.slots.insert(id, self.nodes.len());
                self.nodes.push(id);
            }
        }
    }
}

/// Schedules every kernel.
pub(crate) fn schedule(graph: &Graph, equations: &Equations, structure: Structure) -> Programs {
    let lagrangian = vec![equations.lagrangian];
    let gradient: Vec<ExprId> = equations.force.iter().chain(&equations.momentum).copied().collect();
    let derivatives: Vec<ExprId> = gradient.iter().chain(&structure.hessian_entries).copied().collect();
    let constraints = equations.constraints.clone();
    let constraint_slopes: Vec<ExprId> =
        constraints.iter().chain(&structure.jacobian_entries).copied().collect();
    let curvature = equations.curvature.clone();
    let forces = equations.forces.values.clone();
    let force_derivatives: Vec<ExprId> = forces.iter().chain(&structure.force_entries).copied().collect();
    let observables = equations.observables.clone();
    let frequencies = equations.frequencies.clone();
    let central = equations.central_force.as_ref();
    let central_roots = central.map(CentralForce::roots).unwrap_or_default();

    let mut slots = ConstantSlots::new(&structure.constant_entries);
    let all = [&lagrangian, &derivatives, &constraint_slopes, &curvature];
    for roots in all.into_iter().chain([&force_derivatives, &observables, &frequencies, &central_roots]) {
        slots.add_constants_of(graph, roots);
    }
    // Outside `constants`, whatever depends on parameters alone is read, not computed.
    let kernel =
        |roots: Vec<ExprId>| Program::new(graph, roots, |id| graph.is_constant(id) || is_symbol(graph, id));
    Programs {
        constants: Program::new(graph, slots.nodes.clone(), |id| is_symbol(graph, id)),
        lagrangian: kernel(lagrangian),
        lagrangian_gradient: kernel(gradient),
        lagrangian_derivatives: kernel(derivatives),
        constraints: kernel(constraints),
        constraint_slopes: kernel(constraint_slopes),
        constraint_curvature: kernel(curvature),
        forces: (!forces.is_empty())
            .then(|| ForcePrograms { values: kernel(forces), derivatives: kernel(force_derivatives) }),
        observables: (!observables.is_empty()).then(|| kernel(observables)),
        frequencies,
        central_force: central.map(|central| CentralForcePrograms {
            squared_distance: kernel(central.distance_roots()),
            force: kernel(vec![central.force, central.slope]),
            metric: central.metric.clone(),
            uniform: central.uniform.clone(),
            is_linear: graph.is_constant(central.slope),
            is_beside_uniform_force: central.uniform.iter().any(|&force| graph.as_number(force) != Some(0.0)),
        }),
        structure,
        slots,
    }
}

fn is_symbol(graph: &Graph, id: ExprId) -> bool {
    match graph.node(id) {
        // A named constant is converted to the scalar type: worth a name where it is used twice.
        Node::Symbol(Symbol::NamedConstant(_)) => false,
        Node::Symbol(_) | Node::Number(_) => true,
        Node::Unary(..) | Node::Binary(..) | Node::Power(..) => false,
    }
}
