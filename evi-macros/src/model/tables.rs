//! What the symbols of a graph stand for beyond their numbers: parameters, places in arrays, indices that rustc checks.

use proc_macro2::Span;

use crate::expr::{Affine, ExprId};
use crate::syntax::Declaration;

/// A parameter of the equations.
#[derive(Clone)]
pub(crate) struct Parameter {
    /// Its index as a symbol.
    pub(crate) symbol: usize,
    pub(crate) source: ParameterSource,
}

/// Where the value of a parameter comes from.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum ParameterSource {
    /// A field of the struct, by its index there, or an element of it.
    Field { field: usize, indices: Vec<Affine> },
    /// The value of an index.
    Index(Affine),
}

impl Parameter {
    /// `m`, or `m[2, 1]`.
    pub(crate) fn name(&self, declaration: &Declaration) -> String {
        match &self.source {
            ParameterSource::Field { field, indices } => {
                let name = declaration.fields[*field].name.to_string();
                element_name(name.trim_start_matches("r#"), indices)
            }
            ParameterSource::Index(index) => printed(index),
        }
    }
}

/// A coordinate of a scene of loops: an array and, for every index of it, where.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct Place {
    /// Which entry of `coordinates(..)`.
    pub(crate) array: usize,
    pub(crate) indices: Vec<Affine>,
}

/// The range of an index: from the first to before the second.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct IndexRange {
    pub(crate) level: usize,
    pub(crate) from: Affine,
    pub(crate) to: Affine,
}

/// An index that is within its array for every value of the indices that are open around it, as rustc finds out.
pub(crate) struct Bound {
    pub(crate) index: Affine,
    pub(crate) size: Affine,
    pub(crate) array: String,
    pub(crate) ranges: Vec<IndexRange>,
    pub(crate) first: Span,
    pub(crate) last: Span,
}

/// The tables of a scope.
#[derive(Default)]
pub(super) struct Tables {
    parameters: Vec<ParameterSource>,
    pub(super) places: Vec<Place>,
    pub(super) bounds: Vec<Bound>,
    /// Where sums that stay loops are written.
    pub(super) sums: Vec<(ExprId, Span)>,
}

impl Tables {
    /// Fields as a whole come first: their numbers as symbols are those of the fields.
    pub(super) fn new(n_fields: usize) -> Self {
        let whole = |field| ParameterSource::Field { field, indices: Vec::new() };
        Self { parameters: (0..n_fields).map(whole).collect(), ..Self::default() }
    }

    /// The symbol's index of a parameter.
    pub(super) fn parameter(&mut self, source: ParameterSource) -> usize {
        index_of(&mut self.parameters, source)
    }

    /// The symbol's index of a coordinate in a scene of loops.
    pub(super) fn place(&mut self, place: Place) -> usize {
        index_of(&mut self.places, place)
    }

    /// The parameters of these symbols, in the order of the fields and of the elements in each.
    pub(super) fn sorted_parameters(&self, symbols: impl Iterator<Item = usize>) -> Vec<Parameter> {
        let parameter = |symbol: usize| Parameter { symbol, source: self.parameters[symbol].clone() };
        let mut parameters: Vec<Parameter> = symbols.map(parameter).collect();
        parameters.sort_by(|a, b| a.source.cmp(&b.source));
        parameters
    }
}

fn index_of<X: PartialEq>(table: &mut Vec<X>, entry: X) -> usize {
    table.iter().position(|known| *known == entry).unwrap_or_else(|| {
        table.push(entry);
        table.len() - 1
    })
}

/// `p[3, 1]`, or the name itself.
pub(super) fn element_name(name: &str, indices: &[Affine]) -> String {
    if indices.is_empty() {
        return name.to_owned();
    }
    let indices: Vec<String> = indices.iter().map(printed).collect();
    format!("{name}[{}]", indices.join(", "))
}

fn printed(index: &Affine) -> String {
    index.print(crate::expr::Notation::Unicode)
}
