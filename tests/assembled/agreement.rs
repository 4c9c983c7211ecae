//! The steps are those of `Simulation` to round-off.

use evi_core::assembled::{AssembledScheme, AssembledSimulation};
use evi_core::prelude::*;
use evi_examples::{Chain5, Chain20};

use evi_tests::trusses::{Placed, chain};

/// The largest difference of positions, and of velocities as a share of the largest.
#[track_caller]
fn differences<S, F, const N: usize>(specialised: S, assembled: Placed, scheme: F, end: f64) -> [f64; 2]
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S> + AssembledScheme + Clone,
{
    let Placed { truss, q } = assembled;
    let start: [f64; N] = q.clone().try_into().expect("as many coordinates");
    let mut one = Simulation::new(specialised, scheme.clone()).start(start, [0.0; N]).expect("a start");
    let mut other = AssembledSimulation::new(truss, scheme).start(q, vec![0.0; N]).expect("a start");
    one.advance_to(end).expect("every step");
    other.advance_to(end).expect("every step");
    assert_eq!(one.steps(), other.steps());
    assert!((one.energy() - other.energy()).abs() < 1e-13, "{} {}", one.energy(), other.energy());
    let largest = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let (one, other) = (one.state(), other.state());
    let speed = largest(other.v(), &[0.0; N]);
    assert!(speed > 0.1, "it moves");
    [largest(one.q(), other.q()), largest(one.v(), other.v()) / speed]
}

#[test]
fn chains_move_as_those_of_the_gallery() {
    let order_4 = Evi::midpoint(0.01).composed(Composition::suzuki_4());
    let of_five = differences(Chain5::UNIT, chain(5), order_4, 0.2);
    let of_twenty = differences(Chain20::UNIT, chain(20), Evi::midpoint(0.005), 0.1);
    let by_passes = differences(Chain5::UNIT, chain(5), Galerkin::<3>::new(0.02), 0.2);
    println!("{of_five:?} {of_twenty:?} {by_passes:?}");
    // 6.4e-15 measured, of velocities.
    assert!([of_five, of_twenty, by_passes].into_iter().flatten().all(|difference| difference < 1e-14));
}
