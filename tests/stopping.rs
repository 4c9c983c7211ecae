//! Where an iteration may stop: the energy of long runs against the tolerance.
//!
//! An iteration that converges linearly leaves errors that do not average out, and they add up to a drift of the energy.
//! One that goes on until nothing is left has none.

use evi_core::baseline::Rattle;
use evi_core::prelude::*;
use evi_core::report::Drift;
use evi_examples::{GRAVITY, SphericalPendulum};

const H: f64 = 0.02;
const STEPS: usize = 200_000;
const BLOCKS: usize = 64;

fn inner(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// A plane pendulum of unit mass and length from the horizontal, by RATTLE with a slope frozen at the start of the step:
/// `G(q₀) G(q₀)ᵀ` for `G(q₁) G(q₀)ᵀ`. It stops where `φ = ½ (|q|² − 1)` is below `tolerance`.
fn frozen_slope(tolerance: f64) -> Drift {
    let (mut q, mut v) = ([1.0, 0.0], [0.0, 0.0]);
    let energies: Vec<f64> = (0..STEPS)
        .map(|_| {
            let start = q;
            v[1] -= 0.5 * H * GRAVITY;
            q = [start[0] + H * v[0], start[1] + H * v[1]];
            loop {
                let residual = 0.5 * (inner(q, q) - 1.0);
                if residual.abs() < tolerance {
                    break;
                }
                let multiplier = residual / inner(start, start);
                for i in 0..2 {
                    q[i] -= multiplier * start[i];
                    v[i] -= multiplier * start[i] / H;
                }
            }
            v[1] -= 0.5 * H * GRAVITY;
            let normal = inner(q, v) / inner(q, q);
            v = [v[0] - normal * q[0], v[1] - normal * q[1]];
            0.5 * inner(v, v) + GRAVITY * q[1]
        })
        .collect();
    drift(&energies)
}

fn library<F: Scheme<SphericalPendulum>>(scheme: F) -> Drift {
    let mut run =
        Simulation::new(SphericalPendulum::UNIT, scheme).start([1.0, 0.0, 0.0], [0.0; 3]).expect("a start");
    let energies: Vec<f64> = (0..STEPS)
        .map(|_| {
            run.advance().expect("a step");
            run.energy()
        })
        .collect();
    drift(&energies)
}

#[track_caller]
fn drift(energies: &[f64]) -> Drift {
    let drift = Drift::of(energies, BLOCKS).expect("more steps than blocks");
    println!("{:.2e} ± {:.2e} per step", drift.slope, drift.half_width);
    drift
}

#[test]
fn a_linearly_convergent_iteration_drifts_with_its_tolerance() {
    let [coarse, middle, fine] = [1e-5, 1e-7, 1e-9].map(frozen_slope);
    // 0.016 J over the run.
    assert!((-8.5e-8..-7.5e-8).contains(&coarse.slope), "{coarse:?}");
    assert!((-2.5e-10..-1e-10).contains(&middle.slope), "{middle:?}");
    for seen in [coarse, middle] {
        assert!(!seen.is_indistinguishable_from_zero(), "{seen:?}");
    }
    check_none(fine);
}

/// The interval is 1e-5 J over the run, of an energy that oscillates by 0.04 J.
#[track_caller]
fn check_none(drift: Drift) {
    assert!(drift.is_indistinguishable_from_zero() && drift.half_width < 6e-11, "{drift:?}");
}

#[test]
fn the_iteration_of_this_library_leaves_no_drift() {
    check_none(library(Rattle::new(H)));
    check_none(library(Evi::midpoint(H)));
    check_none(library(Evi::simpson(H).frequency(3.13)));
}
