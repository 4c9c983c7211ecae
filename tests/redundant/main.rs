//! Constraints that follow from others: refused by name, or integrated where that is stated, like the scene without them.

mod contradictions;
mod motion;
mod multipliers;
mod nearly_dependent;
mod rank;

use evi_core::baseline::{ImplicitMidpoint, Rattle, Rk4};
use evi_core::integrator::{ConstraintLabel, OfRank};
use evi_core::mechanics::Mechanics;
use evi_core::prelude::*;
use evi_examples::DoublePendulum;
use evi_tests::largest_difference;
use nalgebra::DMatrix;

const G: f64 = 9.81;

/// The double pendulum, each rod twice: the outer one in another unit, the inner one of a length of its own, which may grow.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(x1, y1, x2, y2),
    kinetic   = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2))
              + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2)),
    potential = g * (m1 * y1 + m2 * y2),
    constraint(rod1: x1.powi(2) + y1.powi(2) == l1.powi(2)),
    constraint(rod2: (x2 - x1).powi(2) + (y2 - y1).powi(2) == l2.powi(2)),
    constraint(again1: x1.powi(2) + y1.powi(2) == (again + growth * t.powi(2)).powi(2)),
    constraint(again2: unit * ((x2 - x1).powi(2) + (y2 - y1).powi(2)) == unit * l2.powi(2)),
)]
struct HeldTwice {
    m1: f64,
    m2: f64,
    l1: f64,
    l2: f64,
    g: f64,
    again: f64,
    growth: f64,
    unit: f64,
}

const ONCE: DoublePendulum = DoublePendulum { m1: 1.0, m2: 0.5, l1: 1.0, l2: 0.8, g: G };
const TWICE: HeldTwice =
    HeldTwice { m1: 1.0, m2: 0.5, l1: 1.0, l2: 0.8, g: G, again: 1.0, growth: 0.0, unit: 1.0 };
/// Rods at 3-4-5 triangles.
const BENT: [f64; 4] = [0.6, -0.8, 1.08, -1.44];

/// A platform on three parallel cranks; its ends are the coordinates, the third crank holds it in the fraction `at` of its length.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(x1, y1, x2, y2),
    kinetic   = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2))
              + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2)),
    potential = g * (m1 * y1 + m2 * y2),
    constraint(left: x1.powi(2) + y1.powi(2) == l.powi(2)),
    constraint(right: (x2 - d).powi(2) + y2.powi(2) == l.powi(2)),
    constraint(platform: (x2 - x1).powi(2) + (y2 - y1).powi(2) == d.powi(2)),
    constraint(middle: (x1 + at * (x2 - x1) - at * d).powi(2) + (y1 + at * (y2 - y1)).powi(2) == third.powi(2)),
)]
struct Parallelogram {
    m1: f64,
    m2: f64,
    l: f64,
    d: f64,
    g: f64,
    at: f64,
    third: f64,
}

const OVERCONSTRAINED: Parallelogram =
    Parallelogram { m1: 1.0, m2: 0.4, l: 0.8, d: 1.5, g: G, at: 0.3, third: 0.8 };
const CRANKED: [f64; 4] = [0.48, -0.64, 1.98, -0.64];

/// The platform on two cranks.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(x1, y1, x2, y2),
    kinetic   = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2))
              + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2)),
    potential = g * (m1 * y1 + m2 * y2),
    constraint(left: x1.powi(2) + y1.powi(2) == l.powi(2)),
    constraint(right: (x2 - d).powi(2) + y2.powi(2) == l.powi(2)),
    constraint(platform: (x2 - x1).powi(2) + (y2 - y1).powi(2) == d.powi(2)),
)]
struct TwoCranks {
    m1: f64,
    m2: f64,
    l: f64,
    d: f64,
    g: f64,
}

const TWO_CRANKS: TwoCranks = TwoCranks { m1: 1.0, m2: 0.4, l: 0.8, d: 1.5, g: G };

/// A bead that two nearly parallel planes hold on their common line, `angle` apart.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(x, y, z),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2) + der(z).powi(2)),
    potential = m * g * (y + x + 0.5 * z.powi(2)),
    constraint(plane: x == 0.0),
    constraint(tilted: angle.cos() * x + angle.sin() * y == 0.0),
)]
struct Wedge {
    m: f64,
    g: f64,
    angle: f64,
}

fn start<S, F>(simulation: &Simulation<S, F>, q: [f64; 4]) -> Result<Run<S, F::Step>, StartError>
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; 4]>,
    F: Scheme<S>,
{
    simulation.start(q, [0.0; 4])
}

/// The largest difference of positions over steps of two runs from rest.
#[track_caller]
fn difference<A, B, F>(one: Simulation<A, F>, other: Simulation<B, F>, q: [f64; 4], steps: usize) -> f64
where
    A: MechanicalSystem<PerCoordinate<f64> = [f64; 4]>,
    B: MechanicalSystem<PerCoordinate<f64> = [f64; 4]>,
    F: Scheme<A> + Scheme<B>,
{
    let mut one = start(&one, q).expect("consistent");
    let mut other = start(&other, q).expect("consistent");
    let mut largest = 0.0_f64;
    for _ in 0..steps {
        one.advance().expect("solvable");
        other.advance().expect("solvable");
        largest = largest.max(largest_difference(one.state().q(), other.state().q()));
    }
    let moved = largest_difference(one.state().q(), &q);
    assert!(moved > 0.01, "nothing moves: {moved:e}");
    println!("positions differ by {largest:.2e}");
    largest
}

/// What is stated is a type: `OfRank(scene)` is a scene like any other.
#[test]
fn a_scene_of_stated_rank_is_a_scene() {
    let simulation = Simulation::new(OfRank::<_, 2>(TWICE), Evi::midpoint(0.01));
    let mut run = start(&simulation, BENT).unwrap();
    let trajectory = run.integrate(0.1).expect("solvable");
    assert_eq!(trajectory.states().len(), 11);
    assert_eq!(<OfRank<HeldTwice, 2> as MechanicalSystem>::CONSTRAINTS, HeldTwice::CONSTRAINTS);
}
