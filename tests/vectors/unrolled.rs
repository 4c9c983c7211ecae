//! Small literal sizes: a scene with arrays against the gallery's, which is written number by number.

use evi_core::prelude::*;
use evi_examples::{Chain5, HeavyTop};

use crate::dense::{Kernels, Point, generic_values};

/// The chain of five rods of the gallery.
#[derive(MechanicalSystem, Clone, Debug)]
#[evi(
    coordinates(p: [5, 2]),
    kinetic = 0.5 * m * sum(0..5, |i| der(p[i]).norm_squared()),
    potential = m * g * sum(0..5, |i| p[i][1]),
    constraint(first: p[0].norm_squared() == l.powi(2)),
    constraint(link[i in 1..5]: (p[i] - p[i - 1]).norm_squared() == l.powi(2)),
)]
struct Chain {
    m: f64,
    l: f64,
    g: f64,
}

/// The heavy top of the gallery, its directors in an array.
#[derive(MechanicalSystem, Clone, Debug)]
#[evi(
    coordinates(d: [3, 3]),
    kinetic = 0.5 * sum(0..3, |k| tensor[k] * der(d[k]).norm_squared()),
    potential = m * g * l * d[2][2],
    constraint(unit[k in 0..3]: d[k].norm_squared() == 1.0),
    constraint(right12: d[0].dot(d[1]) == 0.0),
    constraint(right13: d[0].dot(d[2]) == 0.0),
    constraint(right23: d[1].dot(d[2]) == 0.0),
)]
struct Top {
    tensor: [f64; 3],
    m: f64,
    g: f64,
    l: f64,
}

/// The generic copy is not simplified: sums of ten terms of size 10 in another order; no difference measured, one rounding allowed.
const ROUND_OFF: f64 = 2e-15;

#[test]
fn a_chain_of_arrays_is_the_chain_of_numbers() {
    let by_numbers = Chain5::UNIT;
    let by_arrays = Chain { m: by_numbers.m, l: by_numbers.l, g: by_numbers.g };
    let at = Point::irregular(10);
    let (a, b) = (Kernels::of(&by_arrays, &at), Kernels::of(&by_numbers, &at));
    assert!(b.jacobian.amax() > 0.1 && b.lagrangian.abs() > 0.1, "{b:?}");
    // Vectors are taken apart before anything else: the same operations, hence the same bits.
    assert!(a.distance(&b) == 0.0, "{:e}", a.distance(&b));
    assert_eq!(Chain::COORDINATES[..3], ["p[0, 0]", "p[0, 1]", "p[1, 0]"]);
    assert_eq!(Chain::CONSTRAINTS, ["first", "link[1]", "link[2]", "link[3]", "link[4]"]);
    // The same pattern in the same places, and the same solvers behind it.
    assert_eq!(Chain::STRUCTURE.jacobian.q.len(), Chain5::STRUCTURE.jacobian.q.len());
    assert_eq!(Chain::STRUCTURE.constraint_graph, Chain5::STRUCTURE.constraint_graph);
}

#[test]
fn the_generic_copy_is_worth_what_the_kernels_are() {
    let chain = Chain { m: 0.3, l: 0.4, g: 9.81 };
    let at = Point::irregular(10);
    let (generic, kernels) = (generic_values(&chain, &at), Kernels::of(&chain, &at));
    assert!((generic[0] - kernels.lagrangian).abs() <= ROUND_OFF);
    for (a, b) in generic[2..].iter().zip(&kernels.constraints) {
        assert!((a - b).abs() <= ROUND_OFF, "{a} {b}");
    }
}

#[test]
fn directors_in_an_array_are_a_heavy_top() {
    let HeavyTop { m, l, g, across, along } = HeavyTop::STANDARD;
    let by_arrays = Top { tensor: [across, across, along], m, g, l };
    let at = Point::irregular(9);
    let distance = Kernels::of(&by_arrays, &at).distance(&Kernels::of(&HeavyTop::STANDARD, &at));
    assert!(distance == 0.0, "the same operations have the same bits: {distance:e}");
    assert_eq!(Top::PARAMETERS, ["tensor[0]", "tensor[1]", "tensor[2]", "m", "g", "l"]);
}
