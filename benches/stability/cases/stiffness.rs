//! Case 1: stiffness grows at a fixed step size, until springs are rods.

use std::f64::consts::PI;

use evi_benches::comparison::methods;
use evi_core::baseline::Rattle;
use evi_core::prelude::*;
use evi_examples::{FermiPastaUlam, GRAVITY, PendulumCartesian, Start, StiffSpringPendulum};

use crate::methods::{with_constraints, without_constraints};
use crate::observation::Observation;
use crate::rows::{Effort, Planned, Trial};
use crate::scenes::StiffLink;
use crate::specimen::{Experiment, Specimen};
use crate::theory::{Figure, beside, limit_of_forces};

pub(crate) const SUMMARY: &str =
    "springs of growing stiffness at h = 0.01, against the limits of the linear theory";

const CASE: &str = "stiffness";
const H: f64 = 0.01;
const STEPS: u64 = 2000;
const ANGLE: f64 = 0.5;

pub(crate) fn rows(effort: Effort) -> Vec<Planned> {
    let mut rows = Vec::new();
    for k in effort.of(&[1e2, 1e4, 3.8e4, 4.2e4, 1.1e5, 1.3e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12]) {
        rows.extend(spring(effort, k));
    }
    for k in effort.of(&[1e4, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12]) {
        rows.extend(limit(effort, k));
    }
    for k in effort.of(&[1e2, 1e4, 3e4, 1e5, 1e6, 1e8, 1e10, 1e12]) {
        rows.extend(chain(effort, k));
    }
    for omega in effort.of(&[
        10.0,
        50.0,
        100.0,
        190.0,
        210.0,
        300.0,
        100.0 * PI,
        340.0,
        355.0,
        500.0,
        200.0 * PI,
        1000.0,
    ]) {
        rows.extend(fermi_pasta_ulam(effort, omega));
    }
    rows
}

/// Half a radian from rest, the spring unstretched.
fn swinging_spring(k: f64) -> Experiment<StiffSpringPendulum> {
    let (sine, cosine) = ANGLE.sin_cos();
    let exchanged = GRAVITY * (1.0 - cosine);
    let system = StiffSpringPendulum::with_stiffness(k);
    Experiment::new(system, [sine, -cosine], [0.0; 2], exchanged, without_constraints)
        .about([0.0, -1.0 - GRAVITY / k])
}

fn spring(effort: Effort, k: f64) -> Vec<Planned> {
    let phase = H * k.sqrt();
    Trial::new(
        CASE,
        format!("spring pendulum, k = {k:.1e}"),
        swinging_spring(k),
        effort.course(H, STEPS, 2.0),
    )
    .saying(move |method| limit_of_forces(method).map(|limit| beside(limit, phase, method)))
    .rows()
}

/// Two seconds of the same, beside what the methods tend to as `k → ∞`.
fn limit(effort: Effort, k: f64) -> Vec<Planned> {
    let parameter = format!("spring pendulum for 2 s, k = {k:.1e}");
    Trial::new(CASE, parameter, swinging_spring(k), effort.course(H, SHORT, 2.0))
        .measuring(move |method, seen| beside_the_rod(method, k, seen))
        .rows()
}

/// Two seconds.
const SHORT: u64 = 200;

/// How far the end of the run is from a rod, and for the midpoint rule from what it tends to.
fn beside_the_rod(method: &str, k: f64, seen: &Observation) -> Vec<Figure> {
    let (Some(end), Some(rod)) = (&seen.end, rod()) else { return Vec::new() };
    let from = |[x, y]: [f64; 2]| (end.q[0] - x).hypot(end.q[1] - y);
    if !matches!(method, "midpoint" | "implicit_midpoint") {
        return vec![Figure::seen("from the rod", from(rod))];
    }
    let levels_off = if k < 1e8 {
        Figure::seen("from the rod", from(rod))
    } else {
        // Theory 5.7e-5, from another code.
        Figure::about("from the rod", from(rod), 5.7e-5, 0.02)
    };
    // The spring is stretched by its force over k, and the phase is off by as much; roundings of its length, times k, make 5e-8 at 1e12.
    vec![levels_off, Figure::at_most("from the rod at midpoints", from(rod_at_midpoints()), 100.0 / k + 1e-7)]
}

/// What the midpoint rule tends to as `k → ∞`: the middle of the chord is on the circle, `m = a/|a|` with `a = q₀ + ½h p₀ − ¼h² g`, and the
/// ends stick out. That is not the rod, from which it stays away by an error of second order in `h`.
fn rod_at_midpoints() -> [f64; 2] {
    let (sine, cosine) = ANGLE.sin_cos();
    let (mut q, mut p) = ([sine, -cosine], [0.0; 2]);
    for _ in 0..SHORT {
        let a = [q[0] + 0.5 * H * p[0], q[1] + 0.5 * H * p[1] - 0.25 * H * H * GRAVITY];
        let length = a[0].hypot(a[1]);
        let next = [0, 1].map(|i| 2.0 * a[i] / length - q[i]);
        p = [0, 1].map(|i| 2.0 * (next[i] - q[i]) / H - p[i]);
        q = next;
    }
    q
}

fn rod() -> Option<[f64; 2]> {
    let Start { q, v } = PendulumCartesian::UNIT.at_rest(ANGLE);
    let mut run = Simulation::new(PendulumCartesian::UNIT, Rattle::new(H)).start(q, v).ok()?;
    Some(*run.advance_to(H * SHORT as f64).ok()?.q())
}

/// Small swings of a chain with one stiff link, whose frequency its linearisation gives.
fn chain(effort: Effort, k: f64) -> Vec<Planned> {
    let system = StiffLink::with_stiffness(k);
    let start = system.at_angles([0.1, 0.15, -0.05]);
    let exchanged = 0.01 * system.m * GRAVITY * system.l;
    let experiment =
        Experiment::new(system, start, [0.0; 6], exchanged, with_constraints).about(system.hanging());
    let phase = experiment.fastest_frequency().map_or(f64::NAN, |frequency| H * frequency);
    Trial::new(
        CASE,
        format!("chain with a stiff link, k = {k:.1e}"),
        experiment,
        effort.course(H, STEPS, 3.0),
    )
    .saying(move |method| {
        // The implicit midpoint rule differentiates the constraints, which adds what the linear theory does not have.
        let limit = limit_of_forces(method).filter(|_| method != "implicit_midpoint");
        limit.map(|limit| beside(limit, phase, method))
    })
    .rows()
}

/// The stiff springs of the chain are linear, and all of frequency `omega`.
fn fermi_pasta_ulam(effort: Effort, omega: f64) -> Vec<Planned> {
    let system = FermiPastaUlam { omega };
    let Start { q, v } = system.one_spring_excited();
    let experiment = Experiment::new(system, q, v, 1.0, || {
        let mut methods = without_constraints();
        methods.push(methods::simpson_trig());
        methods
    })
    .about([0.0; 6])
    .with_frequency(omega);
    let phase = H * omega;
    Trial::new(CASE, format!("Fermi-Pasta-Ulam, ω = {omega:.1}"), experiment, effort.course(H, STEPS, 2.0))
        .saying(move |method| limit_of_forces(method).map(|limit| beside(limit, phase, method)))
        .rows()
}
