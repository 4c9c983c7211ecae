//! From programs to Rust: the only folder that writes `quote`.
//!
//! Emitted code names `::evi_core::__private` and its own items, nothing else, and stands in an anonymous constant.

mod elimination;
mod fallback;
mod forces;
mod generic;
mod implementation;
mod kernel;
mod pieces;
mod report;
mod storage;

pub(crate) use fallback::{compile_errors, fallback};
pub(crate) use implementation::implementation;
