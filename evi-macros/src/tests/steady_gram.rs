//! Entries of `G M⁻¹ Gᵀ` that the constraints fix, of scenes in which one knows them by hand.

use super::systems::{DOUBLE_PENDULUM, SPHERICAL_PENDULUM};
use super::workbench::{Compiled, Point, agree, compiled, expression, random_expressions};
use crate::expr::{Graph, vanishes};

/// The steady entries `(row, col, value)` at a point.
fn steady(source: &str, point: &Point) -> Vec<(usize, usize, f64)> {
    let Compiled { graph, equations, .. } = compiled(source);
    let entries = equations.steady_gram.iter();
    entries.map(|entry| (entry.row, entry.col, point.evaluate(&graph, entry.value))).collect()
}

#[track_caller]
fn check(source: &str, expected: impl Fn([f64; 6]) -> Vec<(usize, usize, f64)>) {
    for seed in 0..3 {
        let point = Point::new(seed);
        let parameter = |index| point.value(crate::expr::Symbol::Parameter(index));
        let (found, expected) = (steady(source, &point), expected(std::array::from_fn(parameter)));
        let places = |entries: &[(usize, usize, f64)]| -> Vec<(usize, usize)> {
            entries.iter().map(|&(row, col, _)| (row, col)).collect()
        };
        assert_eq!(places(&found), places(&expected), "{source}");
        for ((row, col, found), (_, _, expected)) in found.into_iter().zip(expected) {
            assert!(agree(found, expected, expected.abs()), "({row}, {col}): {found} for {expected}");
        }
    }
}

#[test]
fn rods_fix_their_own_entries_not_the_angle_between_them() {
    check(DOUBLE_PENDULUM, |[m1, m2, l1, l2, ..]| {
        vec![(0, 0, 4.0 * l1.powi(2) / m1), (1, 1, 4.0 * l2.powi(2) * (1.0 / m1 + 1.0 / m2))]
    });
    check(SPHERICAL_PENDULUM, |[m, l, ..]| vec![(0, 0, 4.0 * l.powi(2) / m)]);
}

/// The constraint's own form, with a mass for every direction.
const ELLIPSE: &str = "
    #[evi(
        coordinates(x, y),
        kinetic = 0.5 * m * (a * der(x).powi(2) + MASS * der(y).powi(2)),
        potential = 0.0,
        constraint(ellipse: a * x.powi(2) + b * y.powi(2) - x == l),
    )]
    struct Ellipse { m: f64, a: f64, b: f64, l: f64 }";

#[test]
fn what_holds_of_all_parameters_is_told_from_what_holds_of_some() {
    // `(2 a x − 1)²/m a + 4 b² y²/m b = (4/m) (a x² + b y² − x) + 1/m a`.
    check(&ELLIPSE.replace("MASS", "b"), |[m, a, _, l, ..]| vec![(0, 0, 4.0 * l / m + 1.0 / (m * a))]);
    check(&ELLIPSE.replace("MASS", "a"), |_| vec![]);
}

#[test]
fn numbers_are_not_rounded_before_they_are_compared() {
    // Neither 0.1 nor 0.3 is a float.
    let source = "
        #[evi(
            coordinates(x, y),
            kinetic = 0.5 * 0.3 * der(x).powi(2) + 0.5 * 0.3 * der(y).powi(2),
            potential = 0.0,
            constraint(rod: 0.1 * (x - 0.7).powi(2) + 0.1 * (y + x / 3.0 - x / 3.0).powi(2) == l),
        )]
        struct Rod { l: f64 }";
    check(source, |[l, ..]| vec![(0, 0, 4.0 * 0.1 * l / 0.3)]);
}

/// Orthonormal directors: every product of two of them is a constraint, and all of the matrix is steady.
#[test]
fn directors_fix_the_whole_matrix() {
    let source = "
        #[evi(
            coordinates(ax, ay, bx, by),
            kinetic = 0.5 * i * (der(ax).powi(2) + der(ay).powi(2)) + 0.5 * j * (der(bx).powi(2) + der(by).powi(2)),
            potential = 0.0,
            constraint(unit_a: ax.powi(2) + ay.powi(2) == 1.0),
            constraint(unit_b: bx.powi(2) + by.powi(2) == 1.0),
            constraint(right: ax * bx + ay * by == c),
        )]
        struct Directors { i: f64, j: f64, c: f64 }";
    check(source, |[i, j, c, ..]| {
        vec![
            (0, 0, 4.0 / i),
            (1, 1, 4.0 / j),
            (2, 0, 2.0 * c / i),
            (2, 1, 2.0 * c / j),
            (2, 2, 1.0 / i + 1.0 / j),
        ]
    });
    // Constraints 0 and 1 share no coordinate.
    assert_eq!(compiled(source).programs.structure.classification.constraint_graph, [(0, 2), (1, 2)]);
}

#[test]
fn nothing_is_steady_that_moves_with_time_or_by_a_varying_mass() {
    let rod = |mass: &str, constraint: &str| {
        format!(
            "#[evi(
                coordinates(x, y),
                kinetic = 0.5 * {mass} * (der(x).powi(2) + der(y).powi(2)),
                potential = 0.0,
                constraint(rod: {constraint}),
            )]
            struct Rod {{ m: f64, l: f64 }}"
        )
    };
    let circle = "x.powi(2) + y.powi(2) == l.powi(2)";
    check(&rod("m", circle), |[m, l, ..]| vec![(0, 0, 4.0 * l.powi(2) / m)]);
    check(&rod("(m + t)", circle), |_| vec![]);
    check(&rod("(m + x.powi(2))", circle), |_| vec![]);
    check(&rod("m", "x.powi(2) + y.powi(2) == l * t"), |_| vec![]);
    // The same circle, but no polynomial of degree two.
    check(&rod("m", "(x.powi(2) + y.powi(2)).sqrt() == l"), |_| vec![]);
    // Constant slopes.
    check(&rod("m", "x - l * y == l"), |[m, l, ..]| vec![(0, 0, (1.0 + l.powi(2)) / m)]);
}

#[test]
fn identities_of_rational_functions_are_known() {
    let is_identity = |text: &str| {
        let mut graph = Graph::default();
        let root = expression(&mut graph, text);
        vanishes(&graph, root)
    };
    assert!(is_identity("(x + a).powi(3) - (x.powi(3) + 3.0 * x * x * a + 3.0 * x * a * a + a.powi(3))"));
    assert!(is_identity("1.0 / (x - y) - (x + y) / (x * x - y * y)"));
    assert!(is_identity("(a * x).sin() * 2.0 - (x * a).sin() / 0.5"));
    assert!(!is_identity("(a * x).sin() - (a * y).sin()"));
    assert!(!is_identity("0.1 + 0.2 - 0.3 + 0.0 * x"), "not as floats, nor exactly");
    assert!(!is_identity("x / (y - y)"), "a pole is no zero");
    for (seed, mut graph, root) in random_expressions() {
        let same = graph.sub(root, root);
        assert!(vanishes(&graph, same), "seed {seed}");
        let twice = graph.add(root, root);
        assert!(!vanishes(&graph, twice), "seed {seed}: no random expression is zero");
    }
}
