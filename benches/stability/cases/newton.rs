//! Case 7: Newton's iteration where steps have no solution, two solutions, or start far from them.

use evi_examples::{DoublePendulum, SphericalPendulum, Start};

use crate::existence::proof;
use crate::methods::{on_the_double_pendulum, with_constraints};
use crate::observation::{Ending, Observation, observe};
use crate::rows::{Effort, Finding, Planned, Trial};
use crate::specimen::Experiment;
use crate::theory::{Figure, Theory};
use crate::verdict::Kind;

pub(crate) const SUMMARY: &str = "steps without a solution, which a proof confirms; two solutions next to each other; predictions far from any";

const CASE: &str = "newton";

pub(crate) fn rows(effort: Effort) -> Vec<Planned> {
    let mut rows = Vec::new();
    for omega in [9.81_f64.sqrt(), 2.397] {
        rows.extend(without_solution(effort, omega));
    }
    for ratio in effort.of(&[0.5, 0.9, 0.99, 0.9999, 0.999_999, 1.000_001, 1.01, 2.0, 100.0]) {
        rows.extend(two_ends(effort, ratio));
    }
    for speed in effort.of(&[1.0, 10.0, 30.0, 100.0, 1e4]) {
        rows.extend(far_predictions(effort, speed));
    }
    rows
}

const UNIT: DoublePendulum = DoublePendulum::UNIT;

/// From the horizontal at h = 0.1.
fn without_solution(effort: Effort, omega: f64) -> Vec<Planned> {
    const H: f64 = 0.1;
    let Start { q, v } = UNIT.horizontal();
    let experiment = Experiment::new(UNIT, q, v, 3.0 * UNIT.g, on_the_double_pendulum)
        .about([0.0, -1.0, 0.0, -2.0])
        .with_frequency(omega);
    Trial::new(
        CASE,
        format!("from the horizontal, ω = {omega:.3}"),
        experiment,
        effort.course(H, 100, f64::INFINITY),
    )
    .saying(|method| {
        Some(match method {
            "midpoint" | "rattle" => Theory::new("all 100 steps exist", Kind::KEPT),
            "midpoint_trig" | "simpson_trig" => {
                Theory::new("a step without a solution comes within 7 s", &[Kind::NoSolution])
            }
            "simpson_trig_rescued" => Theory::new("its parts exist", Kind::KEPT),
            _ => return None,
        })
    })
    .measuring(move |method, seen| proof(&UNIT, method, Some(omega), H, seen))
    .rows()
}

/// A pendulum at its lowest point whose step has a chord of so many lengths: two ends, one below the other.
fn two_ends(effort: Effort, ratio: f64) -> Vec<Planned> {
    const H: f64 = 0.1;
    let system = SphericalPendulum::UNIT;
    let speed = ratio / H;
    let exchanged = 0.5 * speed * speed + system.g;
    let experiment =
        Experiment::new(system, [0.0, 0.0, -1.0], [speed, 0.0, 0.0], exchanged, with_constraints)
            .about([0.0, 0.0, -1.0]);
    Trial::new(CASE, format!("chord of {ratio} lengths"), experiment, effort.course(H, 1, f64::INFINITY))
        .saying(move |method| {
            matches!(method, "midpoint" | "simpson" | "rattle" | "shake").then(|| {
                if ratio > 1.0 {
                    Theory::new("no end on the sphere", &[Kind::NoSolution])
                } else {
                    Theory::new("two ends, of which the near one is the motion's", Kind::KEPT)
                }
            })
        })
        .measuring(move |method, seen| {
            let is_straight = matches!(method, "midpoint" | "simpson" | "rattle" | "shake");
            match seen.end.as_ref().filter(|_| is_straight && ratio < 1.0) {
                Some(end) => {
                    // Where both ends meet, a rounding of the speed is the root of it in the height.
                    let height = -(1.0 - ratio * ratio).sqrt();
                    vec![Figure::about("height of the end", end.q[2], height, 1e-9)]
                }
                None => Vec::new(),
            }
        })
        .rows()
}

/// Random configurations and velocities of this size, at h = 0.1: many predictions are far from any solution. Nothing wrong is accepted.
fn far_predictions(effort: Effort, speed: f64) -> Vec<Planned> {
    let runs = if effort.quick { 20 } else { 100 };
    let plan = |facts: evi_benches::comparison::methods::MethodFacts| {
        let method = facts.name;
        let work = move || {
            let mut all = Observation::nothing();
            all.largest_size = 3.0;
            let mut unsolved = 0;
            for seed in 0..runs {
                let seen = observe(&random_start(seed, speed), method, effort.course(0.1, 20, f64::INFINITY));
                all.check.merge(&seen.check);
                all.taken += seen.taken;
                unsolved +=
                    u32::from(matches!(seen.ending, Ending::Failed { .. } | Ending::NotFinite { .. }));
                all.steps += seen.steps;
                all.samples.extend(&seen.samples);
                if !matches!(seen.ending, Ending::Complete) {
                    all.ending = seen.ending;
                }
            }
            let part = f64::from(unsolved) / f64::from(runs);
            Finding::of(&all, 0.1, None, vec![Figure::seen("part of the runs that end early", part)])
        };
        let parameter = format!("random starts of speed {speed:.0e}");
        Planned { case: CASE, parameter, method, work: Box::new(work) }
    };
    let methods = on_the_double_pendulum::<DoublePendulum>();
    methods.into_iter().map(|method| plan(method.facts)).collect()
}

/// Rods at random angles that turn at random rates.
fn random_start(seed: u32, speed: f64) -> Experiment<DoublePendulum> {
    let mut bits = u64::from(seed).wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(0xD1B5_4A32_D192_ED03);
    let mut random = move || {
        // Marsaglia's xorshift.
        bits ^= bits << 13;
        bits ^= bits >> 7;
        bits ^= bits << 17;
        (bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    let [angle1, angle2] = [random(), random()].map(|x| std::f64::consts::PI * x);
    let [rate1, rate2] = [speed * random(), speed * random()];
    let q = UNIT.at_angles(angle1, angle2).q;
    let inner = [rate1 * angle1.cos(), rate1 * angle1.sin()];
    let v = [inner[0], inner[1], inner[0] + rate2 * angle2.cos(), inner[1] + rate2 * angle2.sin()];
    let exchanged = speed * speed + 3.0 * UNIT.g;
    Experiment::new(UNIT, q, v, exchanged, on_the_double_pendulum)
        .about([0.0, -1.0, 0.0, -2.0])
        .with_frequency(9.81_f64.sqrt())
        .reaching(10.0)
}
