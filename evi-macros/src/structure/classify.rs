//! What kind of equations they are, beyond the place of each entry.
//!
//! In: [`Equations`]. Out: [`Classification`], mirrored by the constants of `evi_core::system::Structure`.

use std::collections::BTreeSet;

use super::union;
use crate::expr::{Binary, Dependence, ExprId, Graph, Node, Symbol};
use crate::mechanics::{Equations, Partial};

/// The kind of a system's equations.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Classification {
    pub(crate) qq: Block,
    pub(crate) vq: Block,
    pub(crate) vv: Block,
    pub(crate) vt: Block,
    pub(crate) mass_shape: MassShape,
    pub(crate) potential: Potential,
    pub(crate) momentum_vanishes_at_rest: bool,
    pub(crate) each_constraint: Vec<ConstraintStructure>,
    /// Pairs of constraints that share a coordinate, in order.
    pub(crate) constraint_graph: Vec<(usize, usize)>,
}

/// The values of a block of second derivatives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Block {
    Zero,
    Constant,
    Varying(Dependence),
}

/// The pattern of the mass matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MassShape {
    Diagonal,
    /// With the number of blocks.
    BlockDiagonal(usize),
    Full,
}

/// `V(t, q) = −L(t, q, 0)` as a function of `q`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Potential {
    Zero,
    Affine,
    Quadratic,
    General,
    Inseparable,
}

/// The kind of one constraint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ConstraintStructure {
    pub(crate) gradient: Block,
    pub(crate) on_t: bool,
    /// No second derivative by coordinates varies with a coordinate.
    pub(crate) is_quadratic: bool,
    /// Whether it holds the coordinates of one mass at one distance of the origin: its slopes are these coordinates.
    pub(crate) is_sphere: bool,
    /// The earlier constraint that is the same.
    pub(crate) repeats: Option<usize>,
}

/// Classifies the equations.
pub(super) fn classify(graph: &Graph, equations: &Equations) -> Classification {
    let block = |partials: &[Partial]| block(graph, partials.iter());
    let (qq, vq) = (block(&equations.hessian_qq), block(&equations.hessian_vq));
    let (vv, vt) = (block(&equations.hessian_vv), block(&equations.hessian_vt));
    let is_zero = |&root: &ExprId| graph.as_number(root) == Some(0.0);
    let has_force = !equations.at_rest.force.iter().all(is_zero);
    Classification {
        qq,
        vq,
        vv,
        vt,
        mass_shape: mass_shape(equations),
        potential: potential(qq, vq, vv, has_force),
        momentum_vanishes_at_rest: equations.at_rest.momentum.iter().all(is_zero),
        each_constraint: each_constraint(graph, equations),
        constraint_graph: constraint_graph(equations),
    }
}

fn block<'p>(graph: &Graph, partials: impl Iterator<Item = &'p Partial>) -> Block {
    let mut values = partials.map(|partial| partial.value).peekable();
    if values.peek().is_none() {
        return Block::Zero;
    }
    let dependence = union(graph, values);
    if dependence.is_constant() { Block::Constant } else { Block::Varying(dependence) }
}

impl Block {
    fn dependence(self) -> Dependence {
        match self {
            Self::Zero | Self::Constant => Dependence::default(),
            Self::Varying(dependence) => dependence,
        }
    }
}

fn potential(qq: Block, vq: Block, vv: Block, has_force: bool) -> Potential {
    // ∂³L/∂q∂v∂v = 0 and ∂³L/∂q∂q∂v = 0: then ∂²L/∂q² is −∂²V/∂q².
    let is_separable = !(vv.dependence().on_q || vq.dependence().on_v || qq.dependence().on_v);
    match qq {
        _ if !is_separable => Potential::Inseparable,
        Block::Zero if has_force => Potential::Affine,
        Block::Zero => Potential::Zero,
        _ if qq.dependence().on_q => Potential::General,
        _ => Potential::Quadratic,
    }
}

fn mass_shape(equations: &Equations) -> MassShape {
    let couplings = || equations.hessian_vv.iter().filter(|partial| partial.row != partial.col);
    if couplings().next().is_none() {
        return MassShape::Diagonal;
    }
    // Groups of coupled coordinates, each named by its smallest index.
    let mut group: Vec<usize> = (0..equations.momentum.len()).collect();
    for partial in couplings() {
        let (a, b) = (group[partial.row], group[partial.col]);
        for member in &mut group {
            if *member == a.max(b) {
                *member = a.min(b);
            }
        }
    }
    match group.iter().collect::<BTreeSet<_>>().len() {
        1 => MassShape::Full,
        groups => MassShape::BlockDiagonal(groups),
    }
}

fn each_constraint(graph: &Graph, equations: &Equations) -> Vec<ConstraintStructure> {
    let constraints = &equations.constraints;
    let structure = |row: usize| ConstraintStructure {
        gradient: block(graph, equations.jacobian_q.iter().filter(|partial| partial.row == row)),
        on_t: graph.dependence(constraints[row]).on_t,
        is_quadratic: !graph.dependence(equations.curvature[row]).on_q,
        is_sphere: is_sphere(graph, equations, row),
        repeats: (0..row).find(|&earlier| are_same(graph, constraints[earlier], constraints[row])),
    };
    (0..constraints.len()).map(structure).collect()
}

fn is_sphere(graph: &Graph, equations: &Equations, row: usize) -> bool {
    let mass = |i: usize| {
        let mut of_coordinate =
            equations.hessian_vv.iter().filter(|partial| partial.row == i || partial.col == i);
        of_coordinate.next().filter(|partial| partial.row == partial.col && of_coordinate.next().is_none())
    };
    let slopes: Vec<&Partial> = equations.jacobian_q.iter().filter(|partial| partial.row == row).collect();
    let is_still = equations.jacobian_t.iter().all(|partial| partial.row != row);
    let is_radial =
        |slope: &&&Partial| graph.node(slope.value) == Node::Symbol(Symbol::Coordinate(slope.col));
    let masses: Vec<_> = slopes.iter().filter(is_radial).map(|slope| mass(slope.col)).collect();
    let is_one_mass = masses.first().is_some_and(|first| {
        first.is_some_and(|first| {
            graph.is_constant(first.value)
                && masses.iter().all(|mass| mass.is_some_and(|mass| mass.value == first.value))
        })
    });
    is_still && masses.len() == slopes.len() && is_one_mass
}

/// Whether two residuals vanish together because they are one node, or each other's negative.
fn are_same(graph: &Graph, first: ExprId, second: ExprId) -> bool {
    let is_negative = |a: ExprId, b: ExprId| match (graph.node(a), graph.node(b)) {
        (Node::Binary(Binary::Sub, a1, a2), Node::Binary(Binary::Sub, b1, b2)) => (a1, a2) == (b2, b1),
        _ => false,
    };
    first == second || is_negative(first, second)
}

fn constraint_graph(equations: &Equations) -> Vec<(usize, usize)> {
    let mut constraints_of = vec![Vec::new(); equations.momentum.len()];
    for partial in &equations.jacobian_q {
        constraints_of[partial.col].push(partial.row);
    }
    let pairs = |rows: &Vec<usize>| -> Vec<(usize, usize)> {
        let pairs = rows.iter().enumerate().flat_map(|(k, &a)| rows[k + 1..].iter().map(move |&b| (a, b)));
        pairs.collect()
    };
    let pairs: BTreeSet<(usize, usize)> = constraints_of.iter().flat_map(pairs).collect();
    pairs.into_iter().collect()
}
