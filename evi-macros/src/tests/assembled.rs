//! Scenes whose sums and families stay loops: what the families are, and that the code does not grow with the bodies.

use proc_macro2::{TokenStream, TokenTree};

use crate::diagnostics::Diagnostics;
use crate::expr::{Affine, Graph, Notation};
use crate::model::{Assembled, Family, Place, coordinate_entries, resolve_assembled};
use crate::pipeline::expand;
use crate::syntax;

/// A chain of `n` point masses.
fn chain(n: &str) -> String {
    format!(
        "#[evi(coordinates(p: [{n}, 2]),
              kinetic = sum(0..{n}, |i| 0.5 * m[i] * der(p[i]).norm_squared()),
              potential = g * sum(0..{n}, |k| m[k] * p[k][1]),
              constraint(first: p[0].norm_squared() == l[0].powi(2)),
              constraint(link[i in 1..{n}]: (p[i] - p[i - 1]).norm_squared() == l[i].powi(2)))]
         struct Chain {{ m: [f64; {n}], l: [f64; {n}], g: f64 }}"
    )
}

/// The families, and the names of the arrays of coordinates.
fn resolved(source: &str) -> (Assembled, Vec<String>) {
    let mut diagnostics = Diagnostics::default();
    let Ok(declaration) = syntax::parse(source.parse().expect("tokens"), &mut diagnostics) else {
        panic!("a test's struct is a struct: {source}");
    };
    let assembled = resolve_assembled(&declaration, &mut Graph::default(), &mut diagnostics);
    let mistakes: Vec<&str> = diagnostics.mistakes().iter().map(|mistake| mistake.message.as_str()).collect();
    assert!(mistakes.is_empty(), "{mistakes:?} in {source}");
    let names = coordinate_entries(&declaration).iter().map(|entry| entry.name.to_string()).collect();
    (assembled.expect("a struct without mistakes is a sum of families"), names)
}

/// Ranges, coordinates and constraints of every family.
fn families(source: &str) -> Vec<String> {
    let (assembled, names) = resolved(source);
    let print = |index: &Affine| index.print(Notation::Unicode);
    let place = |place: &Place| {
        let indices: Vec<String> = place.indices.iter().map(print).collect();
        let name = &names[place.array];
        if indices.is_empty() { name.clone() } else { format!("{name}[{}]", indices.join(", ")) }
    };
    let family = |family: &Family| {
        let ranges =
            family.ranges.iter().map(|range| format!("{}..{} ", print(&range.from), print(&range.to)));
        let places: Vec<String> = family.places.iter().map(place).collect();
        let constraints = family.constraints.iter().map(|name| format!("; {name}"));
        format!("{}({}){}", ranges.collect::<String>(), places.join(", "), constraints.collect::<String>())
    };
    assembled.families.iter().map(family).collect()
}

#[test]
fn energies_over_one_range_are_one_family_whatever_their_index_is_called() {
    let expected = [
        "0..N (p[i, 0], p[i, 1])",
        "(p[0, 0], p[0, 1]); first",
        "1..N (p[i − 1, 0], p[i − 1, 1], p[i, 0], p[i, 1]); link",
    ];
    assert_eq!(families(&chain("N")), expected);
}

#[test]
fn terms_are_distributed_over_their_sums() {
    let found = families(
        "#[evi(coordinates(p: [N], x),
              let total = sum(0..N, |i| p[i]) - x,
              kinetic = 0.5 * (sum(0..N, |i| der(p[i]).powi(2)) + der(x).powi(2)) / m,
              potential = -(k * total - sum(0..N, |i| sum(i + 1..N, |j| 1.0 / (p[i] - p[j]).abs()))),
              dissipation = c * sum(0..N, |j| der(p[j]).powi(2)),
              force(p[i in 0..N]: -p[i]), force(x: t))]
         struct S { m: f64, k: f64, c: f64 }",
    );
    // A coefficient is part of every element; what has no sum is one element.
    assert_eq!(found, ["0..N (p[i])", "(x)", "0..N i + 1..N (p[i], p[j])"]);
}

#[test]
fn observed_quantities_are_families_of_their_own() {
    let source = "#[evi(coordinates(p: [N, 2], x),
              lagrangian = sum(0..N, |i| m * der(p[i]).norm_squared()) + der(x).powi(2),
              input(push), force(x: push),
              observe(height: sum(0..N, |i| p[i][1]) / total - x),
              observe(power: push * der(x)))]
         struct S { m: f64, total: f64 }";
    // They move nothing.
    assert_eq!(families(source), ["0..N (p[i, 0], p[i, 1])", "(x)"]);
    let (assembled, _) = resolved(source);
    assert_eq!(assembled.observables, ["height", "power"]);
    let terms: Vec<(usize, usize, usize)> = assembled
        .observed
        .iter()
        .map(|(quantity, family)| {
            (*quantity, family.ranges.len(), assembled.elements[family.element].inputs.len())
        })
        .collect();
    assert_eq!(terms, [(0, 1, 0), (0, 0, 0), (1, 0, 1)]);
}

#[test]
fn trees_and_rings_are_several_families() {
    let source = "#[evi(coordinates(p: [2 * N + 1, 2]),
              lagrangian = sum(0..2 * N + 1, |i| der(p[i]).norm_squared()),
              constraint(left[i in 0..N]: (p[2 * i + 1] - p[i]).norm_squared() == l),
              constraint(right[i in 0..N]: (p[2 * i + 2] - p[i]).norm_squared() == l),
              constraint(closing: p[2 * N] == p[N]))]
         struct S { l: f64 }";
    let found = families(source);
    let expected = [
        "0..2 N + 1 (p[i, 0], p[i, 1])",
        "0..N (p[i, 0], p[i, 1], p[2 i + 1, 0], p[2 i + 1, 1]); left",
        "0..N (p[i, 0], p[i, 1], p[2 i + 2, 0], p[2 i + 2, 1]); right",
        "(p[N, 0], p[N, 1], p[2 N, 0], p[2 N, 1]); closing[0]; closing[1]",
    ];
    assert_eq!(found, expected);
    // Both branches of a body are one element.
    let elements: Vec<usize> = resolved(source).0.families.iter().map(|family| family.element).collect();
    assert_eq!(elements, [0, 1, 1, 2]);
}

fn size(tokens: TokenStream) -> usize {
    let inside = |token| match token {
        TokenTree::Group(group) => 1 + size(group.stream()),
        _ => 1,
    };
    tokens.into_iter().map(inside).sum()
}

/// The tokens of the expansion.
fn expanded(source: &str) -> TokenStream {
    let tokens = expand(source.parse().expect("a test's struct is made of Rust tokens"));
    assert!(!tokens.to_string().contains("compile_error"), "{tokens}");
    assert!(syn::parse2::<syn::File>(tokens.clone()).is_ok(), "{tokens}");
    tokens
}

#[test]
fn the_code_does_not_grow_with_the_bodies() {
    let sizes: Vec<usize> =
        ["N", "100", "1000", "1000000"].iter().map(|n| size(expanded(&chain(n)))).collect();
    assert_eq!(sizes[1], sizes[2], "{sizes:?}");
    assert_eq!(sizes[2], sizes[3], "{sizes:?}");
    // A constant is cast where a literal is not.
    assert!(sizes[0] < sizes[1] + sizes[1] / 10, "{sizes:?}");
    let unrolled = size(expanded(&chain("20")));
    assert!(unrolled > 2 * sizes[1], "{unrolled} tokens for 20 bodies, {sizes:?} for loops");
}

#[test]
fn the_same_scene_expands_to_the_same_tokens() {
    let first = expanded(&chain("N")).to_string();
    let elsewhere = std::thread::scope(|scope| scope.spawn(|| expanded(&chain("N")).to_string()).join());
    assert_eq!(first, elsewhere.expect("the expansion succeeds"));
}

#[track_caller]
fn check_mistake(items: &str, message: &str) {
    let source = format!("#[evi(coordinates(p: [N]), {items})] struct S {{ m: [f64; N], k: f64 }}");
    let text = expand(source.parse().expect("tokens")).to_string();
    assert_eq!(text.matches("compile_error").count(), 1, "{text}");
    assert!(text.contains(message), "{text}");
}

#[test]
fn what_no_loop_over_elements_is_worth_is_refused() {
    let kinetic = "kinetic = sum(0..N, |i| der(p[i]).powi(2))";
    let check = |potential: &str, message: &str| {
        check_mistake(&format!("{kinetic}, potential = {potential}"), message)
    };
    check("sum(0..N, |i| p[i]).powi(2)", "a sum inside of a product of sums, a power or a function");
    check("sum(0..N, |i| p[i]) * sum(0..N, |i| p[i])", "a sum inside of a product of sums");
    check("1.0 / sum(0..N, |i| p[i])", "a sum inside of a product of sums");
    check(
        "{ let all = sum(0..N, |i| p[i]); sum(0..N, |i| p[i] * all) }",
        "does not depend on the index of the sum around it",
    );
    check("p.norm()", "is an array of `N` elements");
    check("p[0] * [1.0, 2.0][N]", "an index of a vector that is computed is a number");
    let items = |item: &str| format!("{kinetic}, potential = 0.0, {item}");
    check_mistake(
        &items("constraint(all: sum(0..N, |i| p[i]) == 0.0)"),
        "a constraint that joins all elements",
    );
    check_mistake(&items("force(p[0]: sum(0..N, |i| p[i]))"), "a force of a family names its elements");
    check_mistake(&items("force(p: 1.0)"), "write `p[i in 0..N]` for all of its elements");
    check_mistake(
        &items("frequency(p[i in 0..N]: sum(0..N, |j| 1.0 * j))"),
        "a frequency of curves is made of parameters by their names and indices",
    );
    check_mistake(
        &items("observe(each[i in 0..N]: p[i])"),
        "a quantity of a family is one number per element where sums stay loops",
    );
    check_mistake(
        &items("observe(length: sum(0..N, |i| p[i]).sqrt())"),
        "a sum inside of a product of sums, a power or a function would be no sum over elements",
    );
    check_mistake("kinetic = 0.0, potential = p[0]", "coordinate `p` has no mass");
}
