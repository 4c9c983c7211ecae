//! A central force, put together from its distance, is the force of the Lagrangian.

use super::workbench::{Compiled, Point, agree, compiled};
use crate::expr::evaluate::evaluate;
use crate::expr::{ExprId, Graph, Symbol};
use crate::mechanics::CentralForce;

/// `f − F'(r) ∂r/∂q` at random points is `∂L/∂q`; and `r ∂r/∂q` changes by the metric, `F'` by `F''`, as differences of them do.
#[track_caller]
fn check(potential: &str) {
    let source = format!(
        "#[evi(
            coordinates(x, y, z),
            kinetic = 0.5 * a * (der(x).powi(2) + der(y).powi(2) + der(z).powi(2)),
            potential = {potential},
        )]
        struct Central {{ a: f64, b: f64, c: f64 }}"
    );
    let Compiled { graph, equations, .. } = compiled(&source);
    let found = equations.central_force.as_ref().unwrap_or_else(|| panic!("not found in {potential}"));
    for seed in 0..20 {
        let point = Point::new(seed);
        let value = |graph: &Graph, root: ExprId, r: f64| -> f64 {
            evaluate(
                graph,
                &[root],
                |symbol| if symbol == Symbol::Distance { r } else { point.value(symbol) },
            )[0]
        };
        let r = point.evaluate(&graph, found.square).sqrt();
        let CentralForce { radial, metric, force, slope, uniform, .. } = found;
        let along = value(&graph, *force, r);
        for i in 0..3 {
            let expected = point.evaluate(&graph, equations.force[i]);
            let together = point.evaluate(&graph, uniform[i]) - along * point.evaluate(&graph, radial[i]) / r;
            let scale = point.largest_term(&graph, equations.force[i]);
            assert!(agree(together, expected, scale), "{together} is not {expected} in {potential}");
            for k in 0..3 {
                let beside =
                    |symbol| point.value(symbol) + f64::from(u8::from(symbol == Symbol::Coordinate(k)));
                let change =
                    evaluate::<f64>(&graph, &[radial[i]], beside)[0] - point.evaluate(&graph, radial[i]);
                assert!(agree(change, point.evaluate(&graph, metric[3 * i + k]), 4.0), "{potential}");
            }
        }
        let distance = 1e-5;
        let change = value(&graph, *force, r + distance) - value(&graph, *force, r - distance);
        let expected = value(&graph, *slope, r);
        assert!((change / (2.0 * distance) - expected).abs() < 1e-6 * (1.0 + expected.abs()), "{potential}");
    }
}

#[test]
fn forces_along_a_distance_are_those_of_the_potential() {
    check("0.5 * b * ((x.powi(2) + y.powi(2) + z.powi(2)).sqrt() - c).powi(2) + c * z - 2.0 * x");
    check("-b / ((x - c).powi(2) + (y + b).powi(2)).sqrt()");
    check("b * ((x - y).powi(2) + 2.0 * z.powi(2)).powf(-0.7) + b * c * y");
    check(
        "b * (c.powi(2) + (x - c * z).powi(2) + 3.0 * (y - b).powi(2)).ln() - ((y - b).powi(2) * 3.0 + (c * z - x).powi(2)).powi(3)",
    );
    check("(x.powi(2) + y.powi(2)) * (-b * (y.powi(2) + x.powi(2)).sqrt()).exp()");
}

#[track_caller]
fn check_none(potential: &str) {
    let source = format!(
        "#[evi(coordinates(x, y), kinetic = 0.5 * a * (der(x).powi(2) + der(y).powi(2)), potential = {potential})]
        struct Other {{ a: f64, b: f64 }}"
    );
    assert!(compiled(&source).equations.central_force.is_none(), "{potential}");
}

#[test]
fn what_is_no_sum_of_independent_squares_is_no_distance() {
    check_none("b * (x * y).sin()");
    check_none("b * (x.powi(2) + y.powi(3)).sqrt()");
    check_none("b * (x.powi(2) + a * y.powi(2)).sqrt()");
    check_none("b * (x.powi(2) - y.powi(2)).cos()");
    check_none("b * ((x + y).powi(2) + (x - y).powi(2)).sqrt()");
    check_none("b * (x.powi(2) + y.powi(2)).sqrt() * x");
    check_none("b * x.powi(2) + a * y.powi(2)");
}

/// Four distances are tried, not thousands: the time of a derive is bounded.
#[test]
fn many_sums_of_squares_do_not_delay_the_derive() {
    let terms: Vec<String> =
        (0..2_000).map(|k| format!("(({k}.5 + x).powi(2) + y.powi(2)).sqrt()")).collect();
    check_none(&terms.join(" + "));
}
