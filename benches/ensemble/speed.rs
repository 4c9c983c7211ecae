//! Nanoseconds per trajectory and step: single runs, a kernel written by hand, lanes, and threads.

use std::error::Error;
use std::fmt::Write;
use std::time::Instant;

use evi_benches::hand_written::{HandWrittenLanes, advance_all};
use evi_core::ensemble::{ByIndex, Ensemble, LaneScheme, Summaries};
use evi_core::prelude::*;
use evi_core::scalar::LANES;
use evi_examples::{DoublePendulum, SphericalPendulum, Start};
use serde::Serialize;

use crate::family::Family;
use crate::watch::Watch;

/// A row of `ensemble.csv`.
#[derive(Clone, Serialize)]
pub(crate) struct Row {
    pub(crate) scene: &'static str,
    pub(crate) method: String,
    pub(crate) lanes: usize,
    pub(crate) threads: usize,
    pub(crate) processes: usize,
    pub(crate) trajectories: usize,
    pub(crate) ns_per_trajectory_step: f64,
    /// Over single runs on one thread.
    pub(crate) speedup: f64,
    pub(crate) max_constraint_error: f64,
}

/// Trajectories that are moved at once; twice the length of a chunk, so that two threads have one each.
const TRAJECTORIES: usize = 64;

/// Moves trajectories by so many steps.
type Take<'a> = dyn Fn(u64) -> Result<f64, Box<dyn Error>> + 'a;

/// A way to move trajectories, to be timed.
struct Way<'a> {
    method: String,
    lanes: usize,
    threads: usize,
    trajectories: usize,
    /// Moves them by so many steps, and returns the largest constraint residual seen.
    take: Box<Take<'a>>,
}

/// Steps of the midpoint rule that are timed, and of a Galerkin member.
const STEPS: u64 = 1_000;
const GALERKIN_STEPS: u64 = 50;

/// Rounds of repetitions of all families.
pub(crate) const fn rounds(quick: bool) -> usize {
    3 * repetitions(quick)
}

const fn repetitions(quick: bool) -> usize {
    if quick { 20 } else { 400 }
}

/// The rows of the families that are measured before somebody interrupts.
pub(crate) fn all(quick: bool, watch: &Watch) -> Result<Vec<Row>, Box<dyn Error>> {
    let repetitions = repetitions(quick);
    let mut rows = Vec::new();
    let mut pendulums = ways::<DoublePendulum, _>("midpoint", Evi::midpoint(0.01));
    pendulums.insert(0, by_hand());
    rows.extend(measured::<DoublePendulum>(&pendulums, STEPS, repetitions, watch)?);
    let of_high_order = ways::<DoublePendulum, _>("Galerkin 8", Galerkin::<8>::new(0.05));
    rows.extend(measured::<DoublePendulum>(&of_high_order, GALERKIN_STEPS, repetitions, watch)?);
    let spherical = ways::<SphericalPendulum, _>("midpoint", Evi::midpoint(0.01));
    rows.extend(measured::<SphericalPendulum>(&spherical, STEPS, repetitions, watch)?);
    Ok(rows)
}

/// Single runs, lanes on one thread, and lanes on two.
fn ways<S, F>(method: &str, scheme: F) -> Vec<Way<'static>>
where
    S: Family,
    F: LaneScheme<S> + Clone + Sync + 'static,
{
    let one_by_one = {
        let scheme = scheme.clone();
        move |steps| {
            let mut largest = 0.0_f64;
            for index in 0..LANES {
                let system = S::system(index);
                let (q, v) = system.start(index);
                let mut run = Simulation::new(system, scheme.clone()).start(q, v)?;
                for _ in 0..steps {
                    run.advance()?;
                }
                let residual = run.mechanics().constraint_residual(run.state());
                largest = residual.as_ref().iter().fold(largest, |largest, phi| largest.max(phi.abs()));
            }
            Ok(largest)
        }
    };
    let mut ways = vec![Way {
        method: format!("{method}, single runs"),
        lanes: 1,
        threads: 1,
        trajectories: LANES,
        take: Box::new(one_by_one),
    }];
    for threads in [1, 2] {
        const SAMPLES: usize = 10;
        let ensemble = Ensemble::new(scheme.clone()).chunks_of(TRAJECTORIES / 2).threads(threads);
        let in_lanes = move |steps| {
            let ensemble = ensemble.clone().sampled(SAMPLES, steps / SAMPLES as u64);
            let members = ByIndex::new(TRAJECTORIES, S::member);
            let gather = Summaries::new(SAMPLES, vec![S::constraint_error()]);
            let outcome = ensemble.run(&members, &gather)?;
            if let Some(failure) = outcome.failures.first() {
                return Err(failure.error.clone().into());
            }
            let largest =
                |sample| outcome.gathered.at(sample, 0).largest().map_or(f64::NAN, |extreme| extreme.value);
            Ok((0..=SAMPLES).map(largest).fold(0.0, f64::max))
        };
        ways.push(Way {
            method: method.to_owned(),
            lanes: LANES,
            threads,
            trajectories: TRAJECTORIES,
            take: Box::new(in_lanes),
        });
    }
    ways
}

/// The double pendulum's step in lanes, written for it alone.
fn by_hand() -> Way<'static> {
    const GROUPS: usize = 4;
    let take = move |steps| {
        let mut groups: Vec<_> = (0..GROUPS)
            .map(|group| {
                let index = |lane| group * LANES + lane;
                let systems = core::array::from_fn(|lane| DoublePendulum::system(index(lane)));
                let starts = core::array::from_fn(|lane: usize| {
                    let (q, v) = systems[lane].start(index(lane));
                    Start { q, v }
                });
                HandWrittenLanes::new(systems, starts, 0.01)
            })
            .collect();
        if !advance_all(&mut groups, steps) {
            return Err("a step written by hand has no end".into());
        }
        let mut largest = 0.0_f64;
        for (group, lanes) in groups.iter().enumerate() {
            for lane in 0..LANES {
                let system = DoublePendulum::system(group * LANES + lane);
                let residual =
                    evi_core::mechanics::Mechanics::new(&system).constraint_residual_at(0.0, &lanes.q(lane));
                largest = residual.iter().fold(largest, |largest, phi| largest.max(phi.abs()));
            }
        }
        Ok(largest)
    };
    Way {
        method: "midpoint, by hand".to_owned(),
        lanes: LANES,
        threads: 1,
        trajectories: GROUPS * LANES,
        take: Box::new(take),
    }
}

/// The fastest of some repetitions of every way, in turn, less the fastest without steps: starts are checked one by one, and are not counted.
/// Repetitions are short, so that some of them are not disturbed. No rows, if somebody interrupts.
fn measured<S: Family>(
    ways: &[Way<'_>],
    steps: u64,
    repetitions: usize,
    watch: &Watch,
) -> Result<Vec<Row>, Box<dyn Error>> {
    let mut fastest = vec![[f64::INFINITY; 2]; ways.len()];
    let mut errors = vec![0.0; ways.len()];
    for _ in 0..repetitions {
        if !watch.goes_on(&format!("{}, {}", S::NAME, ways[ways.len() - 1].method)) {
            return Ok(Vec::new());
        }
        for (place, way) in ways.iter().enumerate() {
            for (fastest, steps) in fastest[place].iter_mut().zip([0, steps]) {
                let start = Instant::now();
                errors[place] = (way.take)(steps)?;
                *fastest = fastest.min(start.elapsed().as_secs_f64() * 1e9);
            }
        }
    }
    let per_step = |place: usize| {
        let [without, with] = fastest[place];
        (with - without) / (ways[place].trajectories as f64 * steps as f64)
    };
    let single = ways.iter().position(|way| way.lanes == 1).map_or(f64::NAN, per_step);
    let row = |(place, way): (usize, &Way<'_>)| Row {
        scene: S::NAME,
        method: way.method.clone(),
        lanes: way.lanes,
        threads: way.threads,
        processes: 1,
        trajectories: way.trajectories,
        ns_per_trajectory_step: per_step(place),
        speedup: single / per_step(place),
        max_constraint_error: errors[place],
    };
    Ok(ways.iter().enumerate().map(row).collect())
}

/// The rows as text.
pub(crate) fn table(rows: &[Row]) -> String {
    let mut text = format!(
        "{:<22} {:<24} {:>5} {:>7} {:>9} {:>12} {:>10} {:>8} {:>9}\n",
        "scene", "method", "lanes", "threads", "processes", "trajectories", "ns/step", "speedup", "max |φ|"
    );
    for row in rows {
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{:<22} {:<24} {:>5} {:>7} {:>9} {:>12} {:>10.2} {:>8.2} {:>9.1e}",
            row.scene,
            row.method,
            row.lanes,
            row.threads,
            row.processes,
            row.trajectories,
            row.ns_per_trajectory_step,
            row.speedup,
            row.max_constraint_error
        );
    }
    text
}
