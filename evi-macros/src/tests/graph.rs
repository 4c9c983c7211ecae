//! The expression graph: equal expressions are one node, whatever the order of commutative operands.

use super::workbench::{compiled, expression, random_expressions};
use crate::expr::{Dependence, Graph, Symbol};

#[track_caller]
fn check_same(first: &str, second: &str) {
    let mut graph = Graph::default();
    assert_eq!(expression(&mut graph, first), expression(&mut graph, second), "{first} and {second}");
    graph.verify();
}

#[track_caller]
fn check_different(first: &str, second: &str) {
    let mut graph = Graph::default();
    assert_ne!(expression(&mut graph, first), expression(&mut graph, second), "{first} and {second}");
    graph.verify();
}

#[test]
fn equal_expressions_are_one_node() {
    check_same("(x * y).sin() + a", "(x * y).sin() + a");
    check_same("{ let s = x * y; s + s }", "x * y + x * y");
    check_same("2 * x", "2.0 * x");
    check_same("2e0_f64", "2");
    check_same("((x))", "x");
}

#[test]
fn sums_and_products_commute() {
    check_same("x + y", "y + x");
    check_same("x * y", "y * x");
    check_same("(a * x + b) * y", "y * (b + x * a)");
}

#[test]
fn nothing_else_commutes() {
    check_different("x - y", "y - x");
    check_different("x / y", "y / x");
    check_different("x.powf(y)", "y.powf(x)");
    check_different("x.atan2(y)", "y.atan2(x)");
    check_different("x.powi(2)", "x.powi(3)");
    check_different("x", "der(x)");
    check_different("x + (y + a)", "(x + y) + a");
}

#[test]
fn negative_zero_is_zero() {
    let mut graph = Graph::default();
    let (positive, negative) = (graph.number(0.0), graph.number(-0.0));
    assert_eq!(positive, negative);
    assert_eq!(graph.as_number(negative).map(f64::to_bits), Some(0.0_f64.to_bits()));
}

#[test]
fn numbers_are_told_apart_by_every_bit() {
    let mut graph = Graph::default();
    let next = 1.0 + f64::EPSILON;
    assert_ne!(graph.number(1.0), graph.number(next));
    let id = graph.number(next);
    assert_eq!(graph.as_number(id), Some(next));
    let smallest = f64::from_bits(1);
    let id = graph.number(smallest);
    assert_eq!(graph.as_number(id), Some(smallest), "subnormal numbers are kept");
}

/// Numbers that are not finite are an error of ours: that the graph refuses them is its invariant.
#[test]
fn numbers_are_finite() {
    for value in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
        let refused = std::panic::catch_unwind(|| Graph::default().number(value)).is_err();
        assert!(refused, "{value}");
    }
}

#[test]
fn dependence_is_that_of_the_symbols_below() {
    #[track_caller]
    fn check(text: &str, on_q: bool, on_v: bool, on_t: bool) {
        let mut graph = Graph::default();
        let root = expression(&mut graph, text);
        assert_eq!(graph.dependence(root), Dependence { on_q, on_v, on_t, on_inputs: false }, "{text}");
    }
    check("1.0", false, false, false);
    check("a * PI + b.sin()", false, false, false);
    check("a * x", true, false, false);
    check("der(y).powi(2)", false, true, false);
    check("(a * t).cos()", false, false, true);
    check("x.atan2(der(y)) / t", true, true, true);
}

#[test]
fn reachable_nodes_come_operands_first_and_stop_at_leaves() {
    let mut graph = Graph::default();
    let root = expression(&mut graph, "(x * y).sin() + x * y * (a + b)");
    let constant = expression(&mut graph, "a + b");
    let all = graph.reachable(&[root], |_| false);
    assert!(all.is_sorted() && all.last() == Some(&root));
    let cut = graph.reachable(&[root], |id| id == constant);
    assert_eq!(cut.len(), all.len() - 2, "a and b are below a leaf");
    let symbols: Vec<Symbol> = graph.symbols(&[root]).into_iter().collect();
    let expected = [Symbol::Parameter(0), Symbol::Parameter(1), Symbol::Coordinate(0), Symbol::Coordinate(1)];
    assert_eq!(symbols, expected);
}

#[test]
fn invariants_hold_after_every_stage() {
    for (_, graph, _) in random_expressions() {
        graph.verify();
    }
    for source in super::systems::SMALL_SYSTEMS {
        compiled(source).graph.verify();
    }
}
