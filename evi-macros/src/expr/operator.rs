//! Everything that is to know about an operator, one row each.
//!
//! To add a function: a variant, a row in [`UNARY`] (method name, derivative), a method of `Scalar` in evi-core, and a
//! line in `evaluate` for the tests.

use super::graph::{ExprId, Graph};

/// Operators with one operand.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum Unary {
    Neg,
    Sqrt,
    Sin,
    Cos,
    Tan,
    Exp,
    Ln,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Abs,
    /// Derivative of `Abs`; not offered to users, whose Lagrangians are differentiated twice.
    Signum,
}

/// Operators with two operands.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum Binary {
    Add,
    Sub,
    Mul,
    Div,
    /// Real power.
    Powf,
    /// `Atan2(y, x)`.
    Atan2,
}

/// What an operator costs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Cost {
    Free,
    Addition,
    Multiplication,
    Division,
    Function,
}

struct UnaryRow {
    operator: Unary,
    /// Name of the method of `Scalar`.
    method: &'static str,
    /// Whether the attribute grammar has it.
    in_grammar: bool,
    /// `f'(x)` from `x` and `f(x)`; `None` where it vanishes.
    derivative: fn(&mut Graph, ExprId, ExprId) -> Option<ExprId>,
}

const UNARY: &[UnaryRow] = &[
    row(Unary::Neg, "neg", false, |g, _, _| Some(g.number(-1.0))),
    row(Unary::Sqrt, "sqrt", true, |g, _, f| {
        let half = g.number(0.5);
        let reciprocal = g.reciprocal(f);
        Some(g.mul(half, reciprocal))
    }),
    row(Unary::Sin, "sin", true, |g, x, _| Some(g.unary(Unary::Cos, x))),
    row(Unary::Cos, "cos", true, |g, x, _| {
        let sine = g.unary(Unary::Sin, x);
        Some(g.neg(sine))
    }),
    row(Unary::Tan, "tan", true, |g, _, f| {
        let square = g.mul(f, f);
        let one = g.number(1.0);
        Some(g.add(one, square))
    }),
    row(Unary::Exp, "exp", true, |_, _, f| Some(f)),
    row(Unary::Ln, "ln", true, |g, x, _| Some(g.reciprocal(x))),
    row(Unary::Asin, "asin", true, |g, x, _| Some(reciprocal_of_circle(g, x))),
    row(Unary::Acos, "acos", true, |g, x, _| {
        let slope = reciprocal_of_circle(g, x);
        Some(g.neg(slope))
    }),
    row(Unary::Atan, "atan", true, |g, x, _| {
        let square = g.mul(x, x);
        let one = g.number(1.0);
        let sum = g.add(one, square);
        Some(g.reciprocal(sum))
    }),
    row(Unary::Sinh, "sinh", true, |g, x, _| Some(g.unary(Unary::Cosh, x))),
    row(Unary::Cosh, "cosh", true, |g, x, _| Some(g.unary(Unary::Sinh, x))),
    row(Unary::Tanh, "tanh", true, |g, _, f| {
        let square = g.mul(f, f);
        let one = g.number(1.0);
        Some(g.sub(one, square))
    }),
    row(Unary::Abs, "abs", true, |g, x, _| Some(g.unary(Unary::Signum, x))),
    row(Unary::Signum, "signum", false, |_, _, _| None),
];

const fn row(
    operator: Unary,
    method: &'static str,
    in_grammar: bool,
    derivative: fn(&mut Graph, ExprId, ExprId) -> Option<ExprId>,
) -> UnaryRow {
    UnaryRow { operator, method, in_grammar, derivative }
}

/// `1 / √(1 − x²)`.
fn reciprocal_of_circle(graph: &mut Graph, x: ExprId) -> ExprId {
    let square = graph.mul(x, x);
    let one = graph.number(1.0);
    let difference = graph.sub(one, square);
    let root = graph.unary(Unary::Sqrt, difference);
    graph.reciprocal(root)
}

impl Unary {
    /// The function that the attribute grammar calls `method`.
    pub(crate) fn from_method(method: &str) -> Option<Self> {
        UNARY.iter().find(|row| row.in_grammar && row.method == method).map(|row| row.operator)
    }

    /// The functions of the attribute grammar.
    pub(crate) fn methods() -> impl Iterator<Item = &'static str> {
        UNARY.iter().filter(|row| row.in_grammar).map(|row| row.method)
    }

    pub(crate) fn method(self) -> &'static str {
        self.row().method
    }

    pub(crate) fn cost(self) -> Cost {
        if matches!(self, Self::Neg | Self::Abs | Self::Signum) { Cost::Free } else { Cost::Function }
    }

    /// `f'(x)`, where `value` is `f(x)`; `None` where it vanishes.
    pub(crate) fn derivative(self, graph: &mut Graph, x: ExprId, value: ExprId) -> Option<ExprId> {
        (self.row().derivative)(graph, x, value)
    }

    fn row(self) -> &'static UnaryRow {
        UNARY.iter().find(|row| row.operator == self).expect("every operator has a row")
    }
}

impl Binary {
    pub(crate) fn is_commutative(self) -> bool {
        matches!(self, Self::Add | Self::Mul)
    }

    pub(crate) fn cost(self) -> Cost {
        match self {
            Self::Add | Self::Sub => Cost::Addition,
            Self::Mul => Cost::Multiplication,
            Self::Div => Cost::Division,
            Self::Powf | Self::Atan2 => Cost::Function,
        }
    }

    /// `∂f/∂a` at `(a, b)`.
    pub(crate) fn derivative_in_first(self, g: &mut Graph, a: ExprId, b: ExprId) -> ExprId {
        match self {
            Self::Add | Self::Sub => g.number(1.0),
            Self::Mul => b,
            Self::Div => g.reciprocal(b),
            Self::Powf => {
                // b · a^(b−1), written without the quotient value/a, which is 0/0 at a = 0.
                let one = g.number(1.0);
                let exponent = g.sub(b, one);
                let power = g.binary(Self::Powf, a, exponent);
                g.mul(b, power)
            }
            Self::Atan2 => {
                let reciprocal = reciprocal_of_squares(g, a, b);
                g.mul(b, reciprocal)
            }
        }
    }

    /// `∂f/∂b` at `(a, b)`, where `value` is `f(a, b)`.
    pub(crate) fn derivative_in_second(self, g: &mut Graph, a: ExprId, b: ExprId, value: ExprId) -> ExprId {
        match self {
            Self::Add => g.number(1.0),
            Self::Sub => g.number(-1.0),
            Self::Mul => a,
            Self::Div => {
                let reciprocal = g.reciprocal(b);
                let quotient = g.mul(value, reciprocal);
                g.neg(quotient)
            }
            Self::Powf => {
                let logarithm = g.unary(Unary::Ln, a);
                g.mul(value, logarithm)
            }
            Self::Atan2 => {
                let reciprocal = reciprocal_of_squares(g, a, b);
                let quotient = g.mul(a, reciprocal);
                g.neg(quotient)
            }
        }
    }
}

/// `1 / (a² + b²)`.
fn reciprocal_of_squares(graph: &mut Graph, a: ExprId, b: ExprId) -> ExprId {
    let (a_squared, b_squared) = (graph.mul(a, a), graph.mul(b, b));
    let sum = graph.add(a_squared, b_squared);
    graph.reciprocal(sum)
}
