//! The rules: each builds a node from operands in normal form and returns its normal form.
//!
//! | rule | may change |
//! |---|---|
//! | numbers fold in `+ − × ÷`, powers and `√` | nothing: rustc would round the same |
//! | `x + 0`, `x · 1`, `x / 1`, `x^1`, `−(−x)`, `a + (−b)`, `a − (−b)` | nothing |
//! | `x · 0 = 0`, `0 / x = 0`, `x − x = 0`, `x / x = 1`, `x^0 = 1` | infinities and NaN of `x`, and 0/0, vanish |
//! | `x + x = 2 x` | nothing |
//! | products as number · parameters · variables, likewise quotients | rounding, overflow of intermediate values |
//! | `x / c = (1/c) · x` for parameters `c` | rounding |
//! | small integer powers as shared squares | rounding |
//! | `powf` with the exponent ½ or an integer | the sign of zero and infinity at `√−0`, `√−∞` |

use crate::expr::{Binary, ExprId, Graph, Node, Unary};

/// Integer powers up to this size become products; beyond it `powi` multiplies as often and is shorter.
const LARGEST_EXPANDED_POWER: u32 = 16;

/// The normal form of `operator(x)`.
pub(super) fn unary(graph: &mut Graph, operator: Unary, x: ExprId) -> ExprId {
    match (operator, graph.as_number(x)) {
        (Unary::Neg, _) => {
            let minus_one = graph.number(-1.0);
            product(graph, minus_one, x)
        }
        // √ is correctly rounded; other functions are left to the target's libm.
        (Unary::Sqrt, Some(value)) if value >= 0.0 => graph.number(value.sqrt()),
        (Unary::Abs, Some(value)) => graph.number(value.abs()),
        _ => graph.unary(operator, x),
    }
}

/// The normal form of `operator(a, b)`.
pub(super) fn binary(graph: &mut Graph, operator: Binary, a: ExprId, b: ExprId) -> ExprId {
    match operator {
        Binary::Add => sum(graph, a, b),
        Binary::Sub => difference(graph, a, b),
        Binary::Mul => product(graph, a, b),
        Binary::Div => quotient(graph, a, b),
        Binary::Powf => real_power(graph, a, b),
        Binary::Atan2 => graph.binary(Binary::Atan2, a, b),
    }
}

/// The normal form of `base^exponent`.
pub(super) fn power(graph: &mut Graph, base: ExprId, exponent: i32) -> ExprId {
    if exponent < 0 && exponent != i32::MIN {
        let denominator = power(graph, base, -exponent);
        let one = graph.number(1.0);
        return quotient(graph, one, denominator);
    }
    match exponent.unsigned_abs() {
        0 => graph.number(1.0),
        1 => base,
        magnitude if magnitude <= LARGEST_EXPANDED_POWER => {
            let half = power(graph, base, exponent / 2);
            let square = product(graph, half, half);
            if magnitude % 2 == 0 { square } else { product(graph, base, square) }
        }
        _ => graph.power(base, exponent),
    }
}

fn sum(graph: &mut Graph, a: ExprId, b: ExprId) -> ExprId {
    match (graph.as_number(a), graph.as_number(b)) {
        (Some(x), Some(y)) if (x + y).is_finite() => return graph.number(x + y),
        (Some(0.0), _) => return b,
        (_, Some(0.0)) => return a,
        _ => {}
    }
    if a == b {
        let two = graph.number(2.0);
        return product(graph, two, a);
    }
    match (negated(graph, a), negated(graph, b)) {
        (Some(a), Some(b)) => {
            let sum = graph.add(a, b);
            graph.neg(sum)
        }
        (Some(a), None) => subtracted(graph, b, a),
        (None, Some(b)) => subtracted(graph, a, b),
        (None, None) => graph.add(a, b),
    }
}

fn difference(graph: &mut Graph, a: ExprId, b: ExprId) -> ExprId {
    let minus_one = graph.number(-1.0);
    let negative = product(graph, minus_one, b);
    sum(graph, a, negative)
}

/// `a − b`, where neither is negated.
fn subtracted(graph: &mut Graph, a: ExprId, b: ExprId) -> ExprId {
    if a == b { graph.number(0.0) } else { graph.sub(a, b) }
}

/// `x` where the node is `−x`.
fn negated(graph: &Graph, id: ExprId) -> Option<ExprId> {
    match graph.node(id) {
        Node::Unary(Unary::Neg, x) => Some(x),
        _ => None,
    }
}

/// A term as number · constant · variable, where the constant depends on parameters alone.
struct Factors {
    number: f64,
    constant: Option<ExprId>,
    variable: Option<ExprId>,
}

/// Takes a term in normal form apart: `±number · (constant · variable)` as [`assembled`] builds it.
fn factors(graph: &Graph, id: ExprId) -> Factors {
    if let Some(number) = graph.as_number(id) {
        return Factors { number, constant: None, variable: None };
    }
    if let Some(positive) = negated(graph, id) {
        let inner = factors(graph, positive);
        return Factors { number: -inner.number, ..inner };
    }
    if let Node::Binary(Binary::Mul, a, b) = graph.node(id) {
        // Operands are ordered by age, not by kind.
        for (scale, rest) in [(a, b), (b, a)] {
            if let Some(number) = graph.as_number(scale) {
                let inner = factors(graph, rest);
                return Factors { number: number * inner.number, ..inner };
            }
            if graph.is_constant(scale) && !graph.is_constant(rest) {
                let inner = factors(graph, scale);
                return Factors { variable: Some(rest), ..inner };
            }
        }
    }
    if graph.is_constant(id) {
        Factors { number: 1.0, constant: Some(id), variable: None }
    } else {
        Factors { number: 1.0, constant: None, variable: Some(id) }
    }
}

/// Puts a term together in normal form: the number scales the constant, which scales the variable; a negative sign
/// stands outside.
fn assembled(graph: &mut Graph, Factors { number, constant, variable }: Factors) -> ExprId {
    if number == 0.0 {
        return graph.number(0.0);
    }
    let magnitude = graph.number(number.abs());
    let coefficient = match constant {
        Some(constant) if number.abs() == 1.0 => Some(constant),
        Some(constant) => Some(graph.mul(magnitude, constant)),
        None if number.abs() == 1.0 => None,
        None => Some(magnitude),
    };
    let positive = match (coefficient, variable) {
        (Some(coefficient), Some(variable)) => graph.mul(coefficient, variable),
        (one, other) => one.or(other).unwrap_or(magnitude),
    };
    match graph.as_number(positive) {
        _ if number > 0.0 => positive,
        Some(value) => graph.number(-value),
        None => graph.neg(positive),
    }
}

/// The folded number, unless folding it overflows or underflows.
fn folded(number: f64, is_zero: bool) -> Option<f64> {
    (number.is_finite() && (number != 0.0 || is_zero)).then_some(number)
}

fn product(graph: &mut Graph, a: ExprId, b: ExprId) -> ExprId {
    let (first, second) = (factors(graph, a), factors(graph, b));
    let Some(number) = folded(first.number * second.number, first.number == 0.0 || second.number == 0.0)
    else {
        return graph.mul(a, b);
    };
    let mut combined = |one: Option<ExprId>, other: Option<ExprId>| match (one, other) {
        (Some(one), Some(other)) => Some(graph.mul(one, other)),
        (one, other) => one.or(other),
    };
    let constant = combined(first.constant, second.constant);
    let variable = combined(first.variable, second.variable);
    assembled(graph, Factors { number, constant, variable })
}

fn quotient(graph: &mut Graph, a: ExprId, b: ExprId) -> ExprId {
    let (above, below) = (factors(graph, a), factors(graph, b));
    // Division by a literal zero is left for the user to see at run time.
    let Some(number) = folded(above.number / below.number, above.number == 0.0) else {
        return graph.div(a, b);
    };
    let mut divided = |above: Option<ExprId>, below: Option<ExprId>| match (above, below) {
        (Some(above), Some(below)) if above == below => None,
        (Some(above), Some(below)) => Some(graph.div(above, below)),
        (None, Some(below)) => Some(graph.reciprocal(below)),
        (above, None) => above,
    };
    let constant = divided(above.constant, below.constant);
    let variable = divided(above.variable, below.variable);
    assembled(graph, Factors { number, constant, variable })
}

fn real_power(graph: &mut Graph, base: ExprId, exponent: ExprId) -> ExprId {
    match graph.as_number(exponent) {
        Some(0.5) => unary(graph, Unary::Sqrt, base),
        Some(number) if number.fract() == 0.0 && number.abs() <= f64::from(LARGEST_EXPANDED_POWER) => {
            power(graph, base, number as i32)
        }
        _ => graph.binary(Binary::Powf, base, exponent),
    }
}
