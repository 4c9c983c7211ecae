//! Case 4: slow and fast motions, starts next to a separatrix, runs of ten million steps, round-off.

use std::f64::consts::PI;

use evi_examples::{DoublePendulum, GRAVITY, Scene, SphericalPendulum, Start};

use crate::brouwer;
use crate::methods::{for_long_runs, with_constraints};
use crate::observation::{Course, Observation};
use crate::rows::{Effort, Planned, Trial};
use crate::specimen::Experiment;
use crate::theory::{Figure, Theory};
use crate::verdict::{Kind, on};

pub(crate) const SUMMARY: &str = "spinning at 1e-6 to 1e6 rad/s, next to a separatrix, ten million steps regular and chaotic, Brouwer's law";

const CASE: &str = "energies";
const UNIT: SphericalPendulum = SphericalPendulum::UNIT;

pub(crate) fn rows(effort: Effort) -> Vec<Planned> {
    let mut rows = Vec::new();
    for rate in effort.of(&[1e-6, 1e-3, 1.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6]) {
        let h = 0.02 / f64::max(rate, UNIT.g.sqrt());
        rows.extend(spinning(effort, rate, h, "resolved"));
    }
    for rate in effort.of(&[10.0, 100.0, 115.0, 122.0, 1e3, 1e6]) {
        rows.extend(spinning(effort, rate, 0.01, "h = 0.01"));
    }
    for below in effort.of(&[1e-1, 1e-3, 1e-6, 1e-9, 1e-12, 1e-15]) {
        rows.extend(next_to_the_separatrix(effort, below));
    }
    rows.extend(regular(effort));
    rows.extend(chaotic(effort));
    rows.extend(in_space(effort));
    rows.extend(brouwer::rows(CASE, effort));
    rows
}

/// One radian from the downward vertical, going round at a rate.
fn spinning(effort: Effort, rate: f64, h: f64, label: &str) -> Vec<Planned> {
    let Start { q, .. } = UNIT.one_radian();
    let speed = rate * q[0];
    let exchanged = UNIT.g + 0.5 * speed * speed;
    let experiment = Experiment::new(UNIT, q, [0.0, speed, 0.0], exchanged, with_constraints)
        .about([0.0, 0.0, -1.0])
        .keeping(SphericalPendulum::MOMENTA);
    let period = 2.0 * PI / f64::max(rate, UNIT.g.sqrt());
    let chord = h * speed;
    Trial::new(
        CASE,
        format!("spinning at {rate:e} rad/s, {label}"),
        experiment,
        effort.course(h, 2000, period),
    )
    .saying(move |method| {
        let is_straight = matches!(method, "midpoint" | "simpson" | "rattle" | "shake");
        is_straight.then(|| {
            if chord > 1.0 {
                Theory::new("a chord beyond the radius: no end on the sphere", &[Kind::NoSolution])
            } else {
                Theory::new("a chord below the radius", Kind::KEPT)
            }
        })
    })
    .rows()
}

/// At rest, so far from the upper equilibrium.
fn next_to_the_separatrix(effort: Effort, below: f64) -> Vec<Planned> {
    let (sine, cosine) = (PI - below).sin_cos();
    let experiment = Experiment::new(UNIT, [sine, 0.0, -cosine], [0.0; 3], 2.0 * UNIT.g, with_constraints)
        .about([0.0, 0.0, -1.0])
        .keeping(SphericalPendulum::MOMENTA);
    Trial::new(
        CASE,
        format!("{below:.0e} rad from the separatrix"),
        experiment,
        effort.course(0.01, 4000, 4.0),
    )
    .saying(|method| {
        let is_straight = matches!(method, "midpoint" | "simpson" | "rattle" | "shake" | "galerkin_4");
        is_straight.then(|| Theory::new("symplectic: no trend", &[Kind::Stable]))
    })
    .rows()
}

const UNEQUAL: DoublePendulum = DoublePendulum { m1: 1.0, m2: 0.5, l1: 1.0, l2: 0.8, g: GRAVITY };

fn long_course(effort: Effort, h: f64) -> Course {
    let steps = if effort.quick { 100_000 } else { 10_000_000 };
    Course { steps_per_sample: steps / 10_000, ..effort.course(h, steps, 3.0) }
}

/// A round-off of the constraints that does not grow with the number of steps.
const ON_THE_CONSTRAINTS: f64 = 2e-15;

fn on_the_constraints(method: &str, seen: &Observation) -> [Figure; 2] {
    let position = seen.largest(|sample| sample.constraint).unwrap_or(f64::NAN);
    let velocity = seen.largest(|sample| sample.hidden).unwrap_or(f64::NAN);
    // The classical form of RATTLE projects once: near rest the velocity has round-off of the configuration.
    let refines = method != "rattle";
    [
        Figure::at_most("|φ|", position, ON_THE_CONSTRAINTS),
        if refines {
            Figure::at_most("|G v|", velocity, ON_THE_CONSTRAINTS)
        } else {
            Figure::seen("|G v|", velocity)
        },
    ]
}

/// Small swings: a regular motion, on which energies have no slope.
fn regular(effort: Effort) -> Vec<Planned> {
    let Start { q, v } = UNEQUAL.at_angles(0.1, 0.15);
    let exchanged = 0.005 * GRAVITY * (UNEQUAL.m1 + UNEQUAL.m2 * 1.8);
    let experiment = Experiment::new(UNEQUAL, q, v, exchanged, for_long_runs).about([0.0, -1.0, 0.0, -1.8]);
    Trial::new(CASE, "double pendulum, regular", experiment, long_course(effort, 0.01))
        .saying(|method| {
            says(method, Theory::new("regular: the slope of the energy is zero", &[Kind::Stable]))
        })
        .measuring(|method, seen| {
            let slope = on(seen).slope().map_or(f64::NAN, |slope| slope.per_step.abs() / slope.half_width);
            kept(method, seen, Figure::at_most("slope over its half-width", slope, 1.0))
        })
        .drawn()
        .rows()
}

/// From the horizontal: what bounds the energy is diffusion.
fn chaotic(effort: Effort) -> Vec<Planned> {
    let Start { q, v } = UNEQUAL.horizontal();
    let exchanged = GRAVITY * (UNEQUAL.m1 + UNEQUAL.m2 * 1.8);
    let experiment = Experiment::new(UNEQUAL, q, v, exchanged, for_long_runs).about([0.0, -1.0, 0.0, -1.8]);
    Trial::new(CASE, "double pendulum, chaotic", experiment, long_course(effort, 0.005))
        .saying(|method| says(method, Theory::new("chaotic: bounded by diffusion", Kind::KEPT)))
        .measuring(|method, seen| {
            kept(method, seen, Figure::at_most("exponent of the spread", exponent(seen), 0.8))
        })
        .drawn()
        .rows()
}

/// A regular motion that keeps an angular momentum.
fn in_space(effort: Effort) -> Vec<Planned> {
    let Start { q, v } = UNIT.one_radian();
    let exchanged = UNIT.g * (1.0 + q[2]);
    let experiment = Experiment::new(UNIT, q, v, exchanged, for_long_runs)
        .about([0.0, 0.0, -1.0])
        .keeping(SphericalPendulum::MOMENTA);
    Trial::new(CASE, "spherical pendulum, regular", experiment, long_course(effort, 0.01))
        .saying(|method| {
            says(method, Theory::new("regular: the slope of the energy is zero", &[Kind::Stable]))
        })
        .measuring(|method, seen| match bound_of(method) {
            Bound::None => Vec::new(),
            _ => on_the_constraints(method, seen).into(),
        })
        .drawn()
        .rows()
}

/// What bounds the energy of a method over long times.
enum Bound {
    /// Nothing.
    None,
    /// That it is the energy of a map next to the motion.
    Symplecticity,
    /// The same, but the truncation error is below round-off, whose bias is seen: 1e-18 of the energy exchanged per step.
    Bias,
}

fn bound_of(method: &str) -> Bound {
    match method {
        "rk4" => Bound::None,
        "galerkin_4" => Bound::Bias,
        _ => Bound::Symplecticity,
    }
}

fn says(method: &str, of_no_trend: Theory) -> Option<Theory> {
    match bound_of(method) {
        Bound::None => None,
        Bound::Symplecticity => Some(of_no_trend),
        Bound::Bias => {
            Some(Theory::new("round-off alone, which has a bias", &[Kind::Stable, Kind::Drifting]))
        }
    }
}

/// A figure of the energy that shows no trend, and those of the constraints.
fn kept(method: &str, seen: &Observation, no_trend: Figure) -> Vec<Figure> {
    let mut figures = match bound_of(method) {
        Bound::None => return Vec::new(),
        Bound::Symplecticity => vec![no_trend],
        Bound::Bias => {
            let largest = seen.largest(|sample| sample.energy).unwrap_or(f64::NAN);
            // 1.1e-11 after 1e7 steps measured.
            let bound = Figure::at_most("largest energy error", largest, 2e-11);
            vec![Figure { theory: None, ..no_trend }, bound]
        }
    };
    figures.extend(on_the_constraints(method, seen));
    figures
}

/// `log₂` of how much more the energies spread over twice the time, mean over four doublings: ½ of diffusion, 1 of a drift, 0 of a
/// bounded error.
fn exponent(seen: &Observation) -> f64 {
    let energies: Vec<f64> = seen.samples.iter().map(|sample| sample.energy).collect();
    let spread = |span: usize| -> f64 {
        let squares = energies[span..].iter().zip(&energies).map(|(b, a)| (b - a).powi(2));
        (squares.sum::<f64>() / (energies.len() - span) as f64).sqrt()
    };
    let span = energies.len() / 64;
    if span == 0 { f64::NAN } else { (spread(16 * span) / spread(span)).log2() / 4.0 }
}
