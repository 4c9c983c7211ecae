//! The compiler on one screen: every stage, what it takes and what it hands on.

use proc_macro2::TokenStream;

use crate::diagnostics::Diagnostics;
use crate::expr::Graph;
use crate::{budget, emit, mechanics, model, schedule, structure, syntax};

/// Expands the tokens of a struct into its implementation, or into the errors in them.
pub(crate) fn expand(input: TokenStream) -> TokenStream {
    let mut diagnostics = Diagnostics::default();
    // Tokens → items: syntax only, names unresolved.
    let declaration = match syntax::parse(input, &mut diagnostics) {
        Ok(declaration) => declaration,
        Err(syntax::NotAnItem) => return emit::compile_errors(&diagnostics),
    };
    // Scenes of many bodies are sums of small ones, which go the same way.
    if model::expansion(&declaration) == syntax::Expansion::Looped {
        return expand_loops(&declaration, diagnostics);
    }
    // Items → graph: names resolved, L and φ as expressions.
    let mut graph = Graph::default();
    let model = model::resolve(&declaration, &mut graph, &mut diagnostics);
    let Some(model) = model.filter(|_| diagnostics.is_empty()) else {
        return emit::fallback(&declaration, &diagnostics);
    };
    // L and φ → the derivatives that the integrators need, each simplified.
    let mut equations = mechanics::differentiate_equations(&mut graph, &model);
    // A potential of one distance → the force along it.
    mechanics::find_central_force(&mut graph, &mut equations);
    // Derivatives → what is zero, constant, varying.
    let structure = structure::analyze(&graph, &equations);
    structure.check_gradients(&model, &mut diagnostics);
    // Graph → straight-line programs with named intermediate values in bounded scopes.
    let programs = schedule::schedule(&graph, &equations, structure);
    graph.verify();
    // Code that rustc could not compile is refused, at the equation that makes it large.
    budget::check(&graph, &model, &programs, &mut diagnostics);
    if !diagnostics.is_empty() {
        return emit::fallback(&declaration, &diagnostics);
    }
    // Items → the equations as text, in the user's order, for the report.
    let written = model::written(&declaration);
    // Programs → Rust.
    emit::implementation(&declaration, &model, &graph, &programs, &written)
}

/// Expands a scene whose sums and families stay loops: every element goes through the stages by itself.
fn expand_loops(declaration: &syntax::Declaration, mut diagnostics: Diagnostics) -> TokenStream {
    let mut graph = Graph::default();
    let assembled = model::resolve_assembled(declaration, &mut graph, &mut diagnostics);
    let Some(assembled) = assembled.filter(|_| diagnostics.is_empty()) else {
        return emit::assembled_fallback(declaration, &diagnostics);
    };
    let mut programs = Vec::new();
    for element in &assembled.elements {
        let equations = mechanics::differentiate_equations(&mut graph, element);
        let structure = structure::analyze(&graph, &equations);
        structure.check_gradients(element, &mut diagnostics);
        programs.push(schedule::schedule(&graph, &equations, structure));
        budget::check(&graph, element, &programs[programs.len() - 1], &mut diagnostics);
    }
    graph.verify();
    if !diagnostics.is_empty() {
        return emit::assembled_fallback(declaration, &diagnostics);
    }
    let written = model::written(declaration);
    emit::assembled(declaration, &assembled, &graph, &programs, &written)
}
