//! From programs to Rust: the only folder that writes `quote`.
//!
//! Emitted code names `::evi_core::__private` and its own items, nothing else, and stands in an anonymous constant.

mod assembled;
mod central_force;
mod elimination;
mod fallback;
mod forces;
mod functions;
mod generic;
mod generic_graph;
mod implementation;
mod indices;
mod kernel;
mod patterns;
mod pieces;
mod report;
mod storage;
mod structure;
mod subject;

pub(crate) use assembled::assembled;
pub(crate) use fallback::{assembled_fallback, compile_errors, fallback};
pub(crate) use implementation::implementation;
