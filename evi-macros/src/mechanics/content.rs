//! The factor that the slopes of quadratic constraints have in common.
//!
//! `∂(x² + y²)` is `(2x, 2y)`. Like the content of a polynomial, the 2 is set apart from the primitive part: Newton's iteration is the same with
//! `(x, y)`, which nothing needs to be done for.

use super::Partial;
use crate::expr::{Binary, ExprId, Graph, Node, Unary};

/// The halves of all derivatives, if each is twice something that costs no more than itself, and varies.
pub(super) fn halves<const K: usize>(
    graph: &mut Graph,
    derivatives: [&[Partial]; K],
) -> Option<[Vec<Partial>; K]> {
    if derivatives.iter().all(|partials| partials.is_empty()) {
        return None;
    }
    let mut halves = [(); K].map(|()| Vec::new());
    for (halves, partials) in halves.iter_mut().zip(derivatives) {
        for partial in partials {
            // A constant entry is stored, and costs nothing.
            if graph.is_constant(partial.value) {
                return None;
            }
            halves.push(Partial { value: half(graph, partial.value)?, ..*partial });
        }
    }
    Some(halves)
}

/// Half of an expression, if that is an expression without a factor of 2, or with an even one halved.
fn half(graph: &mut Graph, whole: ExprId) -> Option<ExprId> {
    match graph.node(whole) {
        Node::Unary(Unary::Neg, x) => {
            let half = half(graph, x)?;
            Some(graph.neg(half))
        }
        Node::Binary(Binary::Mul, a, b) => {
            let (factor, rest) = match (graph.as_number(a), graph.as_number(b)) {
                (Some(factor), _) => (factor, b),
                (_, Some(factor)) => (factor, a),
                _ => return None,
            };
            if factor == 2.0 {
                return Some(rest);
            }
            let factor = (factor % 2.0 == 0.0).then(|| graph.number(0.5 * factor))?;
            Some(graph.mul(factor, rest))
        }
        Node::Binary(operator @ (Binary::Add | Binary::Sub), a, b) => {
            let (a, b) = (half(graph, a)?, half(graph, b)?);
            Some(graph.binary(operator, a, b))
        }
        _ => None,
    }
}
