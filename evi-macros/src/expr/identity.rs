//! Whether an expression is zero whatever its symbols are.
//!
//! In: a root. Out: whether it vanishes as a rational function of its symbols, and of what stands under other functions. Two points of the
//! field of integers modulo the prime `2⁶¹ − 1` decide, without rounding: a rational function of degree `d` that is not zero vanishes at such a
//! point by a chance of `d / 2⁶¹` (J. T. Schwartz, J. ACM 27 (1980) 701, corollary 1). The points are always the same, so that an expansion is.

use std::collections::HashMap;

use super::{Binary, ExprId, Graph, Node, Unary};

const PRIME: u64 = (1 << 61) - 1;

/// Whether `root` is zero at every value of its symbols.
pub(crate) fn vanishes(graph: &Graph, root: ExprId) -> bool {
    (1..=2).all(|point| value(graph, root, point) == Some(0))
}

/// The value of `root` at one of the points; `None` where it has a pole.
fn value(graph: &Graph, root: ExprId, point: u64) -> Option<u64> {
    let mut values: HashMap<ExprId, u64> = HashMap::new();
    for id in graph.reachable(&[root], |_| false) {
        let at = |operand: ExprId| values[&operand];
        let value = match graph.node(id) {
            Node::Number(number) => of_number(number.value()),
            Node::Symbol(_) => scattered(point, &id),
            Node::Power(base, exponent) => integer_power(at(base), exponent)?,
            Node::Unary(Unary::Neg, x) => difference(0, at(x)),
            Node::Unary(function, x) => scattered(point, &(function, at(x))),
            Node::Binary(Binary::Add, a, b) => (at(a) + at(b)) % PRIME,
            Node::Binary(Binary::Sub, a, b) => difference(at(a), at(b)),
            Node::Binary(Binary::Mul, a, b) => product(at(a), at(b)),
            Node::Binary(Binary::Div, a, b) => product(at(a), inverse(at(b))?),
            Node::Binary(function, a, b) => scattered(point, &(function, at(a), at(b))),
        };
        values.insert(id, value);
    }
    Some(values[&root])
}

/// `m · 2ᵉ`, exactly.
fn of_number(x: f64) -> u64 {
    let bits = x.abs().to_bits();
    let (biased, fraction) = (bits >> 52, bits & ((1 << 52) - 1));
    let (mantissa, exponent) = match biased {
        0 => (fraction, -1074),
        _ => (fraction | 1 << 52, biased as i32 - 1075),
    };
    let magnitude = product(mantissa, integer_power(2, exponent).expect("2 is not 0"));
    if x < 0.0 { difference(0, magnitude) } else { magnitude }
}

/// An element that has nothing to do with those of other keys.
fn scattered(point: u64, key: &impl std::hash::Hash) -> u64 {
    use std::hash::{DefaultHasher, Hash, Hasher};
    let mut hasher = DefaultHasher::new();
    (point, key).hash(&mut hasher);
    hasher.finish() % PRIME
}

fn difference(a: u64, b: u64) -> u64 {
    (a + (PRIME - b)) % PRIME
}

fn product(a: u64, b: u64) -> u64 {
    (u128::from(a) * u128::from(b) % u128::from(PRIME)) as u64
}

fn power(base: u64, mut exponent: u64) -> u64 {
    let (mut square, mut power) = (base, 1);
    while exponent > 0 {
        if exponent & 1 == 1 {
            power = product(power, square);
        }
        square = product(square, square);
        exponent >>= 1;
    }
    power
}

/// By Fermat's little theorem; `None` of 0.
fn inverse(a: u64) -> Option<u64> {
    (a != 0).then(|| power(a, PRIME - 2))
}

fn integer_power(base: u64, exponent: i32) -> Option<u64> {
    let magnitude = power(base, u64::from(exponent.unsigned_abs()));
    if exponent < 0 { inverse(magnitude) } else { Some(magnitude) }
}
