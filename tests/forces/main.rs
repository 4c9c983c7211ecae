//! The discrete Lagrange-d'Alembert principle: order, impulses, damping, work; inputs, frequencies of the scene, observed
//! quantities; time in the Lagrangian and in the constraints.
//!
//! With forces the energy changes, and the exact facts are others: momenta change by the discrete impulse to round-off,
//! the energy by the work to the order of the method.

mod baselines;
mod damping;
mod elimination;
mod frequencies;
mod impulse;
mod inputs;
mod observed;
mod order;
mod scenes_without_forces;
mod work;

use evi_core::prelude::*;
use evi_examples::Start;
use evi_tests::references::Certified;
use evi_tests::{distance, observed_order};

/// Observed orders are this near: the next term of the error, over steps from `h` to `h/8`. 0.027 measured.
const SLOPE_TOLERANCE: f64 = 0.04;

#[track_caller]
fn check_slope(what: &str, h: &[f64], errors: &[f64], order: f64) {
    let observed = observed_order(h, errors);
    println!("{}: {what} {observed:.4}", core::panic::Location::caller());
    let smallest = errors.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(smallest > 1e-11, "{what}: round-off in {errors:?}");
    assert!((observed - order).abs() <= SLOPE_TOLERANCE, "order of {what} is {observed:.3}: {errors:?}");
}

/// Step sizes of `t` over `coarsest`, twice, four and eight times as many steps.
fn steps(t: f64, coarsest: u32) -> impl Iterator<Item = (u32, f64)> {
    (0..4).map(move |k| coarsest << k).map(move |n| (n, t / f64::from(n)))
}

/// Where a motion ends: positions, velocities, multipliers, energy.
struct End {
    t: f64,
    q: Vec<f64>,
    v: Vec<f64>,
    multipliers: Vec<f64>,
    energy: f64,
}

impl End {
    fn certified(Certified { t, q, v, multipliers }: Certified, energy: f64) -> Self {
        Self { t, q: q.to_vec(), v: v.to_vec(), multipliers: multipliers.to_vec(), energy }
    }
}

/// Order of a scheme in positions, velocities, multipliers and energy.
#[track_caller]
fn check_order<S, F, const N: usize>(
    system: S,
    start: Start<N>,
    end: &End,
    coarsest: u32,
    order: f64,
    scheme: impl Fn(f64) -> F,
) where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Copy,
    F: Scheme<S>,
{
    let (mut h, mut q, mut v, mut multipliers, mut energy) = (vec![], vec![], vec![], vec![], vec![]);
    for (n, size) in steps(end.t, coarsest) {
        let mut run =
            Simulation::new(system, scheme(size)).start(start.q, start.v).expect("a consistent start");
        for _ in 0..n {
            run.advance().expect("a step");
        }
        let state = run.state();
        h.push(size);
        q.push(distance(state.q(), &end.q));
        v.push(distance(state.v(), &end.v));
        energy.push((run.energy() - end.energy).abs());
        let inputs = state.inputs();
        let found =
            run.mechanics().acceleration_with(state.t(), state.q(), state.v(), inputs).expect("regular");
        multipliers.push(distance(found.multipliers.as_ref(), &end.multipliers));
        let residual = run.mechanics().constraint_residual(state);
        assert!(order > 2.0 || residual.as_ref().iter().all(|residual| residual.abs() < 1e-14));
    }
    check_slope("q", &h, &q, order);
    check_slope("v", &h, &v, order);
    check_slope("H", &h, &energy, order);
    if S::N_CONSTRAINTS > 0 {
        check_slope("multipliers", &h, &multipliers, order);
    }
}
