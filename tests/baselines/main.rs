//! The methods to compare with: their orders, what they keep, what they share with each other, and what they refuse.

mod coincidences;
mod efficiency;
mod generic;
mod kept;
mod order;
mod refusals;

use evi_core::array::Array;
use evi_core::baseline::{Dense, GeneralizedAlpha, ImplicitMidpoint, Rattle, Shake};
use evi_core::generic::{GenericEvi, GenericScheme};
use evi_core::integrator::Statistics;
use evi_core::mechanics::Mechanics;
use evi_core::prelude::*;
use evi_examples::{DoublePendulum, HarmonicOscillator, Pendulum, Start};
use evi_tests::conservation::there_and_back;
use evi_tests::convergence::{check_orders, measure};
use evi_tests::motions::{
    Motion, charged_spherical_pendulum, damped_pendulum, double_pendulum, double_pendulum_in_angles,
    gentle_double_pendulum, kapitza_pendulum, long_double_pendulum_in_angles, modulated_pendulum, pendulum,
    relativistic_bead,
};
use evi_tests::scenes::{DoublePendulumInAngles, MotorisedDoublePendulum, PushedDumbbell};
use evi_tests::{distance, extrapolate_by_hand, largest_difference, observed_order};

/// The double pendulum of unequal masses and lengths, on a swing of moderate size.
fn swing() -> (DoublePendulum, Start<4>) {
    let angles = DoublePendulumInAngles::UNEQUAL;
    let Start { q, v } = DoublePendulumInAngles::MODERATE;
    (angles.constrained(), angles.cartesian(q, v))
}

/// Both runs stay together over 100 steps, to so many roundings of positions and velocities.
#[track_caller]
fn check_same<S, E, F>(system: S, schemes: (E, F), start: Start<4>, positions: f64, velocities: f64)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; 4]> + Clone,
    E: Scheme<S>,
    F: Scheme<S>,
{
    let mut first = Simulation::new(system.clone(), schemes.0).start(start.q, start.v).expect("consistent");
    let mut second = Simulation::new(system, schemes.1).start(start.q, start.v).expect("consistent");
    let (mut q, mut v) = (0.0_f64, 0.0_f64);
    for _ in 0..100 {
        let (a, b) = (first.advance().expect("a step"), second.advance().expect("a step"));
        q = q.max(largest_difference(a.q(), b.q()) / f64::EPSILON);
        v = v.max(largest_difference(a.v(), b.v()) / f64::EPSILON);
    }
    println!("{}: {q:.0} ε in positions, {v:.0} ε in velocities", core::panic::Location::caller());
    assert!(largest_difference(first.state().q(), &start.q) > 0.1, "vacuous: nothing moves");
    assert!(q <= positions && v <= velocities, "{q:.0} ε, {v:.0} ε");
}
