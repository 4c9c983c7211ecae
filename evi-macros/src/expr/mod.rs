//! The expression graph that all stages share: nodes, operators, their text, and (for tests) their values.

mod affine;
mod composite;
#[cfg(test)]
pub(crate) mod evaluate;
mod graph;
mod operator;
mod print;
mod substitute;
mod value;

pub(crate) use affine::{Affine, Variable};
pub(crate) use composite::Composite;
pub(crate) use graph::{Dependence, ExprId, Graph, Node, Symbol};
pub(crate) use operator::{Binary, Cost, Unary};
pub(crate) use print::{Names, Notation, print, print_definition, print_name};
pub(crate) use substitute::{replace, substitute};
pub(crate) use value::{ArrayKind, Value, View};
