//! The emitted tokens: the same for the same input, and in pieces that rustc can digest.

use proc_macro2::{Delimiter, TokenStream, TokenTree};

use super::random_expressions::{large_system, random_system};
use super::systems::SMALL_SYSTEMS;
use crate::pipeline::expand;

/// Statements of one function: rustc's stack in debug builds ends soon beyond.
const LARGEST_FUNCTION: usize = 5000;
/// `let`s of one scope.
const LARGEST_SCOPE: usize = 200;

fn expanded(source: &str) -> TokenStream {
    expand(source.parse().expect("a test's struct is made of Rust tokens"))
}

#[test]
fn the_same_struct_expands_to_the_same_tokens() {
    let random: Vec<String> = (0..10).map(|seed| random_system("Random", seed)).collect();
    let large = large_system("Large", 100);
    let sources =
        || SMALL_SYSTEMS.into_iter().chain(random.iter().map(String::as_str)).chain([large.as_str()]);
    let all = || -> Vec<String> { sources().map(|source| expanded(source).to_string()).collect() };
    let first = all();
    // Backwards, so that no expansion has the predecessor that it had before.
    let backwards: Vec<String> =
        sources().collect::<Vec<_>>().into_iter().rev().map(|source| expanded(source).to_string()).collect();
    assert_eq!(first, backwards.into_iter().rev().collect::<Vec<_>>());
    // Another thread seeds its hash maps differently.
    let elsewhere = std::thread::scope(|scope| scope.spawn(all).join()).expect("the expansion succeeds");
    assert_eq!(first, elsewhere);
}

#[test]
fn every_expansion_is_rust() {
    let random = (0..50).map(|seed| random_system("Random", seed));
    for source in SMALL_SYSTEMS.into_iter().map(str::to_owned).chain(random) {
        let tokens = expanded(&source);
        assert!(!tokens.to_string().contains("compile_error"), "{source}");
        assert!(syn::parse2::<syn::File>(tokens).is_ok(), "{source}");
    }
}

/// What the braces of a function hold, functions inside it left out.
#[derive(Default)]
struct Size {
    /// Statements at all depths.
    statements: usize,
    /// `let`s of the largest single scope.
    lets_of_a_scope: usize,
}

/// Appends the size of every function in the tokens; returns the size of what is in none of them.
fn measure(tokens: TokenStream, functions: &mut Vec<Size>) -> Size {
    let mut size = Size::default();
    let mut lets = 0;
    let mut behind_fn = false;
    for token in tokens {
        match token {
            TokenTree::Ident(word) if word == "fn" => behind_fn = true,
            TokenTree::Ident(word) if word == "let" => lets += 1,
            TokenTree::Punct(punct) if punct.as_char() == ';' => size.statements += 1,
            TokenTree::Group(group) => {
                let is_body = behind_fn && group.delimiter() == Delimiter::Brace;
                let inner = measure(group.stream(), functions);
                if is_body {
                    functions.push(inner);
                    behind_fn = false;
                } else {
                    size.statements += inner.statements;
                    size.lets_of_a_scope = size.lets_of_a_scope.max(inner.lets_of_a_scope);
                }
            }
            _ => {}
        }
    }
    size.lets_of_a_scope = size.lets_of_a_scope.max(lets);
    size
}

#[test]
fn functions_and_scopes_are_bounded() {
    let mut functions = Vec::new();
    measure(expanded(&large_system("Large", 800)), &mut functions);
    let statements = functions.iter().map(|size| size.statements).max();
    let lets = functions.iter().map(|size| size.lets_of_a_scope).max();
    let total: usize = functions.iter().map(|size| size.statements).sum();
    assert!(total > 2 * LARGEST_FUNCTION, "{total} statements would fit anyway");
    assert!(statements.is_some_and(|statements| statements <= LARGEST_FUNCTION), "{statements:?} statements");
    assert!(lets.is_some_and(|lets| lets <= LARGEST_SCOPE), "{lets:?} lets in a scope");
}

#[test]
fn emitted_code_names_only_the_private_module() {
    for source in SMALL_SYSTEMS {
        let text = expanded(source).to_string().replace(' ', "");
        for (at, _) in text.match_indices("::evi_core") {
            assert!(text[at..].starts_with("::evi_core::__private::"), "{source}");
        }
        assert!(!text.contains("::std::"), "evi-core works without std");
    }
}

/// A block may begin an expression: where a statement may stand, Rust would end the expression behind it.
#[test]
fn an_equation_may_begin_with_a_block() {
    let source = "#[evi(coordinates(x), lagrangian = { let v = der(x); v * v } - x)] struct S;";
    assert!(syn::parse2::<syn::File>(expanded(source)).is_ok());
}
