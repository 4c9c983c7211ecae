//! What an expression is worth: a number, a vector of numbers or vectors, an array that is not yet indexed, an index.

use super::affine::Affine;
use super::graph::ExprId;

/// The value of an expression.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    Scalar(ExprId),
    Vector(Vec<Value>),
    /// An array by its name, or a part of it.
    Array(View),
    /// An index of a sum or family: a place in an array, or a number.
    Index(Affine),
}

/// Part of an array, of all elements whose first indices are given.
#[derive(Clone, Debug)]
pub(crate) struct View {
    pub(crate) kind: ArrayKind,
    /// Which array of its kind.
    pub(crate) number: usize,
    pub(crate) name: String,
    pub(crate) indices: Vec<Affine>,
    /// Sizes of the indices that are still to be given.
    pub(crate) shape: Vec<Affine>,
}

/// What an array is made of.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum ArrayKind {
    Coordinate,
    Velocity,
    Parameter,
}

impl View {
    /// The part at `index`, which has a size.
    pub(crate) fn at(mut self, index: Affine) -> Self {
        self.shape.remove(0);
        self.indices.push(index);
        self
    }
}
