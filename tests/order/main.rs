//! Orders of convergence on nonlinear systems, towards numbers that evi-core has no part in: certified
//! reference solutions, or extrapolation on accelerations written by hand with steps so small that its error is round-off.
//!
//! The family has order 2 for every rule that integrates `τ` exactly, whatever its number of nodes and the
//! frequency; order 1 otherwise (Marsden & West, Acta Numerica 10 (2001), thm. 2.3.1). A slope is the
//! least-squares slope over five step sizes, of the errors in `q`, `v` and the index-1 multipliers at the end
//! of the run and of the largest `|H − H₀|` on the way.

mod certified;
mod coincidences;
mod constrained_double_pendulum;
mod plane_pendulum;
mod structures;

use evi_core::baseline::{Rattle, Rk4};
use evi_core::prelude::*;
use evi_examples::{DoublePendulum, SphericalPendulum, Start, StiffSpringPendulum};
use evi_tests::convergence::{Errors, measure};
use evi_tests::motions::{
    Motion, charged_particle, charged_spherical_pendulum, damped_pendulum, double_pendulum,
    double_pendulum_in_angles, kapitza_pendulum, modulated_pendulum, pendulum, relativistic_bead,
};
use evi_tests::references::{self, Certified};
use evi_tests::scenes::{
    ChargedParticle, ChargedSphericalPendulum, DampedPendulum, DoublePendulumInAngles, ModulatedPendulum,
};
use evi_tests::{distance, extrapolate_by_hand, integrate_by_hand, largest_difference, observed_order};

/// Slopes over a decade and a half of step sizes carry the next term of the error expansion: a few
/// hundredths.
const SLOPE_TOLERANCE: f64 = 0.05;
/// The largest energy error of a run is sampled at its steps, hence scatters.
const ENERGY_SLOPE_TOLERANCE: f64 = 0.1;
/// Fifty times the round-off of a thousand steps (some 2e-14): errors below this show no order.
const SMALLEST_ERROR: f64 = 1e-12;

#[track_caller]
fn check_slope(quantity: &str, h: &[f64], errors: &[f64], order: f64, tolerance: f64) {
    let smallest = errors.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(smallest > SMALLEST_ERROR, "{quantity}: round-off in {errors:?}");
    let observed = observed_order(h, errors);
    println!("{}: {quantity} {observed:.4}", core::panic::Location::caller());
    assert!(
        (observed - order).abs() <= tolerance,
        "order of {quantity} is {observed:.3}, not {order}: {errors:?}"
    );
}

/// Orders of `q`, `v` and the multipliers.
#[track_caller]
fn check_state<S, F>(motion: &Motion<S>, scheme: impl Fn(f64) -> F, order: f64) -> Errors
where
    S: MechanicalSystem + Clone,
    F: Scheme<S>,
{
    let errors = measure(motion, scheme);
    check_slope("q", &errors.h, &errors.q, order, SLOPE_TOLERANCE);
    check_slope("v", &errors.h, &errors.v, order, SLOPE_TOLERANCE);
    if !errors.multipliers.is_empty() {
        check_slope("multipliers", &errors.h, &errors.multipliers, order, SLOPE_TOLERANCE);
    }
    errors
}

/// Orders of `q`, `v`, the multipliers and the energy.
#[track_caller]
fn check<S, F>(motion: &Motion<S>, scheme: impl Fn(f64) -> F, order: f64)
where
    S: MechanicalSystem + Clone,
    F: Scheme<S>,
{
    let errors = check_state(motion, scheme, order);
    if motion.conserves_energy {
        check_slope("H", &errors.h, &errors.energy, order, ENERGY_SLOPE_TOLERANCE);
    }
}

/// Order 2 towards certified digits with `|q − q*| ≤ constant · h²`. The constants are truncation error,
/// measured and rounded up.
#[track_caller]
fn check_certified<S, F>(motion: &Motion<S>, scheme: impl Fn(f64) -> F, constant: f64)
where
    S: MechanicalSystem + Clone,
    F: Scheme<S>,
{
    let errors = check_state(motion, scheme, 2.0);
    let measured = errors.h.iter().zip(&errors.q).map(|(h, error)| error / (h * h)).fold(0.0, f64::max);
    println!("{}: |q - q*| / h^2 = {measured:.4}", core::panic::Location::caller());
    assert!(measured <= constant, "error constant {measured}, at most {constant} expected");
}

/// Coordinates of the two bobs with frequencies of their own.
const PER_BOB: [Frequency; 4] = [
    Frequency::Trigonometric(3.13),
    Frequency::Trigonometric(3.13),
    Frequency::Trigonometric(1.7),
    Frequency::Trigonometric(1.7),
];
/// Every coordinate with a frequency of its own, of all three kinds.
const PER_COORDINATE: [Frequency; 4] = [
    Frequency::Trigonometric(3.13),
    Frequency::Hyperbolic(2.0),
    Frequency::ZERO,
    Frequency::Trigonometric(5.0),
];
const HYPERBOLIC: Frequency = Frequency::Hyperbolic(2.5);

/// A user's nodes.
fn on_nodes<const K: usize>(nodes: [f64; K], h: f64) -> Evi<K> {
    Evi::new(Quadrature::interpolatory(nodes).expect("a rule"), h)
}

/// The reference by hand against certified digits, in other coordinates.
#[test]
fn extrapolation_by_hand_is_good_to_round_off() {
    let system = DoublePendulumInAngles { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g: evi_examples::GRAVITY };
    for end in references::DOUBLE_PENDULUM_MILD {
        let steps = (200.0 * end.t) as u32;
        let acceleration = |_, q: &[f64; 2], v: &[f64; 2]| system.acceleration(q, v);
        let (q, v) = extrapolate_by_hand(acceleration, ([0.1, 0.1], [0.0; 2]), end.t, steps);
        let reached = system.cartesian(q, v);
        let error = largest_difference(&reached.q, end.q).max(largest_difference(&reached.v, end.v));
        println!("after {}: {error:e}", end.t);
        // Round-off of up to 2,000 steps.
        assert!(error <= 3e-14, "off by {error:e}");
    }
}
