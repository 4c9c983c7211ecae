//! Any tokens, right, nearly right or soup: the expansion never panics, hangs or overflows its stack, and what it says is Rust.
//!
//! Many cases, here a million in a quarter of an hour of a calm machine: `EVI_FUZZ_CASES=250000 CARGO_PROFILE_TEST_OPT_LEVEL=2
//! CARGO_PROFILE_TEST_BUILD_OVERRIDE_OPT_LEVEL=2 cargo test -p evi-macros fuzz -- --nocapture`, with `EVI_FUZZ_SEED=N` from case `N` on, with
//! `EVI_FUZZ_SHOW=1` printed. A failure names its case, made as small as it goes; the slowest is named, too.

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

/// Scenes with arrays, unrolled and as loops.
const SCENES_WITH_ARRAYS: [&str; 4] = [
    "#[evi(coordinates(p: [4, 2], x), let d = p[1] - p[0], kinetic = sum(0..4, |i| m[i] * der(p[i]).norm_squared()) + der(x).powi(2),
        potential = g.dot([x, d[0], d.norm()]) + sum(1..4, |i| sum(0..i, |j| (p[i] - p[j]).norm())),
        constraint(link[i in 1..4]: (p[i] - p[i - 1]).norm_squared() == 1.0), constraint(weld: p[3] == [x, 0.0]),
        force(p[i in 0..4][1]: i * x), frequency(p[2]: m[0]), observe(v[i in 0..2]: der(p[i])), input(u), force(x: u))]
     struct Fuzzed { m: [f64; 4], g: Vector3<f64> }",
    "#[evi(coordinates(p: [N, 2], x), let d = p[N - 1] - p[0], kinetic = 0.5 * (sum(0..N, |i| m[i] * der(p[i]).norm_squared()) + der(x).powi(2)),
        potential = g.dot([x, d[0], d.norm()]) - sum(1..N, |i| sum(0..i, |j| (p[i] - p[j]).norm())) / 2.0,
        constraint(link[i in 1..N]: (p[i] - p[i - 1]).norm_squared() == 1.0), constraint(weld: p[N - 1] == [x, 0.0]),
        force(p[i in 0..N][1]: i * x), dissipation = sum(0..N, |k| der(p[k]).dot(der(p[k]))))]
     struct Fuzzed { m: [f64; N], g: SVector<f64, 3> }",
    "#[evi(coordinates(p: [300, 2]), lagrangian = sum(0..300, |i| der(p[i]).norm_squared() * (i + 1)),
        constraint(net[i in 0..4, j in 0..i]: p[4 * i + j] == p[M * j + i]))] struct Fuzzed;",
    "#[evi(rigid_body(b, mass = 1.0, center = [0.0, 0.0, l], inertia = j), rigid_body(e, mass = m, center = j, inertia = [1.0, 2.0, 3.0]),
        potential = b.point([0.0, l, 1.0]).dot(e[0]), constraint(joint: b.point(j) == e.point([0.0, 0.0, 1.0])))]
     struct Fuzzed { l: f64, m: f64, j: [f64; 3] }",
];

#[test]
fn scenes_with_arrays_with_mutated_tokens() {
    let property = |choices: &mut Choices| {
        let tokens = choices.pick(&SCENES_WITH_ARRAYS).parse().expect("Rust tokens");
        expanded(mutation::mutated(tokens, choices))
    };
    report("mutated arrays", &check(1500, STACK, property), 0.005);
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
