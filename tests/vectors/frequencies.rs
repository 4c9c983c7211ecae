//! Curves of frequencies that a family gives its coordinates, beside the same scene with a literal size.

use evi_core::assembled::{AssembledSimulation, AssemblyError};
use evi_core::prelude::*;
use evi_tests::largest_difference;

const BODIES: usize = 4;

/// Bodies on springs of unequal stiffness, the first two joined by a rod, in a magnetic field, with friction and a force that depends on place; a slider on
/// a straight line.
macro_rules! springs {
    ($name:ident, $n:tt) => {
        #[derive(MechanicalSystem, Clone, Debug)]
        #[evi(
            coordinates(x, p: [$n, 2]),
            kinetic = sum(0..$n, |i| 0.5 * m[i] * der(p[i]).norm_squared() + b * p[i][0] * der(p[i][1])) + 0.5 * der(x).powi(2),
            potential = sum(0..$n, |i| 0.5 * k[i] * p[i].norm_squared()) + c * x * sum(1..$n, |i| p[i].dot(p[i - 1])),
            dissipation = 0.01 * sum(0..$n, |i| (i + 1) * der(p[i]).norm_squared()),
            constraint(rod: (p[1] - p[0]).norm_squared() == l.powi(2)),
            force(p[i in 1..$n][0]: -c * p[i - 1][1].powi(3)),
            frequency(p[i in 0..$n]: (k[i] / m[i]).sqrt()),
        )]
        struct $name {
            m: [f64; $n],
            k: [f64; $n],
            b: f64,
            c: f64,
            l: f64,
        }

        impl $name {
            fn unequal() -> Self {
                let spread = |first: f64, step: f64| std::array::from_fn(|i| first + step * i as f64);
                Self { m: spread(1.0, 0.3), k: spread(9.0, 2.5), b: 0.2, c: 0.15, l: 0.5 }
            }
        }
    };
}

springs!(Unrolled, 4);
springs!(Looped, BODIES);

const START: [f64; 1 + 2 * BODIES] = [0.1, 0.3, 0.0, 0.3, 0.5, -0.2, 0.4, 0.25, -0.1];
const H: f64 = 0.1;
const HORIZON: f64 = 20.0;

fn looped<F: evi_core::assembled::AssembledScheme>(scheme: F) -> Vec<f64> {
    let simulation = AssembledSimulation::new(Looped::unequal(), scheme);
    let mut run = simulation.start(START, [0.0; START.len()]).expect("a start");
    run.advance_to(HORIZON).expect("every step");
    assert!(run.constraint_error() < 1e-15 && run.hidden_constraint_error() < 1e-14);
    run.state().q().to_vec()
}

/// Round-off of 200 steps of a motion of size 1: 1.4e-14 measured.
const ROUND_OFF: f64 = 3e-14;

#[test]
fn a_family_takes_the_curves_of_its_frequencies() {
    let simulation = Simulation::new(Unrolled::unequal(), Evi::simpson(H).scene_frequencies());
    let mut run = simulation.start(START, [0.0; START.len()]).expect("a start");
    run.advance_to(HORIZON).expect("every step");
    let (expected, curved, straight) =
        (run.state().q(), looped(Evi::simpson(H).scene_frequencies()), looped(Evi::simpson(H)));
    let (beside, apart) = (largest_difference(&curved, expected), largest_difference(&curved, &straight));
    println!("{beside:e} beside the unrolled scene, {apart:e} beside straight lines");
    assert!(apart > 1e-3, "{apart:e}");
    assert!(beside < ROUND_OFF, "{beside:e}");
}

#[test]
fn all_coordinates_take_one_frequency() {
    let simulation = Simulation::new(Unrolled::unequal(), Evi::simpson(H).frequency(3.0));
    let mut run = simulation.start(START, [0.0; START.len()]).expect("a start");
    run.advance_to(HORIZON).expect("every step");
    let looped = looped(Evi::simpson(H).frequency(3.0));
    // Each beside its own size: nothing holds the slider, which a frequency with three nodes takes hundreds of units away.
    let apart = |(looped, unrolled): (&f64, &f64)| (looped - unrolled).abs() / unrolled.abs().max(1.0);
    let beside = looped.iter().zip(run.state().q()).map(apart).fold(0.0, f64::max);
    println!("{beside:e}");
    assert!(beside < ROUND_OFF, "{beside:e}");
}

/// Springs on all bodies but the first.
#[derive(MechanicalSystem, Clone, Debug)]
#[evi(
    coordinates(p: [BODIES]),
    kinetic = 0.5 * sum(0..BODIES, |i| der(p[i]).powi(2)),
    potential = 0.5 * k * sum(1..BODIES, |i| p[i].powi(2)),
    frequency(p[i in 0..BODIES]: k.sqrt()),
)]
struct OneIsFree {
    k: f64,
}

#[test]
fn a_frequency_of_what_nothing_holds_is_refused() {
    let start = |scheme| {
        let simulation = AssembledSimulation::new(OneIsFree { k: 4.0 }, scheme);
        simulation.start([0.1; BODIES], [0.0; BODIES]).map(|run| run.state().q().to_vec())
    };
    let error = start(Evi::simpson(H).scene_frequencies()).expect_err("refused");
    println!("{error}");
    assert!(
        matches!(error, AssemblyError::SoftCoordinate { coordinate: 0, frequency: 2.0, growth_rate } if growth_rate > 0.0),
        "{error:?}"
    );
    start(Evi::simpson(H).scene_frequencies().allow_soft_modes()).expect("allowed");
}
