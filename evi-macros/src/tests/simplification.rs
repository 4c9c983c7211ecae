//! Simplification: every rule once, and values before and after.

use super::workbench::{Point, VARIABLES, agree, expression, random_expressions};
use crate::differentiate::partial;
use crate::expr::{Binary, Graph, Unary};
use crate::simplify::Simplifier;

/// `text` simplifies to the expression that `normal_form` writes.
#[track_caller]
fn check(text: &str, normal_form: &str) {
    let mut graph = Graph::default();
    let (root, expected) = (expression(&mut graph, text), expression(&mut graph, normal_form));
    let simplified = Simplifier::default().simplify(&mut graph, root);
    assert_eq!(
        simplified,
        expected,
        "{text} became {:?}, not {:?}, of {:?}",
        graph.node(simplified),
        graph.node(expected),
        graph.operands(simplified).map(|id| graph.node(id)).collect::<Vec<_>>(),
    );
    assert_eq!(
        Simplifier::default().simplify(&mut graph, simplified),
        simplified,
        "{text}: not a normal form"
    );
    graph.verify();
}

/// `text` stays as it is.
#[track_caller]
fn check_kept(text: &str) {
    check(text, text);
}

#[test]
fn numbers_fold() {
    check("2.0 + 3.0", "5.0");
    check("2.0 - 0.5", "1.5");
    check("2.0 * 3.0", "6.0");
    check("3.0 / 4.0", "0.75");
    check("2.0.powi(10)", "1024.0");
    check("2.0.powi(-2)", "0.25");
    check("2.25.sqrt()", "1.5");
    check("2.25.powf(0.5)", "1.5");
    check("4.0 - 4.0 * 1.0", "0.0");
    check("2.5.abs()", "2.5");
}

#[test]
fn numbers_that_would_overflow_or_vanish_do_not_fold() {
    check("1e308 + 1e308", "2.0 * 1e308");
    check_kept("1e308 * 1e308");
    check_kept("1e-308 * 1e-308");
    check_kept("1e308 / 1e-308");
    check_kept("1e-308 / 1e308");
    check_kept("x / 0.0");
    check_kept("0.0 / 0.0");
}

#[test]
fn functions_of_numbers_are_left_to_the_target() {
    check_kept("2.0.sin()");
    check_kept("2.0.ln()");
    check_kept("2.0.exp()");
    check_kept("2.0.powf(0.3)");
    check_kept("2.0.powi(17)");
}

#[test]
fn neutral_elements() {
    check("x + 0.0", "x");
    check("0.0 + x", "x");
    check("x - 0.0", "x");
    check("x * 1.0", "x");
    check("1.0 * x", "x");
    check("x / 1.0", "x");
    check("x.powi(1)", "x");
    check("x.powf(1.0)", "x");
}

#[test]
fn zeros() {
    check("x * 0.0", "0.0");
    check("0.0 * x.ln()", "0.0");
    check("0.0 / x", "0.0");
    check("x - x", "0.0");
    check("x + (-x)", "0.0");
    check("-x + x", "0.0");
    check("x * y - y * x", "0.0");
    check("-0.0 * x", "0.0");
}

#[test]
fn ones() {
    check("x / x", "1.0");
    check("(x * y) / (y * x)", "1.0");
    check("a / a", "1.0");
    check("x.powi(0)", "1.0");
    check("x.powf(0.0)", "1.0");
    check("(2.0 * a * x) / (4.0 * a * x)", "0.5");
}

#[test]
fn signs() {
    check("-(-x)", "x");
    check("x + (-y)", "x - y");
    check("-x + y", "y - x");
    check("x - (-y)", "x + y");
    check("-x - y", "-(x + y)");
    check("-x * -y", "x * y");
    check("x * -y", "-(x * y)");
    check("-x / y", "-(x / y)");
    check("0.0 - x", "-x");
    check("-1.0 * x", "-x");
}

#[test]
fn equal_terms_double() {
    check("x + x", "2.0 * x");
    check("x * y + y * x", "2.0 * (x * y)");
    check("a * x + a * x", "(2.0 * a) * x");
    check("-x - x", "-(2.0 * x)");
}

#[test]
fn products_collect_numbers_and_parameters() {
    check("x * 2.0", "2.0 * x");
    check("2.0 * (3.0 * x)", "6.0 * x");
    check("x * a", "a * x");
    check("2.0 * x * a", "(2.0 * a) * x");
    check("(a * x) * (b * y)", "(a * b) * (x * y)");
}

#[test]
fn quotients_collect_numbers_and_parameters() {
    check("(2.0 * x) / 4.0", "0.5 * x");
    check("x / a", "(1.0 / a) * x");
    check("(a * x) / (b * y)", "(a / b) * (x / y)");
    check("1.0 / (2.0 * x)", "0.5 * (1.0 / x)");
    check("(a * x) / (a * y)", "x / y");
}

#[test]
fn small_powers_are_shared_squares() {
    check("x.powi(2)", "x * x");
    check("x.powi(3)", "x * (x * x)");
    check("x.powi(4)", "{ let s = x * x; s * s }");
    check("x.powi(5)", "{ let s = x * x; x * (s * s) }");
    check("x.powi(16)", "{ let s = x * x; let s = s * s; let s = s * s; s * s }");
    check("x.powi(-1)", "1.0 / x");
    check("x.powi(-2)", "1.0 / (x * x)");
    check("(2.0 * x).powi(2)", "4.0 * (x * x)");
    check("(-x).powi(3)", "-(x * (x * x))");
    check("(-x).powi(2)", "x * x");
}

#[test]
fn large_powers_stay() {
    check_kept("x.powi(17)");
    check("x.powi(-17)", "1.0 / x.powi(17)");
}

#[test]
fn real_powers_with_simple_exponents() {
    check("x.powf(0.5)", "x.sqrt()");
    check("x.powf(2.0)", "x * x");
    check("x.powf(-2)", "1.0 / (x * x)");
    check("x.powf(1.0 + 1.0)", "x * x");
    check_kept("x.powf(1.5)");
    check_kept("x.powf(17.0)");
    check_kept("x.powf(a)");
    check_kept("x.powf(y)");
}

#[test]
fn operands_are_simplified_below_any_operator() {
    check("(x + 0.0).sin()", "x.sin()");
    check("(1.0 * x).atan2(y / 1.0)", "x.atan2(y)");
    check("(x + 0.0).powf(1.0 * y)", "x.powf(y)");
    check("{ let s = x * 1.0; s.exp() + s }", "x.exp() + x");
}

/// `Abs` and `Neg` of a number, which no user writes but derivatives do.
#[test]
fn negative_numbers_fold() {
    let mut graph = Graph::default();
    let number = graph.number(-2.0);
    let (absolute, negative) = (graph.unary(Unary::Abs, number), graph.unary(Unary::Neg, number));
    let root = graph.unary(Unary::Sqrt, number);
    let mut simplifier = Simplifier::default();
    let two = graph.number(2.0);
    let x = expression(&mut graph, "x");
    let (difference, sum) = (graph.sub(x, two), graph.add(x, number));
    assert_eq!(simplifier.simplify(&mut graph, difference), sum);
    assert_eq!(simplifier.simplify(&mut graph, absolute), two);
    assert_eq!(simplifier.simplify(&mut graph, negative), two);
    assert_eq!(simplifier.simplify(&mut graph, root), root, "√−2 is left for the user to see at run time");
}

/// Compares values before and after, and simplifies what is simplified once more.
#[test]
fn values_are_kept() {
    for (seed, mut graph, root) in random_expressions() {
        let point = Point::new(seed);
        let mut simplifier = Simplifier::default();
        let mut roots = vec![root];
        roots.extend(VARIABLES.iter().filter_map(|&symbol| partial(&mut graph, root, symbol)));
        for root in roots {
            let simplified = simplifier.simplify(&mut graph, root);
            let (value, reference) = (point.evaluate(&graph, simplified), point.evaluate(&graph, root));
            let scale = point.largest_term(&graph, root).max(point.largest_term(&graph, simplified));
            assert!(reference.is_finite(), "seed {seed}: the reference is {reference}");
            assert!(agree(value, reference, scale), "seed {seed}: {value:e} instead of {reference:e}");
            let again = Simplifier::default().simplify(&mut graph, simplified);
            assert_eq!(again, simplified, "seed {seed}: not a normal form");
        }
        graph.verify();
    }
}

#[test]
fn nothing_is_added() {
    for (seed, mut graph, root) in random_expressions() {
        let simplified = Simplifier::default().simplify(&mut graph, root);
        let functions = |id| {
            let is_function = |&id: &_| {
                matches!(graph.node(id), crate::expr::Node::Unary(operator, _) if operator != Unary::Neg)
                    || matches!(graph.node(id), crate::expr::Node::Binary(Binary::Powf | Binary::Atan2, ..))
            };
            graph.reachable(&[id], |_| false).iter().filter(|id| is_function(id)).count()
        };
        assert!(functions(simplified) <= functions(root), "seed {seed}");
    }
}
