//! The expression graph that all stages share: nodes, operators, and (for tests) their values.

#[cfg(test)]
pub(crate) mod evaluate;
mod graph;
mod operator;

pub(crate) use graph::{Dependence, ExprId, Graph, Node, Symbol};
pub(crate) use operator::{Binary, Cost, Unary};
