//! What a user does with a run: starts, steps, times, recordings, observables, and comparisons.

mod observables;
mod single_precision;
mod solvers;
mod starts;
mod times;
mod two_steps;

use evi_core::baseline::{Rattle, Rk4};
use evi_core::comparison::Solver;
use evi_core::integrator::EviStep;
use evi_core::mechanics::Mechanics;
use evi_core::prelude::*;
use evi_core::scheme::Interpolant;
use evi_examples::{DoublePendulum, Pendulum, SphericalPendulum, Start, StiffSpringPendulum};
use evi_tests::largest_difference;
use evi_tests::scenes::{ChargedSphericalPendulum, Dumbbell, KapitzaPendulum, RelativisticBead};
use nalgebra::{DMatrix, DVector, SVector};

const EPSILON: f64 = f64::EPSILON;
/// No two parameters alike, so that no term can take the place of another.
const UNEQUAL: DoublePendulum = DoublePendulum { m1: 1.3, m2: 0.7, l1: 0.9, l2: 1.1, g: 9.81 };

/// The unequal double pendulum in motion: angles 0.8 and −0.3 at the rates 0.5 and 1.1.
fn moving() -> Start<4> {
    let ([a, b], [a_rate, b_rate]) = ([0.8_f64, -0.3_f64], [0.5, 1.1]);
    let q = UNEQUAL.at_angles(a, b).q;
    let inner = [UNEQUAL.l1 * a.cos() * a_rate, UNEQUAL.l1 * a.sin() * a_rate];
    let outer = [inner[0] + UNEQUAL.l2 * b.cos() * b_rate, inner[1] + UNEQUAL.l2 * b.sin() * b_rate];
    Start { q, v: [inner[0], inner[1], outer[0], outer[1]] }
}

fn midpoint_run() -> Run<DoublePendulum, impl OneStep<DoublePendulum>> {
    let Start { q, v } = moving();
    Simulation::new(UNEQUAL, Evi::midpoint(0.01)).start(q, v).expect("the start is consistent")
}

#[track_caller]
fn check_near(a: &[f64], b: &[f64], tolerance: f64) {
    let difference = largest_difference(a, b);
    assert!(difference <= tolerance, "{difference:e}, allowed {tolerance:e}: {a:?} and {b:?}");
}
