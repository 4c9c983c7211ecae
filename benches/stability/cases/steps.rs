//! Case 6: step sizes from round-off to beyond every solution, backwards, and changed on the way.

use std::sync::Arc;

use evi_examples::{DoublePendulum, GRAVITY, Start};

use crate::existence::proof;
use crate::methods::with_constraints;
use crate::observation::{Course, Ending, Observation, observe};
use crate::rows::{Effort, Finding, Planned, Trial};
use crate::specimen::{Experiment, Specimen};
use crate::theory::{Figure, Theory, beside_constraints};
use crate::verdict::Kind;

pub(crate) const SUMMARY: &str =
    "h from 1e-12 to beyond solvability, h that defines no step, h < 0, h doubled and halved on the way";

const CASE: &str = "steps";
const UNEQUAL: DoublePendulum = DoublePendulum { m1: 1.0, m2: 0.5, l1: 1.0, l2: 0.8, g: GRAVITY };
const STEPS: u64 = 1000;
const PERIOD: f64 = 3.0;

pub(crate) fn rows(effort: Effort) -> Vec<Planned> {
    let mut rows = Vec::new();
    for h in effort.of(&[1e-12, 1e-9, 1e-6, 1e-4, 1e-2, 0.1, 0.25, 0.32, 0.4, 0.5, 1.0, 3.0, 30.0, 1e3, 1e6])
    {
        rows.extend(of_size(effort, h));
    }
    for h in [0.0, f64::NAN, f64::INFINITY, 1e-170, 1e200] {
        rows.extend(of_no_size(effort, h));
    }
    rows.extend(backwards(effort));
    rows.extend(changed(effort));
    rows
}

/// Small swings.
fn swinging() -> Experiment<DoublePendulum> {
    let Start { q, v } = UNEQUAL.at_angles(0.1, 0.15);
    let exchanged = 0.005 * GRAVITY * (UNEQUAL.m1 + UNEQUAL.m2 * 1.8);
    Experiment::new(UNEQUAL, q, v, exchanged, with_constraints).about([0.0, -1.0, 0.0, -1.8])
}

fn of_size(effort: Effort, h: f64) -> Vec<Planned> {
    let experiment = swinging();
    let phase = experiment.fastest_frequency().map_or(f64::NAN, |frequency| h * frequency);
    Trial::new(CASE, format!("h = {h:e}"), experiment, effort.course(h, STEPS, PERIOD))
        .saying(move |method| beside_constraints(phase, method))
        .measuring(move |method, seen| proof(&UNEQUAL, method, None, h, seen))
        .rows()
}

fn of_no_size(effort: Effort, h: f64) -> Vec<Planned> {
    let rows = Trial::new(CASE, format!("h = {h:e}"), swinging(), effort.course(h, STEPS, PERIOD))
        .saying(|_| Some(Theory::new("defines no step", &[Kind::Refused])))
        .rows();
    // What chooses its steps is asked for times.
    rows.into_iter().filter(|row| row.method != "dop853").collect()
}

/// There and back again.
fn backwards(effort: Effort) -> Vec<Planned> {
    const H: f64 = -0.02;
    let there = Arc::new(swinging());
    let course = effort.course(H, STEPS, PERIOD);
    let back = effort.course(-H, STEPS, PERIOD);
    Trial::new(CASE, "h = -0.02, and back", swinging(), course)
        .saying(|method| beside_constraints(0.1, method))
        .measuring(move |method, seen| {
            let Some(end) = &seen.end else { return Vec::new() };
            let returned = observe(&*there.restarted(end), method, back);
            let start = there.motion.q;
            // Where the constraints have been left there is no way back: such a start is refused.
            let Some(end) = returned.end else { return Vec::new() };
            let distance = end.q.iter().zip(&start).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let name = "from the start after the way back";
            let is_symmetric = !matches!(method, "rk4" | "dop853" | "generalized_alpha" | "shake");
            // Of 2,000 steps of a regular motion: 3e-13 measured.
            vec![if is_symmetric {
                Figure::at_most(name, distance, 1e-11)
            } else {
                Figure::seen(name, distance)
            }]
        })
        .rows()
}

const PIECES: u64 = 40;

/// Every 50 steps a new run goes on from the state, with steps half as long, then twice as long.
fn changed(effort: Effort) -> Vec<Planned> {
    let specimen: Arc<dyn Specimen> = Arc::new(swinging());
    let plan = |facts: evi_benches::comparison::methods::MethodFacts| {
        let (specimen, method) = (Arc::clone(&specimen), facts.name);
        let work = move || {
            let seen = in_pieces(&*specimen, method, effort.course(0.02, 50, PERIOD));
            let theory = beside_constraints(0.1, method);
            Finding::of(&seen, 0.02, theory, Vec::new())
        };
        Planned {
            case: CASE,
            parameter: "h halved and doubled every 50 steps".into(),
            method,
            work: Box::new(work),
        }
    };
    specimen.methods().into_iter().map(plan).collect()
}

fn in_pieces(specimen: &dyn Specimen, method: &str, course: Course) -> Observation {
    let mut whole = Observation::nothing();
    let mut state = None;
    let mut energy = 0.0;
    for piece in 0..PIECES {
        let h = if piece % 2 == 0 { course.h } else { 0.5 * course.h };
        let begun = state.as_ref().map(|state| specimen.restarted(state));
        let seen = observe(begun.as_deref().unwrap_or(specimen), method, Course { h, ..course });
        for sample in &seen.samples {
            let mut sample = *sample;
            sample.step += whole.steps;
            sample.energy += energy;
            whole.samples.push(sample);
        }
        energy = whole.samples.last().map_or(energy, |sample| sample.energy);
        whole.steps += seen.steps;
        whole.taken += seen.taken;
        whole.check.merge(&seen.check);
        whole.ending = seen.ending.clone();
        state = seen.end;
        if !matches!(whole.ending, Ending::Complete) {
            break;
        }
    }
    whole.periods = 0.75 * course.h * whole.steps as f64 / course.period;
    whole
}
