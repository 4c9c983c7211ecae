//! Scenes with vectors, arrays, sums and families are worth what the same scenes are that are written number by number.

use proc_macro2::TokenStream;

use super::workbench::resolved;
use crate::expr::evaluate::evaluate;
use crate::expr::{ExprId, Graph, Symbol};
use crate::model::{Model, ParameterSource};
use crate::pipeline::expand;

/// The values of `L`, the constraints, the dissipation, the forces by coordinate, the frequencies and the observed quantities.
fn values(source: &str) -> Vec<Vec<f64>> {
    let mut graph = Graph::default();
    let model = resolved(source, &mut graph);
    let n = model.coordinates.len();
    let by_coordinate = |pairs: &[(usize, crate::model::Named)]| -> Vec<ExprId> {
        (0..n).flat_map(|i| pairs.iter().filter(move |(k, _)| *k == i).map(|(_, named)| named.root)).collect()
    };
    let roots = [
        vec![model.lagrangian],
        model.constraints.iter().map(|constraint| constraint.root).collect(),
        model.forces.dissipation.iter().map(|(_, root)| *root).collect(),
        by_coordinate(&model.forces.generalized),
        by_coordinate(&model.frequencies),
        model.observables.iter().map(|observed| observed.root).collect(),
    ];
    roots.iter().map(|roots| evaluate(&graph, roots, |symbol| value(&model, symbol))).collect()
}

/// Parameters are told apart by their order among those of the model, which is that of the fields and their elements.
fn value(model: &Model, symbol: Symbol) -> f64 {
    let spread = |index: usize, seed: f64| seed + (1.37 * index as f64 + seed).sin();
    match symbol {
        Symbol::Parameter(_) => {
            let place =
                model.parameters.iter().position(|parameter| Symbol::Parameter(parameter.symbol) == symbol);
            spread(place.expect("a parameter of the model"), 2.0)
        }
        Symbol::Coordinate(i) => spread(i, 0.3),
        Symbol::Velocity(i) => spread(i, -0.4),
        Symbol::Time => 0.7,
        Symbol::Input(i) => spread(i, 0.1),
        Symbol::NamedConstant(_) => std::f64::consts::PI,
        Symbol::Composite(_) => panic!("a loop has no value"),
        Symbol::Distance => panic!("no expression is written in distances"),
    }
}

#[track_caller]
fn check(with_vectors: &str, with_numbers: &str) {
    let (vectors, numbers) = (values(with_vectors), values(with_numbers));
    assert_eq!(vectors.len(), numbers.len());
    assert!(numbers[0][0].abs() > 1e-3, "a vanishing Lagrangian compares nothing");
    for (a, b) in vectors.iter().zip(&numbers) {
        assert_eq!(a.len(), b.len(), "{vectors:?} {numbers:?}");
        for (a, b) in a.iter().zip(b) {
            // Sums in another order: a few roundings of terms below 100.
            assert!((a - b).abs() < 1e-12, "{vectors:?} {numbers:?}");
        }
    }
    // What is emitted is Rust without errors.
    let tokens: TokenStream = expand(with_vectors.parse().expect("tokens"));
    assert!(!tokens.to_string().contains("compile_error"), "{tokens}");
    assert!(syn::parse2::<syn::File>(tokens).is_ok(), "{with_vectors}");
}

#[test]
fn a_vector_is_its_elements() {
    check(
        "#[evi(coordinates(r: [3]), lagrangian = 0.5 * m * der(r).norm_squared() - m * g.dot(r) - k * r.norm(),
              constraint(pin: r[0] == r[2] * t))]
         struct S { m: f64, g: Vector3<f64>, k: f64 }",
        "#[evi(coordinates(x, y, z),
              lagrangian = 0.5 * m * (der(x).powi(2) + der(y).powi(2) + der(z).powi(2))
                  - m * (g0 * x + g1 * y + g2 * z) - k * (x.powi(2) + y.powi(2) + z.powi(2)).sqrt(),
              constraint(pin: x == z * t))]
         struct S { m: f64, g0: f64, g1: f64, g2: f64, k: f64 }",
    );
}

#[test]
fn vectors_are_added_scaled_and_multiplied() {
    check(
        "#[evi(coordinates(r: [3], s: [3]),
              let w = r.cross(der(s)) / m - [1.0, m, t] * 2.0,
              lagrangian = 0.5 * der(r).dot(der(r)) + der(s).norm_squared() + (-w).dot(der(r)) + w[1] * [3.0, 4.0][1])]
         struct S { m: f64 }",
        "#[evi(coordinates(x, y, z, u, v, w),
              let a = (y * der(w) - z * der(v)) / m - 2.0,
              let b = (z * der(u) - x * der(w)) / m - 2.0 * m,
              let c = (x * der(v) - y * der(u)) / m - 2.0 * t,
              lagrangian = 0.5 * (der(x).powi(2) + der(y).powi(2) + der(z).powi(2))
                  + der(u).powi(2) + der(v).powi(2) + der(w).powi(2)
                  - a * der(x) - b * der(y) - c * der(z) + 4.0 * b)]
         struct S { m: f64 }",
    );
}

#[test]
fn sums_and_families_go_over_their_ranges() {
    check(
        "#[evi(coordinates(p: [3, 2]),
              kinetic = sum(0..3, |i| 0.5 * m[i] * der(p[i]).norm_squared()),
              potential = sum(0..3, |i| m[i] * p[i][1] * (i + 1)) + sum(1..=2, |k| sum(0..k, |j| p[k][0] * p[j][1])),
              constraint(first: p[0].norm_squared() == l[0].powi(2)),
              constraint(link[i in 1..3]: (p[i] - p[i - 1]).norm_squared() == l[i].powi(2)),
              constraint(net[i in 0..2, c in 0..2]: p[2 * i][c] == c * a[1 - i][c]))]
         struct S { m: [f64; 3], l: [f64; 3], a: [[f64; 2]; 2] }",
        "#[evi(coordinates(x0, y0, x1, y1, x2, y2),
              kinetic = 0.5 * m0 * (der(x0).powi(2) + der(y0).powi(2)) + 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2))
                  + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2)),
              potential = m0 * y0 + 2.0 * m1 * y1 + 3.0 * m2 * y2 + x1 * y0 + x2 * y0 + x2 * y1,
              constraint(first: x0.powi(2) + y0.powi(2) == l0.powi(2)),
              constraint(link1: (x1 - x0).powi(2) + (y1 - y0).powi(2) == l1.powi(2)),
              constraint(link2: (x2 - x1).powi(2) + (y2 - y1).powi(2) == l2.powi(2)),
              constraint(net00: x0 == 0.0 * a10), constraint(net01: y0 == a11),
              constraint(net10: x2 == 0.0 * a00), constraint(net11: y2 == a01))]
         struct S { m0: f64, m1: f64, m2: f64, l0: f64, l1: f64, l2: f64, a00: f64, a01: f64, a10: f64, a11: f64 }",
    );
}

#[test]
fn an_equation_of_vectors_stands_for_its_elements() {
    check(
        "#[evi(coordinates(p: [2, 2]), lagrangian = sum(0..2, |i| der(p[i]).norm_squared()),
              constraint(weld: p[1] - p[0] == [a, b * t]))]
         struct S { a: f64, b: f64 }",
        "#[evi(coordinates(x, y, u, v),
              lagrangian = der(x).powi(2) + der(y).powi(2) + der(u).powi(2) + der(v).powi(2),
              constraint(first: u - x == a), constraint(second: v - y == b * t))]
         struct S { a: f64, b: f64 }",
    );
}

#[test]
fn forces_frequencies_and_observed_quantities_belong_to_elements() {
    check(
        "#[evi(coordinates(p: [2, 2], x), lagrangian = sum(0..2, |i| der(p[i]).norm_squared()) + der(x).powi(2),
              dissipation = c * sum(0..2, |i| (i + 1) * der(p[i]).norm_squared()),
              input(u),
              force(p[i in 0..2][1]: u * i - p[i][0]),
              force(x: u),
              frequency(p[0], x: (c / 2.0).sqrt()),
              observe(speed[i in 0..2]: der(p[i]).norm()),
              observe(middle: 0.5 * (p[0] + p[1])))]
         struct S { c: f64 }",
        "#[evi(coordinates(a, b, d, e, x),
              lagrangian = der(a).powi(2) + der(b).powi(2) + der(d).powi(2) + der(e).powi(2) + der(x).powi(2),
              dissipation = c * (der(a).powi(2) + der(b).powi(2)) + 2.0 * c * (der(d).powi(2) + der(e).powi(2)),
              input(u),
              force(b: -a), force(e: u - d), force(x: u),
              frequency(a, b, x: (c / 2.0).sqrt()),
              observe(s0: (der(a).powi(2) + der(b).powi(2)).sqrt()), observe(s1: (der(d).powi(2) + der(e).powi(2)).sqrt()),
              observe(m0: 0.5 * (a + d)), observe(m1: 0.5 * (b + e)))]
         struct S { c: f64 }",
    );
}

#[test]
fn a_force_of_vectors_acts_on_its_elements() {
    check(
        "#[evi(coordinates(r: [3]), lagrangian = der(r).norm_squared(), force(r: q * der(r).cross(b)))]
         struct S { q: f64, b: SVector<f64, 3> }",
        "#[evi(coordinates(x, y, z), lagrangian = der(x).powi(2) + der(y).powi(2) + der(z).powi(2),
              force(x: q * (der(y) * b2 - der(z) * b1)), force(y: q * (der(z) * b0 - der(x) * b2)),
              force(z: q * (der(x) * b1 - der(y) * b0)))]
         struct S { q: f64, b0: f64, b1: f64, b2: f64 }",
    );
}

#[test]
fn a_rigid_body_is_its_directors() {
    check(
        "#[evi(potential = m * g * b.point([0.0, l, c[2]])[1] + k * der(b.point([1.0, l, 0.0])).norm_squared(),
              rigid_body(b, mass = m + 1.0, center = c, inertia = [1.0, j, 3.0]),
              rigid_body(e, mass = m, center = [0.0, 0.5, 0], inertia = c))]
         struct S { m: f64, g: f64, l: f64, k: f64, j: f64, c: [f64; 3] }",
        "#[evi(coordinates(b: [12], e: [12]),
              kinetic = 0.5 * (m + 1.0) * (
                      (der(b[0]) + c[0] * der(b[3]) + c[1] * der(b[6]) + c[2] * der(b[9])).powi(2)
                    + (der(b[1]) + c[0] * der(b[4]) + c[1] * der(b[7]) + c[2] * der(b[10])).powi(2)
                    + (der(b[2]) + c[0] * der(b[5]) + c[1] * der(b[8]) + c[2] * der(b[11])).powi(2))
                  + 0.25 * (j + 3.0 - 1.0) * (der(b[3]).powi(2) + der(b[4]).powi(2) + der(b[5]).powi(2))
                  + 0.25 * (3.0 + 1.0 - j) * (der(b[6]).powi(2) + der(b[7]).powi(2) + der(b[8]).powi(2))
                  + 0.25 * (1.0 + j - 3.0) * (der(b[9]).powi(2) + der(b[10]).powi(2) + der(b[11]).powi(2))
                  + 0.5 * m * ((der(e[0]) + 0.5 * der(e[6])).powi(2) + (der(e[1]) + 0.5 * der(e[7])).powi(2)
                    + (der(e[2]) + 0.5 * der(e[8])).powi(2))
                  + 0.25 * (c[1] + c[2] - c[0]) * (der(e[3]).powi(2) + der(e[4]).powi(2) + der(e[5]).powi(2))
                  + 0.25 * (c[2] + c[0] - c[1]) * (der(e[6]).powi(2) + der(e[7]).powi(2) + der(e[8]).powi(2))
                  + 0.25 * (c[0] + c[1] - c[2]) * (der(e[9]).powi(2) + der(e[10]).powi(2) + der(e[11]).powi(2)),
              potential = m * g * (b[1] + l * b[7] + c[2] * b[10]) + k * ((der(b[0]) + der(b[3]) + l * der(b[6])).powi(2)
                  + (der(b[1]) + der(b[4]) + l * der(b[7])).powi(2) + (der(b[2]) + der(b[5]) + l * der(b[8])).powi(2)),
              constraint(u1[k in 1..4]: b[3 * k] * b[3 * k] + b[3 * k + 1].powi(2) + b[3 * k + 2].powi(2) == 1.0),
              constraint(r1: b[3] * b[6] + b[4] * b[7] + b[5] * b[8] == 0.0),
              constraint(r2: b[3] * b[9] + b[4] * b[10] + b[5] * b[11] == 0.0),
              constraint(r3: b[6] * b[9] + b[7] * b[10] + b[8] * b[11] == 0.0),
              constraint(u2[k in 1..4]: e[3 * k] * e[3 * k] + e[3 * k + 1].powi(2) + e[3 * k + 2].powi(2) == 1.0),
              constraint(s1: e[3] * e[6] + e[4] * e[7] + e[5] * e[8] == 0.0),
              constraint(s2: e[3] * e[9] + e[4] * e[10] + e[5] * e[11] == 0.0),
              constraint(s3: e[6] * e[9] + e[7] * e[10] + e[8] * e[11] == 0.0))]
         struct S { m: f64, g: f64, l: f64, k: f64, j: f64, c: [f64; 3] }",
    );
}

#[test]
fn names_say_the_element() {
    let mut graph = Graph::default();
    let model = resolved(
        "#[evi(coordinates(r: [2], p: [2, 1], x),
              lagrangian = m[1] * der(r).norm_squared() + der(x).powi(2) + sum(0..2, |i| der(p[i][0]).powi(2)),
              constraint(fix[i in 0..2]: r[i] == 0.0), constraint(both: r == [x, x]), observe(place: r))]
         struct S { m: [f64; 2] }",
        &mut graph,
    );
    assert_eq!(model.coordinates, ["r[0]", "r[1]", "p[0, 0]", "p[1, 0]", "x"]);
    let names: Vec<&str> = model.constraints.iter().map(|constraint| constraint.name.as_str()).collect();
    assert_eq!(names, ["fix[0]", "fix[1]", "both[0]", "both[1]"]);
    let names: Vec<&str> = model.observables.iter().map(|observed| observed.name.as_str()).collect();
    assert_eq!(names, ["place[0]", "place[1]"]);
    let [parameter] = model.parameters.as_slice() else { panic!("one element is used") };
    assert!(matches!(&parameter.source, ParameterSource::Field { field: 0, indices } if indices.len() == 1));
}
