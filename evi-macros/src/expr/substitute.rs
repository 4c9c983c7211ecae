//! Replacing symbols or other nodes: in, roots and the new nodes of some; out, the roots with these in place. Not
//! simplified.

use std::collections::HashMap;

use super::{ExprId, Graph, Node, Symbol};

/// The `roots` with `value(symbol)` for every symbol that has one.
pub(crate) fn substitute(
    graph: &mut Graph,
    roots: &[ExprId],
    value: impl Fn(&mut Graph, Symbol) -> Option<ExprId>,
) -> Vec<ExprId> {
    replace(graph, roots, |graph, id| match graph.node(id) {
        Node::Symbol(symbol) => value(graph, symbol),
        _ => None,
    })
}

/// The `roots` with `value(node)` for every node that has one.
pub(crate) fn replace(
    graph: &mut Graph,
    roots: &[ExprId],
    value: impl Fn(&mut Graph, ExprId) -> Option<ExprId>,
) -> Vec<ExprId> {
    let mut replaced: HashMap<ExprId, ExprId> = HashMap::new();
    // Operands stand before their users, so that theirs are known.
    for id in graph.reachable(roots, |_| false) {
        let replacement = value(graph, id).unwrap_or_else(|| match graph.node(id) {
            Node::Number(_) | Node::Symbol(_) => id,
            Node::Unary(operator, x) => graph.unary(operator, replaced[&x]),
            Node::Binary(operator, a, b) => graph.binary(operator, replaced[&a], replaced[&b]),
            Node::Power(base, exponent) => graph.power(replaced[&base], exponent),
        });
        replaced.insert(id, replacement);
    }
    roots.iter().map(|root| replaced[root]).collect()
}

#[cfg(test)]
mod tests {
    use super::substitute;
    use crate::expr::evaluate::evaluate;
    use crate::expr::{Graph, Symbol, Unary};

    #[test]
    fn a_substituted_expression_is_worth_what_the_original_is_there() {
        let mut graph = Graph::default();
        let (q, v) = (graph.symbol(Symbol::Coordinate(0)), graph.symbol(Symbol::Velocity(0)));
        let sine = graph.unary(Unary::Sin, q);
        let product = graph.mul(sine, v);
        let square = graph.power(v, 2);
        let root = graph.add(product, square);
        let at_half = substitute(&mut graph, &[root, q], |graph, symbol| {
            (symbol == Symbol::Velocity(0)).then(|| graph.number(0.5))
        });
        let values = |v: f64| move |symbol| if symbol == Symbol::Velocity(0) { v } else { 0.3 };
        let expected: Vec<f64> = evaluate(&graph, &[root, q], values(0.5));
        assert!(expected[0] > 0.0);
        assert_eq!(evaluate::<f64>(&graph, &at_half, values(f64::NAN)), expected);
    }
}
