//! The same scenes with a literal size, which is unrolled, and with a named one, whose sums and families stay loops.

use evi_core::assembled::{AssembledSimulation, AssembledSystem};
use evi_core::prelude::*;
use evi_examples::{Chain5, Scene, Start};
use evi_tests::largest_difference;
use nalgebra::Vector3;

use crate::dense::{Kernels, Point, generic_values};

const BODIES: usize = 5;

/// A chain in space of unequal masses that repel each other, a slider that they pull at, friction and forces that know their index.
macro_rules! chain {
    ($name:ident, $n:tt) => {
        #[derive(MechanicalSystem, Clone, Debug)]
        #[evi(
            coordinates(x, p: [$n, 3]),
            let gravity = sum(0..$n, |i| m[i] * g.dot(p[i])),
            kinetic = sum(0..$n, |i| 0.5 * m[i] * der(p[i]).norm_squared()) + 0.5 * m[0] * der(x).powi(2) * (1 + p[0][1].powi(2)),
            potential = -gravity + k * sum(0..$n, |i| sum(0..i, |j| 1.0 / (p[i] - p[j]).norm()))
                + t * x * sum(1..$n, |i| i * p[i][2]),
            dissipation = c * sum(0..$n, |k| (k + 1) * der(p[k]).norm_squared() / 2.0),
            constraint(first: (p[0] - [x, 0.0, 0.0]).norm_squared() == l[0].powi(2)),
            constraint(link[i in 1..$n]: (p[i] - p[i - 1]).norm_squared() == l[i].powi(2)),
            constraint(end: p[$n - 1] == [t, x, c]),
            constraint(grid[i in 0..2, j in 0..2]: p[i][j] * p[i + 1][j] == a[i][j]),
            force(p[i in 1..$n][2]: c * der(p[i][0]) * p[i - 1][1] * i),
            force(x: -x),
        )]
        struct $name {
            m: [f64; $n],
            l: [f64; $n],
            g: Vector3<f64>,
            a: [[f64; 2]; 2],
            k: f64,
            c: f64,
        }

        impl $name {
            fn unequal() -> Self {
                let spread = |seed: f64| std::array::from_fn(|i| seed + 0.1 * i as f64);
                let (g, a) = (Vector3::new(0.1, -0.3, 9.0), [[0.5, 0.25], [0.125, 2.0]]);
                Self { m: spread(1.0), l: spread(0.3), g, a, k: 0.7, c: 0.2 }
            }
        }
    };
}

chain!(Unrolled, 5);
chain!(Looped, BODIES);

/// Sums of some ten terms of size 10 in another order: 7e-15 measured.
const ROUND_OFF: f64 = 1e-14;

#[test]
fn elements_add_up_to_the_unrolled_scene() {
    let (unrolled, looped) = (Unrolled::unequal(), Looped::unequal());
    let n = 1 + 3 * BODIES;
    let at = Point::irregular(n);
    assert_eq!((Unrolled::N_COORDINATES, looped.n_coordinates()), (n, n));
    let (expected, found) = (Kernels::of(&unrolled, &at), Kernels::of_elements(&looped, &at));
    assert_eq!(expected.constraints.len(), 1 + (BODIES - 1) + 3 + 4);
    let all = expected
        .vectors
        .iter()
        .map(|vector| vector.amax())
        .chain(expected.matrices.iter().map(|matrix| matrix.amax()));
    assert!(
        all.into_iter().all(|largest| largest > 0.1),
        "a vanishing kernel compares nothing: {expected:?}"
    );
    let distance = found.distance(&expected);
    assert!(distance <= ROUND_OFF, "{distance:e}");
}

#[test]
fn names_are_those_of_the_unrolled_scene() {
    let looped = Looped::unequal();
    let coordinates: Vec<String> =
        (0..looped.n_coordinates()).map(|index| looped.coordinate_name(index)).collect();
    assert_eq!(coordinates, Unrolled::COORDINATES);
    let constraints: Vec<String> =
        (0..Unrolled::N_CONSTRAINTS).map(|index| looped.constraint_name(index)).collect();
    assert_eq!(constraints, Unrolled::CONSTRAINTS);
}

#[test]
fn the_generic_copies_agree() {
    let at = Point::irregular(1 + 3 * BODIES);
    let (expected, found) =
        (generic_values(&Unrolled::unequal(), &at), generic_values(&Looped::unequal(), &at));
    assert_eq!(expected.len(), found.len());
    for (a, b) in expected.iter().zip(&found) {
        assert!((a - b).abs() <= ROUND_OFF, "{expected:?} {found:?}");
    }
    let kernels = Kernels::of(&Unrolled::unequal(), &at);
    assert!((expected[0] - kernels.lagrangian).abs() <= ROUND_OFF, "{} {}", expected[0], kernels.lagrangian);
}

/// The chain of five rods of the gallery, as loops.
#[derive(MechanicalSystem, Clone, Debug)]
#[evi(
    coordinates(p: [BODIES, 2]),
    kinetic = 0.5 * m * sum(0..BODIES, |i| der(p[i]).norm_squared()),
    potential = m * g * sum(0..BODIES, |i| p[i][1]),
    constraint(first: p[0].norm_squared() == l.powi(2)),
    constraint(link[i in 1..BODIES]: (p[i] - p[i - 1]).norm_squared() == l.powi(2)),
)]
struct Chain {
    m: f64,
    l: f64,
    g: f64,
}

#[test]
fn a_chain_of_loops_ends_at_certified_digits() {
    let Chain5 { m, l, g } = Chain5::UNIT;
    let Start { q, v } = Chain5::UNIT.horizontal();
    let scheme = Evi::midpoint(1.0 / 1600.0).composed(Composition::kahan_li_8());
    let mut run =
        AssembledSimulation::new(Chain { m, l, g }, scheme).start(q.to_vec(), v.to_vec()).expect("a start");
    run.advance_to(Chain5::HORIZON).expect("every step");
    let end = Chain5::reference();
    let beside = largest_difference(run.state().q(), &end.q);
    assert!(largest_difference(&q, &end.q) > 0.5, "it moves");
    // Round-off of 27,200 stages: 3.2e-14 measured.
    assert!(beside < 5e-14, "{beside:e}");
}
