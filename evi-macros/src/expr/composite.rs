//! Expressions that stand for more than numbers: sums that stay loops, and vectors that are printed as written.
//!
//! In the graph such an expression is a symbol, [`Symbol::Composite`](super::Symbol::Composite), without operands. No equation that
//! is differentiated contains one.

use super::affine::Affine;
use super::graph::ExprId;

/// An expression that is no number of numbers.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum Composite {
    /// `Σ body` over an index from `from` to before `to`.
    Sum {
        index: String,
        level: usize,
        from: Affine,
        to: Affine,
        body: ExprId,
    },
    /// An element of an array, or an array: its name, whether it is a velocity, and its indices.
    Element {
        name: String,
        is_velocity: bool,
        indices: Vec<Affine>,
    },
    /// An index as a number.
    Index(Affine),
    /// An element of a vector.
    Part(ExprId, Affine),
    /// `(a, b, c)`
    Row(Vec<ExprId>),
    Dot(ExprId, ExprId),
    Cross(ExprId, ExprId),
    Norm(ExprId),
}

impl Composite {
    /// The expressions that it is made of.
    pub(crate) fn operands(&self) -> Vec<ExprId> {
        match self {
            Self::Sum { body, .. } => vec![*body],
            Self::Element { .. } | Self::Index(_) => Vec::new(),
            Self::Part(vector, _) | Self::Norm(vector) => vec![*vector],
            Self::Row(parts) => parts.clone(),
            Self::Dot(a, b) | Self::Cross(a, b) => vec![*a, *b],
        }
    }
}
