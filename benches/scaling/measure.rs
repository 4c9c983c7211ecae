//! What a step costs, scene by scene and method by method.

use std::time::Instant;

use evi_benches::program::instructions;
use indicatif::ProgressBar;
use serde::Serialize;

use crate::specimen::Row;

/// How long to measure.
#[derive(Clone, Copy)]
pub(crate) struct Effort {
    /// Of the steps of a row, the first `1/share` are taken.
    share: u64,
    repetitions: usize,
    /// Whether instructions are counted for all rows, or for chains of 20 and 1,000 links only.
    counts_all: bool,
}

impl Effort {
    pub(crate) const FULL: Self = Self { share: 1, repetitions: 9, counts_all: true };
    pub(crate) const QUICK: Self = Self { share: 5, repetitions: 3, counts_all: false };

    fn steps(self, row: &Row) -> u64 {
        row.steps / self.share
    }

    /// Steps of the shorter counted run, few of large scenes: counting slows a program down fifty times.
    fn counted_steps(self, row: &Row) -> u64 {
        (self.steps(row) / 3).min(10_000 / row.bodies as u64 + 3)
    }

    fn counts(self, row: &Row) -> bool {
        self.counts_all || row.scene == "chain" && matches!(row.bodies, 20 | 100)
    }
}

/// A row of `scaling.csv`; cells that were not measured are empty.
#[derive(Serialize)]
pub(crate) struct Cost {
    pub(crate) scene: &'static str,
    pub(crate) bodies: usize,
    pub(crate) method: &'static str,
    /// Of the fastest repetition.
    pub(crate) ns_per_step: Option<f64>,
    pub(crate) ns_per_body: Option<f64>,
    pub(crate) instructions_per_step: Option<f64>,
    /// Corrections of a step: of multipliers and positions, or passes.
    pub(crate) newton_iterations: Option<f64>,
    /// The largest after every step.
    pub(crate) max_constraint_error: Option<f64>,
    /// Why there are no numbers.
    #[serde(skip)]
    pub(crate) failure: Option<String>,
}

/// Repetitions take turns, so that a slow moment of the machine hits all rows of a scene alike.
pub(crate) fn costs(
    rows: &[Row],
    effort: Effort,
    bar: &ProgressBar,
    is_over: impl Fn() -> bool,
) -> Vec<Cost> {
    let mut costs = Vec::with_capacity(rows.len());
    let mut index = 0;
    for scene in rows.chunk_by(|a, b| (a.scene, a.bodies) == (b.scene, b.bodies)) {
        if is_over() {
            break;
        }
        bar.set_message(format!("{} of {}", scene[0].scene, scene[0].bodies));
        let mut fastest = vec![Ok(f64::INFINITY); scene.len()];
        for _ in 0..effort.repetitions {
            for (row, fastest) in scene.iter().zip(&mut fastest) {
                *fastest =
                    std::mem::replace(fastest, Ok(0.0)).and_then(|best| Ok(best.min(time(row, effort)?)));
            }
        }
        for (row, fastest) in scene.iter().zip(fastest) {
            costs.push(cost(row, index, fastest, effort));
            index += 1;
            bar.inc(1);
        }
    }
    costs
}

/// Nanoseconds per step.
fn time(row: &Row, effort: Effort) -> Result<f64, String> {
    let steps = effort.steps(row);
    let mut run = row.start()?;
    let clock = Instant::now();
    run.take(steps).map_err(|error| error.to_string())?;
    Ok(1e9 * clock.elapsed().as_secs_f64() / steps as f64)
}

fn cost(row: &Row, index: usize, nanoseconds: Result<f64, String>, effort: Effort) -> Cost {
    let Row { scene, bodies, method, .. } = *row;
    let observed = nanoseconds.as_ref().ok().and_then(|_| observe(row, effort).ok());
    let counted = observed.filter(|_| effort.counts(row)).and_then(|_| {
        instructions::per_step(effort.counted_steps(row), |steps| {
            vec!["--counted".to_owned(), index.to_string(), steps.to_string()]
        })
    });
    Cost {
        scene,
        bodies,
        method,
        ns_per_step: nanoseconds.as_ref().ok().copied(),
        ns_per_body: nanoseconds.as_ref().ok().map(|ns| ns / bodies as f64),
        instructions_per_step: counted,
        newton_iterations: observed.map(|(iterations, _)| iterations),
        max_constraint_error: observed.map(|(_, error)| error),
        failure: nanoseconds.err(),
    }
}

/// Corrections per step, and the largest `|φ|`.
fn observe(row: &Row, effort: Effort) -> Result<(f64, f64), String> {
    let mut run = row.start()?;
    let mut error = run.constraint_error();
    for _ in 0..effort.steps(row) {
        run.take(1).map_err(|error| error.to_string())?;
        error = error.max(run.constraint_error());
    }
    Ok((run.corrections() as f64 / run.steps() as f64, error))
}
