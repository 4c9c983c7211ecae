//! Differentiation against the dual numbers of num-dual over the undifferentiated graph.

use num_dual::HyperDual64;

use super::workbench::{Point, VARIABLES, agree, expression, random_expressions};
use crate::differentiate::{partial, rate};
use crate::expr::evaluate::evaluate;
use crate::expr::{ExprId, Graph, Symbol};

/// Compares the value, all first and all second derivatives of a root at a point; their largest absolute
/// value.
#[track_caller]
fn check_derivatives(name: &str, graph: &mut Graph, root: ExprId, point: &Point) -> f64 {
    let mut largest = 0.0_f64;
    let mut compare = |what: &str, graph: &Graph, derivative: Option<ExprId>, reference: f64, scale: f64| {
        let (value, scale) = match derivative {
            None => (0.0, scale),
            Some(id) => (point.evaluate(graph, id), scale.max(point.largest_term(graph, id))),
        };
        assert!(reference.is_finite(), "{name}, {what}: the reference is {reference}");
        assert!(
            agree(value, reference, scale),
            "{name}, {what}: {value:e}, but dual numbers say {reference:e}"
        );
        largest = largest.max(reference.abs());
    };
    let scale = point.largest_term(graph, root);
    for (k, &first) in VARIABLES.iter().enumerate() {
        let derivative = partial(graph, root, first);
        for &second in &VARIABLES[k..] {
            let dual = point.evaluate_dual(graph, root, |symbol, value| {
                let part = |seeded: Symbol| if symbol == seeded { 1.0 } else { 0.0 };
                HyperDual64::new(value, part(first), part(second), 0.0)
            });
            compare(&format!("{first:?}"), graph, derivative, dual.eps1, scale);
            let twice = derivative.and_then(|derivative| partial(graph, derivative, second));
            compare(
                &format!("{first:?} {second:?}"),
                graph,
                twice,
                dual.eps1eps2,
                scale.max(dual.eps1.abs()),
            );
        }
    }
    graph.verify();
    largest
}

#[track_caller]
fn check(text: &str) {
    let mut graph = Graph::default();
    let root = expression(&mut graph, text);
    for seed in 0..5 {
        let largest = check_derivatives(text, &mut graph, root, &Point::new(seed));
        assert!(largest > 0.0, "{text}: no derivative differs from zero, nothing is compared");
    }
}

#[test]
fn sums_and_products() {
    check("x + a * y");
    check("x * y * der(x)");
    check("x - y - x * t");
    check("-(x * y)");
}

#[test]
fn quotients() {
    check("x / (2.0 + y.sin())");
    check("1.0 / (2.0 + x * y)");
    check("x / a");
}

#[test]
fn integer_powers() {
    check("(x * y).powi(1)");
    check("(x * y).powi(2)");
    check("(x * y).powi(3)");
    check("(x * y).powi(19)");
    check("(2.0 + x.sin() * y).powi(-1)");
    check("(2.0 + x.sin() * y.cos()).powi(-4)");
    check("(x * y).powi(0) + x");
}

#[test]
fn real_powers() {
    check("(2.0 + x.sin()).powf(1.7)");
    check("(2.0 + x.sin()).powf(a)");
    check("(2.0 + x.sin()).powf(y)");
    check("a.powf(x * y)");
}

#[test]
fn functions_of_one_operand() {
    check("(1.0 + x * x * y * y).sqrt()");
    check("(x * y).sin()");
    check("(x * y).cos()");
    check("(0.4 * x * y).tan()");
    check("(x * y).exp()");
    check("(4.0 + x * y).ln()");
    check("(0.3 * x * y).asin()");
    check("(0.3 * x * y).acos()");
    check("(x * y).atan()");
    check("(x * y).sinh()");
    check("(x * y).cosh()");
    check("(x * y).tanh()");
    check("(x * y).abs()");
}

#[test]
fn angle_of_a_point_in_every_quadrant() {
    check("(3.0 + x).atan2(3.0 + y)");
    check("(3.0 + x).atan2(y - 3.0)");
    check("(x - 3.0).atan2(3.0 + y)");
    check("(x - 3.0).atan2(y - 3.0)");
}

#[test]
fn random_expressions_in_all_variables() {
    let mut n_with_derivatives = 0;
    for (seed, mut graph, root) in random_expressions() {
        let name = format!("seed {seed}");
        let largest = check_derivatives(&name, &mut graph, root, &Point::new(seed));
        n_with_derivatives += usize::from(largest > 0.0);
    }
    // Some are constant by chance, such as a power with the exponent 0.
    assert!(n_with_derivatives > 150, "only {n_with_derivatives} expressions have derivatives");
}

#[test]
fn what_does_not_vary_has_no_derivative() {
    #[track_caller]
    fn check(text: &str, symbol: Symbol) {
        let mut graph = Graph::default();
        let root = expression(&mut graph, text);
        assert_eq!(partial(&mut graph, root, symbol), None, "{text}");
    }
    check("a * b + 2.0", Symbol::Coordinate(0));
    check("x * t", Symbol::Coordinate(1));
    check("x", Symbol::Velocity(0));
    check("der(x)", Symbol::Coordinate(0));
    check("PI * y", Symbol::Time);
}

#[test]
fn slope_of_the_absolute_value_is_constant() {
    let mut graph = Graph::default();
    let root = expression(&mut graph, "x.abs()");
    let slope = partial(&mut graph, root, Symbol::Coordinate(0)).expect("|x| varies with x");
    assert_eq!(partial(&mut graph, slope, Symbol::Coordinate(0)), None);
}

/// `d/dt` is the directional derivative along `(v, 1)`, twice: `vᵀ φ_qq v + 2 φ_qt v + φ_tt`.
#[test]
fn second_rate_is_the_curvature() {
    #[track_caller]
    fn check(text: &str) {
        let mut graph = Graph::default();
        let root = expression(&mut graph, text);
        let first = rate(&mut graph, root).expect("the expression moves");
        let second = rate(&mut graph, first).expect("the expression moves twice");
        let point = Point::new(7);
        let dual = point.evaluate_dual(&graph, root, |symbol, value| match symbol {
            Symbol::Coordinate(i) => {
                let velocity = point.value(Symbol::Velocity(i));
                HyperDual64::new(value, velocity, velocity, 0.0)
            }
            Symbol::Time => HyperDual64::new(value, 1.0, 1.0, 0.0),
            _ => HyperDual64::from(value),
        });
        let scale = point.largest_term(&graph, second);
        assert!(agree(point.evaluate(&graph, first), dual.eps1, scale), "{text}");
        assert!(agree(point.evaluate(&graph, second), dual.eps1eps2, scale), "{text}");
        assert!(dual.eps1eps2.abs() > 1e-3, "{text}: nothing is compared");
    }
    check("x * y");
    check("x * x + y * y - (a * t).sin()");
    check("(x * t).sin() * y");
}

/// `n − 1` is no 32-bit integer in the second derivative.
#[test]
fn the_lowest_power_that_can_be_written() {
    let mut graph = Graph::default();
    let root = expression(&mut graph, "x.powi(-2147483647)");
    let exponent = -2_147_483_647.0;
    let (mut derivative, mut expected) = (root, 1.0);
    for k in 0..3 {
        derivative = partial(&mut graph, derivative, Symbol::Coordinate(0)).expect("a derivative");
        expected *= exponent - f64::from(k);
        // At x = 1.
        let value: f64 = evaluate(&graph, &[derivative], |_| 1.0)[0];
        assert!(
            (value - expected).abs() <= 4.0 * f64::EPSILON * expected.abs(),
            "{value} instead of {expected}"
        );
    }
}
