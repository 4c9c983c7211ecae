//! The interpreter: the oracle that every stage is tested against.

use std::collections::HashMap;

use num_dual::DualNum;

use super::{Binary, ExprId, Graph, Node, Symbol, Unary};

/// The values of `roots`, for the values of the symbols. Over dual numbers it gives exact derivatives of the graph
/// without the compiler's rules of differentiation.
pub(crate) fn evaluate<D: DualNum<Primitive = f64> + Copy>(
    graph: &Graph,
    roots: &[ExprId],
    symbol: impl Fn(Symbol) -> D,
) -> Vec<D> {
    let mut values: HashMap<ExprId, D> = HashMap::new();
    for id in graph.reachable(roots, |_| false) {
        let value = match graph.node(id) {
            Node::Number(number) => D::from(number.value()),
            Node::Symbol(name) => symbol(name),
            Node::Power(base, exponent) => values[&base].powi(exponent),
            Node::Unary(operator, operand) => unary(operator, values[&operand]),
            Node::Binary(operator, first, second) => binary(operator, values[&first], values[&second]),
        };
        values.insert(id, value);
    }
    roots.iter().map(|root| values[root]).collect()
}

fn unary<D: DualNum<Primitive = f64> + Copy>(operator: Unary, x: D) -> D {
    match operator {
        Unary::Neg => -x,
        Unary::Sqrt => x.sqrt(),
        Unary::Sin => x.sin(),
        Unary::Cos => x.cos(),
        Unary::Tan => x.tan(),
        Unary::Exp => x.exp(),
        Unary::Ln => x.ln(),
        Unary::Asin => x.asin(),
        Unary::Acos => x.acos(),
        Unary::Atan => x.atan(),
        Unary::Sinh => x.sinh(),
        Unary::Cosh => x.cosh(),
        Unary::Tanh => x.tanh(),
        Unary::Abs => x.abs(),
        Unary::Signum => x.signum(),
    }
}

fn binary<D: DualNum<Primitive = f64> + Copy>(operator: Binary, a: D, b: D) -> D {
    match operator {
        Binary::Add => a + b,
        Binary::Sub => a - b,
        Binary::Mul => a * b,
        Binary::Div => a / b,
        Binary::Powf => a.powd(b),
        Binary::Atan2 => a.atan2(b),
    }
}
