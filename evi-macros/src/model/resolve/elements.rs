//! Values element by element: what they depend on, the differences of both sides of an equation, places among all elements.

use crate::expr::{Affine, ArrayKind, Dependence, Graph, Value};

/// What the numbers in a value depend on.
pub(super) fn dependence(graph: &Graph, value: &Value) -> Dependence {
    match value {
        Value::Scalar(root) => graph.dependence(*root),
        Value::Vector(parts) => {
            parts.iter().fold(Dependence::default(), |union, part| union.union(dependence(graph, part)))
        }
        Value::Array(view) => Dependence {
            on_q: view.kind == ArrayKind::Coordinate,
            on_v: view.kind == ArrayKind::Velocity,
            ..Dependence::default()
        },
        Value::Index(_) => Dependence::default(),
    }
}

/// `left − right`, element by element.
pub(super) fn residual(graph: &mut Graph, left: Value, right: Value) -> Result<Value, String> {
    match (left, right) {
        (Value::Scalar(left), Value::Scalar(right)) => Ok(Value::Scalar(graph.sub(left, right))),
        (Value::Vector(left), Value::Vector(right)) if left.len() == right.len() => {
            let parts = std::iter::zip(left, right).map(|(left, right)| residual(graph, left, right));
            parts.collect::<Result<_, _>>().map(Value::Vector)
        }
        (Value::Vector(left), Value::Vector(right)) => {
            let (left, right) = (left.len(), right.len());
            Err(format!("vectors of {left} and of {right} elements: both sides of `==` have the same length"))
        }
        (left, _) => {
            let (left, right) =
                if matches!(left, Value::Vector(_)) { ("vector", "number") } else { ("number", "vector") };
            Err(format!("a {left} on the left of `==`, a {right} on its right: both sides are of a kind"))
        }
    }
}

/// The place of an element among all of an array, the last index fastest.
pub(super) fn flat_index(shape: &[Affine], indices: &[Affine]) -> usize {
    let number =
        |value: &Affine| value.as_number().and_then(|number| usize::try_from(number).ok()).unwrap_or(0);
    std::iter::zip(shape, indices).fold(0, |flat, (size, index)| flat * number(size) + number(index))
}

/// The indices of an element from its place among all.
pub(super) fn indices_of(shape: &[Affine], mut flat: usize) -> Vec<Affine> {
    let mut indices = Vec::new();
    for size in shape.iter().rev() {
        let size = size.as_number().and_then(|size| usize::try_from(size).ok()).unwrap_or(1);
        indices.push(Affine::number(i64::try_from(flat % size).unwrap_or(0)));
        flat /= size;
    }
    indices.reverse();
    indices
}
