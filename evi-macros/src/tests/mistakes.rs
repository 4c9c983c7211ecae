//! Mistakes in a struct: all of them are reported at once, and the stub has the true sizes.
//!
//! What each message says is the workspace's `tests/ui`.

use crate::pipeline::expand;

#[track_caller]
fn check(source: &str, n_mistakes: usize, n_coordinates: usize, n_constraints: usize) {
    let tokens = expand(source.parse().expect("a test's struct is made of Rust tokens"));
    let text = tokens.to_string().replace(' ', "");
    assert_eq!(text.matches("compile_error!").count(), n_mistakes, "{text}");
    let array = |size: &str, length: usize| format!("type{size}<X:::core::clone::Clone>=[X;{length}usize];");
    for (size, length) in [
        ("PerCoordinate", n_coordinates),
        ("PerConstraint", n_constraints),
        ("PerUnknown", n_coordinates + n_constraints),
    ] {
        assert!(text.contains(&array(size, length)), "{size} has not {length} elements: {text}");
    }
    assert!(text.contains("__private::MechanicalSystemfor"), "{text}");
    assert!(text.contains("__private::GenericSystemfor"), "{text}");
    assert!(syn::parse2::<syn::File>(tokens).is_ok(), "the stub is Rust");
}

#[test]
fn one_in_every_item() {
    let source = "
        #[evi(
            coordinates(x, y, z),
            let radius = (xx * x + y * y).sqrt(),
            kinetic = 0.5 * mass * (der(x).powi(2) + der(y).powi(2) + der(z).powi(2)),
            potential = x^2,
            constraint(first: radius = 1.0),
            constraint(second: der(x) == 0.0),
            constraint(third: x == 1.0),
        )]
        struct S { m: f64 }";
    check(source, 5, 3, 3);
}

#[test]
fn several_in_one_expression() {
    let source = "
        #[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential = xx + x^2 + 1/2 + x.sine() + der(m))]
        struct S { m: f64 }";
    check(source, 5, 1, 0);
}

#[test]
fn in_both_sides_of_a_constraint() {
    let source = "
        #[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential = 0.0, constraint(c: p + x == q))]
        struct S;";
    check(source, 2, 1, 1);
}

#[test]
fn in_repeated_attributes() {
    let source = "
        #[evi(coordinates(x, y), kinetic = der(x).powi(2))]
        #[evi(potential = unknown)]
        #[evi(nonsense = 1.0)]
        struct S;";
    // The coordinate y without mass is the third.
    check(source, 3, 2, 0);
}

#[test]
fn in_an_expression_that_does_not_parse() {
    let source = "
        #[evi(coordinates(x, y), kinetic = 0.5 * , potential = x +, constraint(c: x == y))]
        struct S;";
    check(source, 2, 2, 1);
}

#[test]
fn names_are_checked_together() {
    let source = "
        #[evi(coordinates(t, x, x), kinetic = 0.5 * der(x).powi(2), potential = 0.0)]
        struct S { x: f64 }";
    // `t`, `x` twice, and the coordinate `t` without mass; the second `x` is none.
    let tokens = expand(source.parse().expect("Rust tokens")).to_string();
    assert!(tokens.matches("compile_error").count() >= 3, "{tokens}");
}

#[test]
fn on_what_is_no_struct_with_named_fields() {
    check("#[evi(coordinates(x), kinetic = der(x), potential = 0.0)] struct S(f64);", 1, 1, 0);
    check("#[evi(coordinates(x), kinetic = der(x), potential = 0.0)] enum E { A }", 1, 1, 0);
    check("struct S { m: f64 }", 1, 0, 0);
}

/// Inputs and observed quantities are counted in items that are mistaken.
#[test]
fn forces_and_what_belongs_to_them() {
    let source = "
        #[evi(
            coordinates(x, y),
            lagrangian = 0.5 * der(x).powi(2) + 0.5 * der(y).powi(2),
            input(u, w),
            force(x: u + v),
            force(y: w^2),
            frequency(x: y),
            observe(first: z),
            observe(second: u),
        )]
        struct S;";
    check(source, 4, 2, 0);
    let text = expand(source.parse().expect("tokens")).to_string().replace(' ', "");
    assert!(text.contains("typePerInput<X:::core::clone::Clone>=[X;2usize];"), "{text}");
    assert!(text.contains("typePerObservable<X:::core::clone::Clone>=[X;2usize];"), "{text}");
    assert!(text.contains("__private::HasFrequenciesforS"), "{text}");
}
