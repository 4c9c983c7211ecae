//! Local simplification.
//!
//! In: a root. Out: an equal root, after one bottom-up pass of the rules in [`rules`] over the graph below it. Few rules:
//! sharing pays in generated code, algebra mostly does not.

mod rules;

use std::collections::HashMap;

use crate::expr::{ExprId, Graph, Node};

/// Simplifies roots of one graph; remembers what it has simplified.
#[derive(Default)]
pub(crate) struct Simplifier {
    simplified: HashMap<ExprId, ExprId>,
}

impl Simplifier {
    /// An expression equal to `root` wherever `root` is defined.
    pub(crate) fn simplify(&mut self, graph: &mut Graph, root: ExprId) -> ExprId {
        for id in graph.reachable(&[root], |id| self.simplified.contains_key(&id)) {
            if !self.simplified.contains_key(&id) {
                let simplified = self.rebuild(graph, id);
                self.simplified.insert(id, simplified);
                // What the rules return is in normal form.
                self.simplified.entry(simplified).or_insert(simplified);
            }
        }
        self.simplified[&root]
    }

    /// The node on simplified operands, in normal form.
    fn rebuild(&self, graph: &mut Graph, id: ExprId) -> ExprId {
        match graph.node(id) {
            Node::Number(_) | Node::Symbol(_) => id,
            Node::Unary(operator, x) => rules::unary(graph, operator, self.simplified[&x]),
            Node::Binary(operator, a, b) => {
                rules::binary(graph, operator, self.simplified[&a], self.simplified[&b])
            }
            Node::Power(base, exponent) => rules::power(graph, self.simplified[&base], exponent),
        }
    }
}
