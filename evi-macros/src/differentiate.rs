//! Differentiation on the graph.
//!
//! In: a root and the derivative of every symbol. Out: the derivative of the root, as new nodes of the same graph;
//! `None` where it vanishes structurally. Not simplified: that is the next stage's.

use std::collections::HashMap;

use crate::expr::{Binary, ExprId, Graph, Node, Symbol};

/// `∂ root / ∂ symbol`.
pub(crate) fn partial(graph: &mut Graph, root: ExprId, symbol: Symbol) -> Option<ExprId> {
    directional(graph, root, |graph, other| (other == symbol).then(|| graph.number(1.0)))
}

/// `d root / dt` along a motion with velocities `v` and without acceleration: `Σ ∂root/∂qᵢ vᵢ + ∂root/∂t`.
pub(crate) fn rate(graph: &mut Graph, root: ExprId) -> Option<ExprId> {
    directional(graph, root, |graph, symbol| match symbol {
        Symbol::Coordinate(i) => Some(graph.symbol(Symbol::Velocity(i))),
        Symbol::Time => Some(graph.number(1.0)),
        // An input is constant over a step.
        Symbol::Parameter(_) | Symbol::NamedConstant(_) | Symbol::Velocity(_) | Symbol::Input(_) => None,
        Symbol::Composite(_) => unreachable!("loops and vectors are no part of what is differentiated"),
        Symbol::Distance => unreachable!("no rate of a distance is asked for"),
    })
}

/// The derivative of `root` when every symbol changes at the rate `tangent(symbol)`; `None` stands for zero.
fn directional(
    graph: &mut Graph,
    root: ExprId,
    tangent: impl Fn(&mut Graph, Symbol) -> Option<ExprId>,
) -> Option<ExprId> {
    // Constants cannot change: what is below them needs no visit.
    let order = graph.reachable(&[root], |id| graph.is_constant(id));
    let mut tangents: HashMap<ExprId, ExprId> = HashMap::new();
    for id in order {
        let derivative = match graph.node(id) {
            _ if graph.is_constant(id) => None,
            Node::Number(_) => None,
            Node::Symbol(symbol) => tangent(graph, symbol),
            Node::Unary(operator, x) => {
                let slope = |graph: &mut Graph| operator.derivative(graph, x, id);
                chain(graph, tangents.get(&x).copied(), slope)
            }
            Node::Power(base, exponent) => chain(graph, tangents.get(&base).copied(), |graph| {
                let power = match exponent.checked_sub(1) {
                    Some(lower) => graph.power(base, lower),
                    // The derivative of the lowest power that is written.
                    None => {
                        let power = graph.power(base, exponent);
                        graph.div(power, base)
                    }
                };
                let factor = graph.number(f64::from(exponent));
                Some(graph.mul(factor, power))
            }),
            Node::Binary(operator, a, b) => {
                let first = chain(graph, tangents.get(&a).copied(), |graph| {
                    Some(operator.derivative_in_first(graph, a, b))
                });
                let second = chain(graph, tangents.get(&b).copied(), |graph| {
                    Some(operator.derivative_in_second(graph, a, b, id))
                });
                match (first, second) {
                    (Some(first), Some(second)) => Some(graph.binary(Binary::Add, first, second)),
                    (one, other) => one.or(other),
                }
            }
        };
        if let Some(derivative) = derivative {
            tangents.insert(id, derivative);
        }
    }
    tangents.get(&root).copied()
}

/// `slope · tangent`, where the slope is built only for a tangent that is not zero.
fn chain(
    graph: &mut Graph,
    tangent: Option<ExprId>,
    slope: impl FnOnce(&mut Graph) -> Option<ExprId>,
) -> Option<ExprId> {
    let tangent = tangent?;
    let slope = slope(graph)?;
    Some(graph.mul(slope, tangent))
}
