//! Any tokens, right, nearly right or soup: the expansion never panics, hangs or overflows its stack, and what it says is Rust.
//!
//! Many cases: `EVI_FUZZ_CASES=1000000 CARGO_PROFILE_TEST_BUILD_OVERRIDE_OPT_LEVEL=2 cargo test -p evi-macros fuzz -- --nocapture`,
//! with `EVI_FUZZ_SEED=N` from case `N` on, with `EVI_FUZZ_SHOW=1` printed. A failure names its case, made as small as it goes.

mod grammar;
mod mutation;

use std::panic::catch_unwind;

use proc_macro2::{Delimiter, Span, TokenStream, TokenTree};

use super::random_choices::{Choices, check, panic_message};
use crate::pipeline::expand;

/// Three quarters of the smallest stack that a derive runs on, as in `long_expressions`.
const STACK: usize = 1536 * 1024;

/// What became of a case.
#[derive(PartialEq)]
enum Verdict {
    Implemented,
    Refused,
}

fn report(kind: &str, verdicts: &[Verdict], least_implemented: f64) {
    let implemented = verdicts.iter().filter(|verdict| **verdict == Verdict::Implemented).count();
    let fraction = implemented as f64 / verdicts.len() as f64;
    println!("{kind}: {} cases, {implemented} of them implemented", verdicts.len());
    // Where nearly everything is refused early, the later stages see nothing.
    assert!(fraction >= least_implemented, "{fraction} of the cases are implemented");
}

#[test]
fn structs_by_the_grammar() {
    let property =
        |choices: &mut Choices| expanded(grammar::structure(choices).parse().expect("the grammar's tokens"));
    report("by the grammar", &check(2000, STACK, property), 0.4);
}

#[test]
fn structs_with_mutated_tokens() {
    let property = |choices: &mut Choices| {
        let tokens = grammar::structure(choices).parse().expect("the grammar's tokens");
        expanded(mutation::mutated(tokens, choices))
    };
    report("mutated", &check(3000, STACK, property), 0.005);
}

#[test]
fn soup_in_the_attribute() {
    let property = |choices: &mut Choices| {
        let soup = mutation::soup(choices, 4);
        let items = choices.pick(&[
            "",
            "coordinates(x), lagrangian = der(x).powi(2),",
            "coordinates(x), potential = ",
        ]);
        let source = format!("#[evi({items})] struct Fuzzed {{ a: f64 }}");
        expanded(mutation::with_attribute(source.parse().expect("tokens"), soup))
    };
    report("soup", &check(5000, STACK, property), 0.01);
}

/// Expands twice, and looks at what comes out.
fn expanded(tokens: TokenStream) -> Result<Verdict, String> {
    let source = tokens.to_string();
    if std::env::var_os("EVI_FUZZ_SHOW").is_some() {
        println!("{source}");
    }
    let expansion = catch_unwind(|| expand(tokens.clone()))
        .map_err(|payload| format!("{} in {source}", panic_message(&*payload)))?;
    if expand(tokens.clone()).to_string() != expansion.to_string() {
        return Err(format!("two expansions of {source}"));
    }
    if let Err(error) = syn::parse2::<syn::File>(expansion.clone()) {
        return Err(format!("{error} in the expansion of {source}"));
    }
    let mut errors = Vec::new();
    find_errors(expansion, &mut errors);
    let nowhere = errors.iter().find(|error| !error.is_placed);
    // Deeper than this the stack is for the expansion alone. What is no item, rustc has refused already.
    let is_shallow = !errors.iter().any(|error| error.message.contains("nested too deeply"));
    let is_item = is_shallow && syn::parse2::<syn::DeriveInput>(tokens).is_ok();
    match nowhere {
        Some(error) if is_item => Err(format!("{} stands nowhere in {source}", error.message)),
        None if errors.is_empty() && !is_item => Err(format!("no error in {source}, which is no item")),
        _ if errors.is_empty() => Ok(Verdict::Implemented),
        _ => Ok(Verdict::Refused),
    }
}

/// An error that an expansion reports.
struct ReportedError {
    message: String,
    /// Whether its first and last tokens are in the source.
    is_placed: bool,
}

fn find_errors(tokens: TokenStream, errors: &mut Vec<ReportedError>) {
    let trees: Vec<TokenTree> = tokens.into_iter().collect();
    for (at, tree) in trees.iter().enumerate() {
        match tree {
            TokenTree::Ident(name) if name == "compile_error" => {
                let Some(TokenTree::Group(argument)) = trees.get(at + 2) else { continue };
                assert_eq!(argument.delimiter(), Delimiter::Brace);
                let is_placed = is_in_source(name.span()) && is_in_source(argument.span_close());
                errors.push(ReportedError { message: argument.stream().to_string(), is_placed });
            }
            TokenTree::Group(group) => find_errors(group.stream(), errors),
            _ => {}
        }
    }
}

/// Whether a span is that of a token which was read, not of one that was made.
fn is_in_source(span: Span) -> bool {
    !span.byte_range().is_empty()
}
