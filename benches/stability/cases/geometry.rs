//! Case 5: singular configurations, and constraints that depend on each other.

use std::f64::consts::PI;
use std::sync::Arc;

use evi_examples::{DoublePendulum, FourBar, GRAVITY, SliderCrank, Start, StiffSpringPendulum};

use crate::methods::{on_constraints, on_constraints_of_rank, without_constraints};
use crate::observation::{Observation, observe};
use crate::rows::{Effort, Planned, Trial};
use crate::scenes::{AlmostTwice, ThreeCranks};
use crate::specimen::Experiment;
use crate::theory::{Figure, Theory};
use crate::verdict::Kind;

pub(crate) const SUMMARY: &str = "linkages and chains through and at the line, a direction of length zero, constraints that are nearly or fully dependent";

const CASE: &str = "geometry";
/// Singular values below this part of the largest are round-off of the constraints.
const ROUND_OFF: f64 = 1e-11;

pub(crate) fn rows(effort: Effort) -> Vec<Planned> {
    let mut rows = Vec::new();
    for angle in effort.of(&[1.0, 1e-3, 1e-6, 1e-9, 0.0]) {
        rows.extend(linkage(effort, angle));
    }
    rows.extend(stretched(effort));
    rows.extend(at_dead_centres(effort));
    for angle in effort.of(&[1.0, 1e-3, 1e-6, 1e-9, 0.0]) {
        rows.extend(rod_on_crank(effort, angle));
    }
    for alpha in effort.of(&[1.0, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 0.0]) {
        rows.extend(almost_twice(effort, alpha));
    }
    rows.extend(inconsistent(effort));
    rows.extend(three_cranks(effort));
    for l in [1.0, 0.0] {
        rows.extend(without_a_direction(effort, l));
    }
    rows.extend(past_the_pivot(effort));
    rows
}

/// A parallelogram: where its bars lie in a line, it may go on as one or fold. It starts so many radians before the line.
const PARALLELOGRAM: FourBar = FourBar {
    m_crank: 1.0,
    m_coupler: 2.0,
    m_rocker: 1.5,
    crank: 1.0,
    coupler: 2.0,
    rocker: 1.0,
    ground: 2.0,
    g: GRAVITY,
};

fn linkage(effort: Effort, angle: f64) -> Vec<Planned> {
    const RATE: f64 = 6.0;
    let (sine, cosine) = angle.sin_cos();
    let q = [cosine, sine, cosine + 2.0, sine];
    let velocity = [RATE * sine, -RATE * cosine];
    let v = [velocity[0], velocity[1], velocity[0], velocity[1]];
    let exchanged = 0.5 * 3.5 * RATE * RATE + 3.5 * GRAVITY;
    let experiment = Experiment::new(PARALLELOGRAM, q, v, exchanged, on_constraints).reaching(1.5);
    Trial::new(
        CASE,
        format!("parallelogram {angle:.0e} rad before the line"),
        experiment,
        effort.course(0.01, 1000, 1.0),
    )
    .measuring(|_, seen| {
        // Of a parallelogram the coupler stays level.
        let tilt = seen.end.as_ref().map_or(f64::NAN, |end| (end.q[3] - end.q[1]).abs());
        vec![Figure::seen("tilt of the coupler at the end", tilt)]
    })
    .rows()
}

/// An open chain in a line, stretched and folded, from rest and turning as a whole: its constraints are independent there as anywhere.
fn stretched(effort: Effort) -> Vec<Planned> {
    const SYSTEM: DoublePendulum = DoublePendulum { m1: 1.0, m2: 0.5, l1: 1.0, l2: 0.8, g: GRAVITY };
    let exchanged = GRAVITY * (SYSTEM.m1 * SYSTEM.l1 + SYSTEM.m2 * (SYSTEM.l1 + SYSTEM.l2));
    let turning = |Start { q, .. }: Start<4>, rate: f64| Start {
        q,
        v: [-rate * q[1], rate * q[0], -rate * q[3], rate * q[2]],
    };
    let folded = SYSTEM.at_angles(0.5, 0.5 + PI);
    let starts = [
        ("rods stretched, at rest", SYSTEM.horizontal()),
        ("rods stretched, turning", turning(SYSTEM.horizontal(), 6.0)),
        ("rods folded, at rest", folded),
        ("rods folded, turning", turning(folded, 6.0)),
    ];
    let trial = |(name, Start { q, v }): (&str, Start<4>)| {
        let experiment = Experiment::new(SYSTEM, q, v, exchanged, on_constraints);
        Trial::new(CASE, name, experiment, effort.course(0.01, 500, 2.7)).rows()
    };
    effort.of(&starts).into_iter().flat_map(trial).collect()
}

/// Crank and rod in a line, six times: the slider stops there, the constraints are independent, for the rod is longer than the crank.
fn at_dead_centres(effort: Effort) -> Vec<Planned> {
    let system = SliderCrank::STANDARD;
    let Start { q, v } = system.stretched_out(15.0);
    let exchanged = system.g * system.r * (system.m_crank + system.m_rod);
    let experiment = Experiment::new(system, q, v, exchanged, on_constraints).reaching(20.0);
    Trial::new(CASE, "slider-crank through its dead centres", experiment, effort.course(0.005, 400, 0.7))
        .rows()
}

/// A rod as long as its crank: where it lies on the crank, the slider at the pivot, it may stay there and turn with it. It starts so many radians before.
fn rod_on_crank(effort: Effort, angle: f64) -> Vec<Planned> {
    const RATE: f64 = 6.0;
    let system = SliderCrank { l: SliderCrank::STANDARD.r, ..SliderCrank::STANDARD };
    let (sine, cosine) = angle.sin_cos();
    // The crank so far from upright.
    let crank = 0.5 * PI - angle;
    let q = [crank, -crank, 2.0 * system.r * sine];
    let v = [RATE, -RATE, -2.0 * system.r * RATE * cosine];
    let exchanged = system.g * system.r * (system.m_crank + system.m_rod);
    let experiment = Experiment::new(system, q, v, exchanged, on_constraints).reaching(40.0);
    Trial::new(
        CASE,
        format!("rod {angle:.0e} rad before it lies on its crank"),
        experiment,
        effort.course(0.01, 500, 1.0),
    )
    .measuring(|_, seen| {
        let apart = seen.end.as_ref().map_or(f64::NAN, |end| (end.q[0] + end.q[1]).abs());
        vec![Figure::seen("rod beside the mirror image of the crank at the end", apart)]
    })
    .rows()
}

/// A plane pendulum by two surfaces that meet at an angle; the motion does not depend on the angle. At an angle of zero it is the
/// spherical pendulum, held twice.
fn almost_twice(effort: Effort, alpha: f64) -> Vec<Planned> {
    let course = effort.course(0.01, 1000, 2.2);
    let swing = |alpha, methods| {
        let system = AlmostTwice::at_angle(alpha);
        let exchanged = system.m * system.g * system.l;
        let smallest_angle = if alpha > 0.0 { alpha } else { 1.0 };
        Experiment::new(system, system.one_radian(), [0.0; 3], exchanged, methods)
            .nearly_dependent(smallest_angle)
    };
    let crossing = Arc::new(swing(1.0, on_constraints_of_rank::<AlmostTwice, 2>));
    let methods = if alpha == 0.0 {
        on_constraints_of_rank::<AlmostTwice, 1>
    } else {
        on_constraints_of_rank::<AlmostTwice, 2>
    };
    Trial::new(CASE, format!("two surfaces at an angle of {alpha:.0e}"), swing(alpha, methods), course)
        .saying(move |method| match method {
            "midpoint_of_rank" if 0.0 < alpha && alpha < ROUND_OFF => {
                Some(Theory::new("at round-off of the second surface the rank is 1", &[Kind::Refused]))
            }
            "midpoint_of_rank" => Some(Theory::new("the rank is stated", &[Kind::Stable])),
            _ if alpha == 0.0 => Some(Theory::new("one constraint says nothing new", &[Kind::Refused])),
            _ => None,
        })
        .measuring(move |method, seen| {
            let apart = apart(seen, &observe(&*crossing, method, course));
            let name = "from the motion at an angle of 1";
            // What holds the point on the circle is as exact as the angle is.
            let exact = if alpha > 0.0 { 1e-13 + 1e-16 / alpha } else { 1e-13 };
            vec![match method {
                "midpoint_of_rank" => Figure::at_most(name, apart, exact),
                _ => Figure::seen(name, apart),
            }]
        })
        .rows()
}

fn apart(seen: &Observation, other: &Observation) -> f64 {
    match (&seen.end, &other.end) {
        (Some(a), Some(b)) if a.t == b.t => {
            a.q.iter().zip(&b.q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        }
        _ => f64::NAN,
    }
}

/// A point on two spheres of different radius about one centre.
fn inconsistent(effort: Effort) -> Vec<Planned> {
    let system = AlmostTwice { l2: 1.2, ..AlmostTwice::at_angle(0.0) };
    let experiment = Experiment::new(system, system.one_radian(), [0.0; 3], GRAVITY, on_constraints);
    Trial::new(CASE, "two spheres without a common point", experiment, effort.course(0.01, 100, 2.2))
        .saying(|_| Some(Theory::new("no such configuration", &[Kind::Refused])))
        .rows()
}

/// Six constraints of rank five.
fn three_cranks(effort: Effort) -> Vec<Planned> {
    let system = ThreeCranks::STANDARD;
    let exchanged = 3.0 * system.m * system.g * system.l;
    let methods = on_constraints_of_rank::<ThreeCranks, 5>;
    let experiment = Experiment::new(system, system.one_radian(), [0.0; 6], exchanged, methods);
    Trial::new(CASE, "a bar on three cranks", experiment, effort.course(0.01, 1000, 2.2))
        .saying(|method| {
            Some(match method {
                "midpoint_of_rank" => Theory::new("the rank is stated", &[Kind::Stable]),
                _ => Theory::new("a constraint follows from the others", &[Kind::Refused]),
            })
        })
        .measuring(move |_, seen| {
            // The bar moves as if each third of its weight hung on a crank of its own: the plane pendulum.
            seen.end.as_ref().map_or(Vec::new(), |end| {
                let level = (end.q[1] - end.q[5]).abs() + (end.q[4] - end.q[0] - 2.0 * system.d).abs();
                vec![Figure::at_most("the bar leaves its level by", level, 1e-13)]
            })
        })
        .rows()
}

/// At the pivot of a spring, whose direction the length of the spring does not have there.
fn without_a_direction(effort: Effort, l: f64) -> Vec<Planned> {
    let system = StiffSpringPendulum { m: 1.0, l, k: 100.0, g: GRAVITY };
    let experiment =
        Experiment::new(system, [0.0; 2], [1.0, 0.5], GRAVITY, without_constraints).reaching(f64::INFINITY);
    Trial::new(
        CASE,
        format!("at the pivot of a spring of length {l}"),
        experiment,
        effort.course(0.01, 100, 2.0),
    )
    .saying(|method| {
        // The norm has no derivative there: a NaN, wherever it is first evaluated.
        const NONE: &[Kind] = &[Kind::Refused, Kind::NoSolution, Kind::Diverged];
        let is_evaluated = !matches!(method, "midpoint" | "midpoint_6" | "gauss_4" | "implicit_midpoint");
        is_evaluated.then(|| Theory::new("|q| has no derivative at 0", NONE))
    })
    .rows()
}

/// Through the pivot: the force turns round within a step.
fn past_the_pivot(effort: Effort) -> Vec<Planned> {
    let system = StiffSpringPendulum { m: 1.0, l: 1.0, k: 100.0, g: 0.0 };
    let experiment = Experiment::new(system, [1.7, 0.0], [0.0; 2], 50.0, without_constraints)
        .about([1.0, 0.0])
        .reaching(2.0);
    Trial::new(CASE, "straight through the pivot of a spring", experiment, effort.course(0.01, 1000, 1.0))
        .rows()
}
