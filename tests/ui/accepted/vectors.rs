//! Vectors, arrays, sums and families; the emitted code warns nowhere.

#![deny(warnings, missing_docs, unused, nonstandard_style, future_incompatible, rust_2018_idioms)]
#![deny(trivial_casts, trivial_numeric_casts, unused_qualifications, unreachable_pub, single_use_lifetimes)]

use evi_core::assembled::AssembledSystem;
use evi_core::prelude::*;

/// A number of bodies.
const N: usize = 4;

mod sizes {
    pub(super) const BODIES: usize = 1_000;
}

/// Every form on literal sizes.
#[derive(MechanicalSystem, Clone, Debug)]
#[evi(
    coordinates(r: [3], p: [3, 2,], x),
    let arm = { let offset = [0.0, 1.0, t]; r - offset },
    let swing = arm.cross(der(r)),
    kinetic = 0.5 * mass[0] * der(r).dot(der(r)) + sum(0..3, |i| 0.5 * mass[i] * der(p[i]).norm_squared())
            + (1 + N) * der(x).powi(2) + swing[2].powi(2) / 2.0,
    potential = sum(0..=2, |i| sum(0..i, |j| (p[i] - p[j]).norm() * table[i - j][(j)]))
              + (-arm * 2.0 / mass[2]).norm_squared() + sum(1..1, |i| p[i][0]) + x * [1.0, x][1],
    constraint(link[i in 1..3]: (p[i] - p[i - 1]).norm_squared() == 1.0),
    constraint(pair[i in 0..1, j in 0..2]: p[2 * i + j][0] == x * j),
    constraint(weld: r == gravity * x),
    dissipation = sum(0..3, |k| der(p[k]).norm_squared()),
    input(u),
    force(p[i in 0..3][1]: u * i),
    force(r: der(r).cross(gravity)),
    frequency(p, x: 2.0),
    frequency(r[1]: mass[1]),
    observe(tip: p[2]),
    observe(speed[i in 0..3]: der(p[i]).norm()),
)]
pub struct Everything {
    /// Of each body.
    pub mass: [f64; 3],
    /// Of pairs.
    pub table: [[f64; 3]; 3],
    /// A direction.
    pub gravity: nalgebra::Vector3<f64>,
}

/// Loops over a named size.
#[derive(MechanicalSystem, Clone, Debug)]
#[evi(
    coordinates(x, p: [N, 2]),
    kinetic = 0.5 * sum(0..N, |i| mass[i] * der(p[i]).norm_squared()) + der(x).powi(2),
    potential = sum(0..N, |i| p[i][1] * (N - i) + sum(0..i, |j| (p[i] - p[j]).norm_squared())),
    constraint(link[i in 1..N]: (p[i] - p[i - 1]).norm_squared() == 1.0),
    constraint(weld: p[N - 1] == [x, 0.0]),
    force(p[i in 0..N][1]: x * i),
    dissipation = der(x).powi(2),
)]
pub struct Loops {
    /// Of each body.
    pub mass: [f64; N],
}

/// Loops over a size that is a path, and a literal that is too large to be unrolled.
#[derive(MechanicalSystem, Clone, Debug)]
#[evi(
    coordinates(p: [sizes::BODIES, 2], r: [10_000]),
    kinetic = sum(0..sizes::BODIES, |i| der(p[i]).norm_squared()) + sum(0..10_000, |i| der(r[i]).powi(2)),
    potential = 0.0,
)]
pub struct Many;

/// Two bodies on a ball joint, without coordinates beside theirs.
#[derive(MechanicalSystem, Clone, Debug)]
#[evi(
    rigid_body(upper, mass = mass, center = [0.0, 0.0, -length], inertia = [0.1, 0.1, spin]),
    rigid_body(lower, mass = 2.0 * mass, center = center, inertia = [0.1, 0.2, spin]),
    potential = 9.81 * mass * (upper.point([0.0, 0.0, -length])[2] + 2.0 * lower.point(center)[2]),
    constraint(pivot: upper[0] == [0.0, 0.0, 0.0]),
    constraint(joint: upper.point([0.0, 0.0, -2.0 * length]) == lower[0]),
    observe(speed: der(lower.point(center)).norm()),
)]
pub struct Bodies {
    /// Of the upper one.
    pub mass: f64,
    /// Half of the upper one's.
    pub length: f64,
    /// About the third axes.
    pub spin: f64,
    /// Of the lower one.
    pub center: [f64; 3],
}

fn main() {
    let scene = Everything { mass: [1.0; 3], table: [[0.5; 3]; 3], gravity: nalgebra::Vector3::new(0.0, 0.0, 9.81) };
    assert_eq!(Everything::CONSTRAINTS.len(), 2 + 2 + 3);
    assert_eq!(Everything::OBSERVABLES, ["tip[0]", "tip[1]", "speed[0]", "speed[1]", "speed[2]"]);
    // Three of the nine pairs are used.
    assert_eq!(MechanicalSystem::parameters(&scene).as_ref().len(), 3 + 3 + 3);
    let bodies = Bodies { mass: 1.0, length: 0.5, spin: 0.02, center: [0.0, 0.0, -0.5] };
    let frame = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let (upper, lower) = ([[0.0; 3].as_slice(), &frame].concat(), [[0.0, 0.0, -1.0].as_slice(), &frame].concat());
    let q: [f64; 24] = [upper, lower].concat().try_into().unwrap();
    let mut run = Simulation::new(bodies, Evi::midpoint(0.01)).start(q, [0.0; 24]).unwrap();
    assert!(run.integrate(0.1).unwrap().last().q().iter().all(|x| x.is_finite()));
    assert_eq!((Bodies::N_COORDINATES, Bodies::N_CONSTRAINTS), (24, 18));
    assert_eq!(Loops { mass: [1.0; N] }.n_coordinates(), 1 + 2 * N);
    assert_eq!((Many.n_coordinates(), Many.coordinate_name(2_003)), (12_000, "r[3]".to_owned()));
}
