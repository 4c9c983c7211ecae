//! Error against run time of hanging chains: the project's members beside solvers of other projects, in one run.

use std::time::Instant;

use evi_benches::external::{dop853_chain_20, mujoco_chain};
use evi_core::assembled::AssembledSystem;
use evi_core::prelude::*;
use evi_examples::{Chain20, GRAVITY, Scene};
use serde::Serialize;

use crate::scenes::chain::{links_20, links_100};
use crate::specimen::{Row, Specimen};

/// A row of `time_to_solution.csv`.
#[derive(Serialize)]
pub(crate) struct Solution {
    pub(crate) bodies: usize,
    pub(crate) t: f64,
    pub(crate) method: &'static str,
    pub(crate) steps: u64,
    /// Euclidean distance of all places from those of the finest solution.
    pub(crate) position_error: f64,
    /// From the prepared start to the end; the shortest of the repetitions.
    pub(crate) microseconds: f64,
}

/// Solutions of one chain at one time.
pub(crate) struct Comparison {
    pub(crate) title: String,
    pub(crate) solutions: Vec<Solution>,
    /// What could not be run, and why.
    pub(crate) missing: Vec<String>,
}

/// The sizes and times at which solutions are compared.
pub(crate) fn all(repetitions: u32) -> Result<Vec<Comparison>, String> {
    Ok(vec![
        compare(&links_20::specimen(), 0.5, Some(&Chain20::reference().q), repetitions)?,
        compare(&links_20::specimen(), 2.0, None, repetitions)?,
        compare(&links_100::specimen(), 0.5, None, repetitions)?,
    ])
}

/// From the horizontal to `t`; errors against certified digits, or else against the finest run of the member of order 16.
fn compare<S: AssembledSystem + Clone + 'static>(
    specimen: &Specimen<S>,
    t: f64,
    certified: Option<&[f64]>,
    repetitions: u32,
) -> Result<Comparison, String> {
    let bodies = specimen.bodies;
    // Steps that resolve the swing of a rod.
    let coarsest = (t * 40.0 * (bodies as f64 / 20.0).sqrt()).ceil() as u64;
    let finest = specimen.row("galerkin_8", 0.0, Galerkin::<8>::new(t / (64 * coarsest) as f64));
    let reference = match certified {
        Some(q) => q.to_vec(),
        None => solve(&finest, t, 1)?.0,
    };
    let mut comparison = Comparison {
        title: format!(
            "Chain of {bodies} links from the horizontal to t = {t} s; errors against {}",
            if certified.is_some() {
                "certified digits"
            } else {
                "galerkin_8 with 64 times the fewest steps"
            }
        ),
        solutions: Vec::new(),
        missing: Vec::new(),
    };
    let mut add = |method, steps, q: &[f64], microseconds| {
        let position_error = distance(q, &reference);
        comparison.solutions.push(Solution { bodies, t, method, steps, position_error, microseconds });
    };
    let member = |method, h| match method {
        "midpoint" => specimen.row(method, 0.0, Evi::midpoint(h)),
        "midpoint_4" => specimen.row(method, 0.0, Evi::midpoint(h).composed(Composition::suzuki_4())),
        "midpoint_6" => specimen.row(method, 0.0, Evi::midpoint(h).composed(Composition::kahan_li_6())),
        _ => specimen.row(method, 0.0, Galerkin::<8>::new(h)),
    };
    // With the numbers of steps that each needs.
    for (method, first, count) in
        [("midpoint", 16, 6), ("midpoint_4", 4, 6), ("midpoint_6", 4, 5), ("galerkin_8", 1, 5)]
    {
        for steps in doubled(first * coarsest, count) {
            match solve(&member(method, t / steps as f64), t, repetitions) {
                Ok((q, microseconds)) => add(method, steps, &q, microseconds),
                Err(failure) => comparison.missing.push(format!("{method} in {steps} steps: {failure}")),
            }
        }
    }
    let steps: Vec<u64> = doubled(8 * coarsest, 6).collect();
    match mujoco_chain(bodies, GRAVITY, t, &steps, repetitions.min(3)) {
        Ok(rows) => rows.iter().for_each(|row| add("MuJoCo RK4", row.steps, &row.q, row.microseconds)),
        Err(error) => comparison.missing.push(error.to_string()),
    }
    if bodies == 20 {
        for tolerance in [1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13] {
            match dop853_chain_20(GRAVITY, t, tolerance, repetitions) {
                Ok(row) => add("DOP853 in angles", row.steps, &row.q, row.microseconds),
                Err(error) => comparison.missing.push(format!("DOP853 at {tolerance:e}: {error}")),
            }
        }
    }
    Ok(comparison)
}

/// Numbers of steps, each twice the one before.
fn doubled(first: u64, count: u32) -> impl Iterator<Item = u64> {
    (0..count).map(move |k| first << k)
}

/// Places at `t`, and the microseconds that they take.
fn solve(row: &Row, t: f64, repetitions: u32) -> Result<(Vec<f64>, f64), String> {
    let mut shortest = f64::INFINITY;
    let mut q = Vec::new();
    for _ in 0..repetitions.max(1) {
        let mut run = row.start()?;
        let clock = Instant::now();
        run.advance_to(t).map_err(|error| error.to_string())?;
        shortest = shortest.min(1e6 * clock.elapsed().as_secs_f64());
        q = run.q().to_vec();
    }
    Ok((q, shortest))
}

fn distance(q: &[f64], reference: &[f64]) -> f64 {
    q.iter().zip(reference).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
