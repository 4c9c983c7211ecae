//! Case 8: numbers that are none, or hardly any.

use evi_examples::{DoublePendulum, GRAVITY, Start, StiffSpringPendulum};

use crate::methods::{with_constraints, without_constraints};
use crate::rows::{Effort, Planned, Trial};
use crate::specimen::Experiment;
use crate::theory::Theory;
use crate::verdict::Kind;

pub(crate) const SUMMARY: &str = "NaN, infinity, subnormal and huge numbers, masses of zero, negative stiffness, starts beside the constraints";

const CASE: &str = "numbers";
const SOUND: DoublePendulum = DoublePendulum { m1: 1.0, m2: 0.5, l1: 1.0, l2: 0.8, g: GRAVITY };

pub(crate) fn rows(effort: Effort) -> Vec<Planned> {
    let mut rows = Vec::new();
    for input in effort.of(INPUTS) {
        rows.extend(given(effort, input));
    }
    for k in effort.of(&[f64::NAN, f64::INFINITY, 0.0, 1e-310, 1e300, -100.0]) {
        rows.extend(spring(effort, k));
    }
    rows
}

/// What is wrong, and whether it must be refused.
#[derive(Clone, Copy)]
struct Input {
    name: &'static str,
    system: DoublePendulum,
    /// Changes the start.
    change: fn(&mut Start<4>),
    is_refused: bool,
}

const fn as_is(_: &mut Start<4>) {}

const INPUTS: &[Input] = &[
    Input { name: "position NaN", system: SOUND, change: |start| start.q[2] = f64::NAN, is_refused: true },
    Input {
        name: "position ∞", system: SOUND, change: |start| start.q[0] = f64::INFINITY, is_refused: true
    },
    Input {
        name: "velocity −∞",
        system: SOUND,
        change: |start| start.v[3] = f64::NEG_INFINITY,
        is_refused: true,
    },
    Input {
        name: "constraint violated by 1e-6",
        system: SOUND,
        change: |start| start.q[0] += 1e-6,
        is_refused: true,
    },
    Input {
        name: "velocity off its constraint",
        system: SOUND,
        change: |start| start.v[1] += 1.0,
        is_refused: true,
    },
    Input {
        name: "m₂ = NaN",
        system: DoublePendulum { m2: f64::NAN, ..SOUND },
        change: as_is,
        is_refused: true,
    },
    Input { name: "m₂ = 0", system: DoublePendulum { m2: 0.0, ..SOUND }, change: as_is, is_refused: false },
    Input {
        name: "m₁ = m₂ = 0",
        system: DoublePendulum { m1: 0.0, m2: 0.0, ..SOUND },
        change: as_is,
        is_refused: true,
    },
    Input {
        name: "m₂ = 1e-310",
        system: DoublePendulum { m2: 1e-310, ..SOUND },
        change: as_is,
        is_refused: false,
    },
    Input {
        name: "m₂ = 1e300",
        system: DoublePendulum { m2: 1e300, ..SOUND },
        change: as_is,
        is_refused: false,
    },
    Input {
        name: "masses 1e300",
        system: DoublePendulum { m1: 1e300, m2: 5e299, ..SOUND },
        change: as_is,
        is_refused: false,
    },
    Input {
        name: "m₂ = −0.5",
        system: DoublePendulum { m2: -0.5, ..SOUND },
        change: as_is,
        is_refused: false,
    },
    Input {
        name: "g = ∞",
        system: DoublePendulum { g: f64::INFINITY, ..SOUND },
        change: as_is,
        is_refused: true,
    },
    Input {
        name: "g = 1e300",
        system: DoublePendulum { g: 1e300, ..SOUND },
        change: as_is,
        is_refused: false,
    },
    Input {
        name: "g = 1e-310",
        system: DoublePendulum { g: 1e-310, ..SOUND },
        change: as_is,
        is_refused: false,
    },
    Input { name: "l₂ = 0", system: DoublePendulum { l2: 0.0, ..SOUND }, change: as_is, is_refused: true },
    Input {
        name: "lengths 1e-200",
        system: DoublePendulum { l1: 1e-200, l2: 1e-200, ..SOUND },
        change: as_is,
        is_refused: false,
    },
    Input {
        name: "lengths 1e200",
        system: DoublePendulum { l1: 1e200, l2: 1e200, ..SOUND },
        change: as_is,
        is_refused: false,
    },
];

fn given(effort: Effort, Input { name, system, change, is_refused }: Input) -> Vec<Planned> {
    let mut start = system.at_angles(0.1, 0.15);
    change(&mut start);
    let DoublePendulum { m1, m2, l1, l2, g } = system;
    let exchanged = (0.005 * g * (m1 * l1 + m2 * (l1 + l2))).abs();
    let experiment = Experiment::new(system, start.q, start.v, exchanged, with_constraints).about([
        0.0,
        -l1,
        0.0,
        -l1 - l2,
    ]);
    Trial::new(CASE, name, experiment, effort.course(0.01, 200, 3.0))
        .saying(move |method| {
            // It takes what it is given, and has to fail on the way.
            const NEVER_DONE: &[Kind] = &[Kind::Refused, Kind::NoSolution, Kind::Diverged, Kind::Drifting];
            is_refused.then(|| {
                let admits = if method == "dop853" { NEVER_DONE } else { &[Kind::Refused] };
                Theory::new("no such motion", admits)
            })
        })
        .rows()
}

fn spring(effort: Effort, k: f64) -> Vec<Planned> {
    let system = StiffSpringPendulum { m: 1.0, l: 1.0, k, g: GRAVITY };
    let experiment = Experiment::new(system, [0.5, -0.9], [0.0; 2], GRAVITY, without_constraints)
        .about([0.0, -1.0 - GRAVITY / k])
        .reaching(f64::INFINITY);
    Trial::new(CASE, format!("spring of stiffness {k:e}"), experiment, effort.course(0.01, 200, 2.0))
        .saying(move |method| {
            const NEVER_DONE: &[Kind] = &[Kind::Refused, Kind::NoSolution, Kind::Diverged];
            (!k.is_finite()).then(|| {
                let admits = if method == "dop853" { NEVER_DONE } else { &[Kind::Refused] };
                Theory::new("no such motion", admits)
            })
        })
        .rows()
}
