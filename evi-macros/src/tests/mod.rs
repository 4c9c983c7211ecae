//! Tests of the compiler, stage by stage.
//!
//! The interpreter `expr::evaluate` is the oracle: over `f64` it says what a graph is worth, over the dual
//! numbers of num-dual what its derivatives are, without the compiler's rules. Expressions are written as a
//! user writes them. `tests/kernels.rs` of the workspace checks the same of the emitted code.

mod assembled;
mod central_force;
mod differentiation;
mod emission;
mod fuzz;
mod graph;
mod long_expressions;
mod mistakes;
mod printing;
mod scheduling;
mod simplification;
mod snapshots;
mod sparsity;
mod systems;
mod vectors;
mod workbench;

#[path = "../../../tests/random_expressions/mod.rs"]
mod random_expressions;

#[path = "../../../tests/random_choices/mod.rs"]
mod random_choices;

use random_expressions::splitmix;
