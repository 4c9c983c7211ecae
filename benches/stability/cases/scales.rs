//! Case 3: masses and lengths out of all proportion; the same motion in other units.

use std::sync::Arc;

use evi_examples::{DoublePendulum, GRAVITY, Start};

use crate::existence::proof;
use crate::methods::with_constraints;
use crate::observation::{Course, Observation, observe};
use crate::rows::{Effort, Planned, Trial};
use crate::specimen::{Experiment, Specimen};
use crate::theory::{Figure, Theory, beside_constraints};
use crate::verdict::Kind;

pub(crate) const SUMMARY: &str =
    "mass ratios 1e-12 to 1e12, length ratios 1e-9 to 1e9, and units 1e±9: the same digits after rescaling";

const CASE: &str = "scales";
const STEPS: u64 = 2000;
/// Small enough for every member to resolve the fastest oscillation.
const RESOLVED: f64 = 0.1;

pub(crate) fn rows(effort: Effort) -> Vec<Planned> {
    let mut rows = Vec::new();
    for ratio in effort.of(&[1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9, 1e12]) {
        let system = DoublePendulum { m1: 1.0, m2: ratio, l1: 1.0, l2: 0.8, g: GRAVITY };
        rows.extend(unequal(effort, &format!("m₂/m₁ = {ratio:.0e}"), system));
    }
    rows.extend(jerked(effort));
    for ratio in effort.of(&[1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9]) {
        let system = DoublePendulum { m1: 1.0, m2: 0.7, l1: 1.0, l2: ratio, g: GRAVITY };
        rows.extend(unequal(effort, &format!("l₂/l₁ = {ratio:.0e}"), system));
    }
    let two = 2.0_f64.powi(30);
    for units in effort.of(&[
        Units { name: "length 1e9", length: 1e9, ..Units::SAME },
        Units { name: "length 1e-9", length: 1e-9, ..Units::SAME },
        Units { name: "mass 1e9", mass: 1e9, ..Units::SAME },
        Units { name: "mass 1e-9", mass: 1e-9, ..Units::SAME },
        Units { name: "time 1e9", time: 1e9, ..Units::SAME },
        Units { name: "time 1e-9", time: 1e-9, ..Units::SAME },
        Units { name: "all 2³⁰", length: two, mass: two, time: two },
        Units { name: "all 2⁻³⁰", length: 1.0 / two, mass: 1.0 / two, time: 1.0 / two },
    ]) {
        rows.extend(in_units(effort, units));
    }
    rows
}

/// Small swings, at h = 0.01 and at a step that resolves the fastest oscillation.
fn unequal(effort: Effort, name: &str, system: DoublePendulum) -> Vec<Planned> {
    let experiment = swinging(system);
    let fastest = experiment.fastest_frequency().unwrap_or(f64::NAN);
    let slowest = 2.0 * std::f64::consts::PI * ((system.l1 + system.l2) / GRAVITY).sqrt();
    let mut rows = Vec::new();
    for (label, h) in [("h = 0.01".to_owned(), 0.01), (format!("h w = {RESOLVED}"), RESOLVED / fastest)] {
        let trial = Trial::new(
            CASE,
            format!("{name}, {label}"),
            experiment.clone(),
            effort.course(h, STEPS, slowest),
        );
        rows.extend(
            trial
                .saying(move |method| beside_constraints(h * fastest, method))
                .measuring(move |method, seen| proof(&system, method, None, h, seen))
                .rows(),
        );
    }
    rows
}

/// A heavy bob falls freely on bent rods, for the light joint gives way, until they are straight: there the joint takes over its energy at
/// `v √(m₂/m₁)`, a hundred metres per second, and crosses the line in 1e-5 s. With steps that resolve this, once through it.
fn jerked(effort: Effort) -> Vec<Planned> {
    const H: f64 = 1e-6;
    const STEPS: u64 = 20_000;
    let system = DoublePendulum { m1: 1.0, m2: 1e6, l1: 1.0, l2: 0.8, g: GRAVITY };
    let experiment = swinging(system);
    let course = Course { steps_per_sample: 10, ..effort.course(H, STEPS, 2.7) };
    Trial::new(CASE, "m₂/m₁ = 1e6, h = 1e-6 through the jerk", experiment, course)
        .measuring(|_, seen| {
            let speed = seen.end.as_ref().map_or(f64::NAN, |end| end.v[0].hypot(end.v[1]));
            vec![Figure::seen("speed of the joint at the end", speed)]
        })
        .rows()
}

fn swinging(system: DoublePendulum) -> Experiment<DoublePendulum> {
    let DoublePendulum { m1, m2, l1, l2, g } = system;
    let Start { q, v } = system.at_angles(0.1, 0.15);
    let exchanged = 0.01 * g * (m1 * l1 + m2 * (l1 + l2));
    Experiment::new(system, q, v, exchanged, with_constraints).about([0.0, -l1, 0.0, -l1 - l2])
}

/// How many of the new units are one of the old.
#[derive(Clone, Copy)]
struct Units {
    name: &'static str,
    length: f64,
    mass: f64,
    time: f64,
}

impl Units {
    const SAME: Self = Self { name: "", length: 1.0, mass: 1.0, time: 1.0 };
}

const UNEQUAL: DoublePendulum = DoublePendulum { m1: 1.0, m2: 0.7, l1: 1.0, l2: 0.8, g: GRAVITY };

/// The same motion in two systems of units, compared at its end.
fn in_units(effort: Effort, Units { name, length, mass, time }: Units) -> Vec<Planned> {
    const H: f64 = 0.01;
    let DoublePendulum { m1, m2, l1, l2, g } = UNEQUAL;
    let scaled = DoublePendulum {
        m1: m1 * mass,
        m2: m2 * mass,
        l1: l1 * length,
        l2: l2 * length,
        g: g * length / time / time,
    };
    let mut experiment = swinging(scaled);
    // The very numbers, scaled, so that nothing but units differs.
    experiment.motion.q = UNEQUAL.at_angles(0.1, 0.15).q.map(|x| x * length);
    let same = Arc::new(swinging(UNEQUAL));
    let course = effort.course(H, STEPS, 2.7);
    let is_power_of_two = name.contains('2');
    Trial::new(CASE, format!("units: {name}"), experiment, effort.course(H * time, STEPS, 2.7 * time))
        .saying(|_| Some(Theory::new("units do not matter", &[Kind::Stable, Kind::Drifting])))
        .measuring(move |method, seen| {
            let other = observe(&*same, method, course);
            // Those that the budget ends need not end at the same time.
            if seen.is_out_of_steps() || other.is_out_of_steps() {
                return Vec::new();
            }
            let difference = difference(seen, &other, length);
            let name = "difference of q";
            vec![match method {
                // Its absolute tolerance has a unit.
                "dop853" => Figure::seen(name, difference),
                _ if is_power_of_two => Figure::at_most(name, difference, 0.0),
                _ => Figure::at_most(name, difference, ROUND_OFF),
            }]
        })
        .rows()
}

/// Roundings of other bits, grown over [`STEPS`] steps of a regular motion: 1e-12 measured.
const ROUND_OFF: f64 = 1e-11;

fn difference(seen: &Observation, other: &Observation, length: f64) -> f64 {
    match (&seen.end, &other.end) {
        (Some(a), Some(b)) => a.q.iter().zip(&b.q).map(|(a, b)| (a / length - b).abs()).fold(0.0, f64::max),
        _ => f64::NAN,
    }
}
