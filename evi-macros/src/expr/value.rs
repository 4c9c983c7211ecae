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

impl Value {
    /// How many numbers it consists of; none where a size is not known.
    pub(crate) fn n_numbers(&self) -> u64 {
        match self {
            Self::Scalar(_) | Self::Index(_) => 1,
            Self::Vector(parts) => parts.iter().map(Self::n_numbers).fold(0, u64::saturating_add),
            Self::Array(view) => view.n_numbers(),
        }
    }

    /// How many levels of vectors it has; a number has none.
    pub(crate) fn n_levels(&self) -> usize {
        match self {
            Self::Scalar(_) | Self::Index(_) => 0,
            Self::Vector(parts) => 1 + parts.iter().map(Self::n_levels).max().unwrap_or(0),
            Self::Array(view) => view.shape.len(),
        }
    }
}

impl View {
    /// The same of the part.
    pub(crate) fn n_numbers(&self) -> u64 {
        let sizes = self.shape.iter().map(|size| u64::try_from(size.as_number().unwrap_or(0)).unwrap_or(0));
        sizes.fold(1, u64::saturating_mul)
    }

    /// The part at `index`, which has a size.
    pub(crate) fn at(mut self, index: Affine) -> Self {
        self.shape.remove(0);
        self.indices.push(index);
        self
    }
}
