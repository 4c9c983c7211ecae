//! Sums of squares of expressions that are affine in the coordinates.
//!
//! In: a node in normal form. Out: its squares, each with a positive number as its weight, and what else it adds up that
//! depends on parameters alone.

use std::collections::HashSet;

use crate::expr::{Binary, ExprId, Graph, Node, Symbol, Unary};

/// `Σ wₖ eₖ²` and constants, with affine `eₖ`.
pub(super) struct Squares {
    pub(super) squares: Vec<Square>,
    /// Constants to add.
    pub(super) added: Vec<ExprId>,
    /// Constants to subtract.
    pub(super) subtracted: Vec<ExprId>,
}

/// `w e²`.
#[derive(Clone, Copy)]
pub(super) struct Square {
    /// `w > 0`.
    pub(super) weight: f64,
    /// `e`.
    pub(super) base: ExprId,
}

/// What tells squares from others: a base counts up to its sign.
#[derive(PartialEq, Eq)]
pub(super) struct Key(Vec<(u64, Node)>);

/// The nodes below `root` that are affine in the coordinates, with constant slopes.
pub(super) fn affine_nodes(graph: &Graph, root: ExprId) -> HashSet<ExprId> {
    let mut affine = HashSet::new();
    // Operands stand before their users, so that theirs are known.
    for id in graph.reachable(&[root], |id| graph.is_constant(id)) {
        let is_affine = graph.is_constant(id)
            || match graph.node(id) {
                Node::Symbol(symbol) => matches!(symbol, Symbol::Coordinate(_)),
                Node::Unary(Unary::Neg, x) => affine.contains(&x),
                Node::Binary(Binary::Add | Binary::Sub, a, b) => affine.contains(&a) && affine.contains(&b),
                Node::Binary(Binary::Mul, a, b) => {
                    (graph.is_constant(a) && affine.contains(&b))
                        || (affine.contains(&a) && graph.is_constant(b))
                }
                Node::Binary(Binary::Div, a, b) => affine.contains(&a) && graph.is_constant(b),
                Node::Number(_) | Node::Unary(..) | Node::Binary(..) | Node::Power(..) => false,
            };
        if is_affine {
            affine.insert(id);
        }
    }
    affine
}

impl Squares {
    /// Takes a node apart; `None` unless it is a sum of at most `most` squares, and of as many constants.
    pub(super) fn of(graph: &Graph, affine: &HashSet<ExprId>, node: ExprId, most: usize) -> Option<Self> {
        let mut found = Self { squares: Vec::new(), added: Vec::new(), subtracted: Vec::new() };
        let mut pending = vec![node];
        while let Some(term) = pending.pop() {
            match graph.node(term) {
                _ if graph.is_constant(term) => found.added.push(term),
                Node::Binary(Binary::Add, a, b) => pending.extend([b, a]),
                Node::Binary(Binary::Sub, a, b) if graph.is_constant(b) => {
                    pending.push(a);
                    found.subtracted.push(b);
                }
                Node::Binary(Binary::Mul, a, b) => found.squares.push(Square::of(graph, affine, a, b)?),
                Node::Number(_) | Node::Symbol(_) | Node::Unary(..) | Node::Binary(..) | Node::Power(..) => {
                    return None;
                }
            }
            // Before the end of a long sum is seen.
            let n_constants = found.added.len() + found.subtracted.len();
            if found.squares.len() > most || n_constants > most || pending.len() > 2 * most {
                return None;
            }
        }
        (!found.squares.is_empty()).then_some(found)
    }

    /// Whether it is nothing but squares.
    pub(super) fn is_pure(&self) -> bool {
        self.added.is_empty() && self.subtracted.is_empty()
    }

    /// What tells its squares from others.
    pub(super) fn key(&self, graph: &Graph) -> Key {
        let base = |id| match graph.node(id) {
            Node::Binary(Binary::Sub, a, b) if b < a => Node::Binary(Binary::Sub, b, a),
            node => node,
        };
        let mut ordered: Vec<&Square> = self.squares.iter().collect();
        ordered.sort_by_key(|square| operands(base(square.base), square.base));
        Key(ordered.into_iter().map(|square| (square.weight.to_bits(), base(square.base))).collect())
    }
}

/// An order of the bases that does not depend on their signs.
fn operands(base: Node, id: ExprId) -> (ExprId, ExprId) {
    match base {
        Node::Binary(_, a, b) => (a, b),
        Node::Number(_) | Node::Symbol(_) | Node::Unary(..) | Node::Power(..) => (id, id),
    }
}

impl Square {
    /// The square that is the product of `a` and `b`, if it is one.
    fn of(graph: &Graph, affine: &HashSet<ExprId>, a: ExprId, b: ExprId) -> Option<Self> {
        let is_base = |id: ExprId| affine.contains(&id) && !graph.is_constant(id);
        if a == b {
            return is_base(a).then_some(Self { weight: 1.0, base: a });
        }
        // Operands are ordered by age, not by kind.
        let (weight, square) = match (graph.as_number(a), graph.as_number(b)) {
            (Some(weight), _) => (weight, b),
            (_, Some(weight)) => (weight, a),
            _ => return None,
        };
        match graph.node(square) {
            Node::Binary(Binary::Mul, a, b) if a == b && is_base(a) && weight > 0.0 => {
                Some(Self { weight, base: a })
            }
            _ => None,
        }
    }
}
