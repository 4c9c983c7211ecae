//! What a run keeps: time reversal, functions of its states, constraints.

use evi_core::prelude::*;
use evi_examples::Start;

use crate::largest_difference;

/// Distance from the start in `q` and `v` after `steps` steps of size `h` there and as many back.
///
/// # Panics
/// If a step is not taken, or nothing moves.
#[track_caller]
pub fn there_and_back<S, F, const N: usize>(
    system: S,
    scheme: impl Fn(f64) -> F,
    start: Start<N>,
    h: f64,
    steps: usize,
) -> f64
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Clone,
    F: Scheme<S>,
{
    let mut there = Simulation::new(system.clone(), scheme(h)).start(start.q, start.v).expect("a start");
    for _ in 0..steps {
        there.advance().expect("a step");
    }
    let turn = there.state();
    assert!(largest_difference(turn.q(), &start.q) > 0.1, "vacuous: nothing moves");
    let mut back = Simulation::new(system, scheme(-h))
        .start_at(turn.t(), *turn.q(), *turn.v())
        .expect("the end of a run is a start");
    for _ in 0..steps {
        back.advance().expect("a step back");
    }
    let end = back.state();
    assert!(end.t().abs() < 1e-12, "back at t = {}", end.t());
    let distance = largest_difference(end.q(), &start.q).max(largest_difference(end.v(), &start.v));
    println!("{}: {distance:e}", core::panic::Location::caller());
    distance
}

/// `x p_y − y p_x` of the body whose coordinates begin at `first`.
pub fn angular_momentum(q: &[f64], p: &[f64], first: usize) -> f64 {
    q[first] * p[first + 1] - q[first + 1] * p[first]
}

/// Largest change of a function of `(q, p)` along a run.
///
/// # Panics
/// If a step is not taken, or the quantity vanishes at the start.
#[track_caller]
pub fn largest_change<S, F, const N: usize>(
    system: S,
    scheme: F,
    start: Start<N>,
    steps: usize,
    quantity: impl Fn(&[f64], &[f64]) -> f64,
) -> f64
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S>,
{
    let mut run = Simulation::new(system, scheme).start(start.q, start.v).expect("a start");
    let at_start = quantity(run.state().q(), run.state().p());
    assert!(at_start.abs() > 0.1, "vacuous: the quantity is {at_start}");
    let mut largest = 0.0_f64;
    for _ in 0..steps {
        let state = run.advance().expect("a step");
        largest = largest.max((quantity(state.q(), state.p()) - at_start).abs());
    }
    println!("{}: {largest:e}", core::panic::Location::caller());
    largest
}

/// Largest `|φ|` and largest `|G v| / (‖G‖ ‖v‖)` along a run.
///
/// # Panics
/// If a step is not taken, or no residual ever differs from zero: then nothing moves.
#[track_caller]
pub fn largest_residuals<S, F, const N: usize>(
    system: S,
    scheme: F,
    start: Start<N>,
    steps: usize,
) -> [f64; 2]
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S>,
{
    let mut run = Simulation::new(system, scheme).start(start.q, start.v).expect("a start");
    let mut largest = [0.0_f64; 2];
    for _ in 0..steps {
        run.advance().expect("a step");
        let (mechanics, state) = (run.mechanics(), run.state());
        let residuals = [mechanics.constraint_residual(state), mechanics.hidden_constraint_residual(state)];
        for (largest, residuals) in largest.iter_mut().zip(&residuals) {
            for residual in residuals.as_ref() {
                // Written so that a NaN stays.
                *largest = if residual.abs() <= *largest { *largest } else { residual.abs() };
            }
        }
    }
    println!("{}: {largest:?}", core::panic::Location::caller());
    assert!(largest.iter().all(|residual| *residual > 0.0), "vacuous: {largest:?}");
    largest
}
