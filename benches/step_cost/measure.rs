//! Times, instructions, corrections and constraint errors of the paths.

use std::time::Instant;

use evi_benches::program::instructions;

use crate::paths::{Observed, Path};

/// How long to measure.
#[derive(Clone, Copy)]
pub(crate) struct Effort {
    /// Steps of a timed repetition.
    timed_steps: u64,
    repetitions: usize,
    /// Steps of the shorter counted run.
    counted_steps: u64,
}

impl Effort {
    pub(crate) const FULL: Self = Self { timed_steps: 20_000, repetitions: 25, counted_steps: 2_000 };
    pub(crate) const QUICK: Self = Self { timed_steps: 500, repetitions: 5, counted_steps: 50 };
}

/// What a step of a path costs.
pub(crate) struct Cost {
    pub(crate) scene: &'static str,
    pub(crate) path: &'static str,
    pub(crate) is_standard: bool,
    /// The fastest repetition.
    pub(crate) nanoseconds: f64,
    /// The median repetition less the fastest.
    pub(crate) spread: f64,
    /// `None` where valgrind does not run.
    pub(crate) instructions: Option<f64>,
    pub(crate) observed: Observed,
}

pub(crate) fn all(paths: &[Path], effort: Effort) -> Vec<Cost> {
    let times = times(paths, effort);
    paths
        .iter()
        .zip(times)
        .enumerate()
        .map(|(index, (path, Times { fastest, median }))| Cost {
            scene: path.scene,
            path: path.name,
            is_standard: path.is_standard,
            nanoseconds: fastest,
            spread: median - fastest,
            instructions: instructions::per_step(effort.counted_steps, |steps| {
                vec!["--counted".to_owned(), index.to_string(), steps.to_string()]
            }),
            observed: (path.observe)(effort.timed_steps),
        })
        .collect()
}

/// Nanoseconds per step.
struct Times {
    fastest: f64,
    median: f64,
}

/// Repetitions that take turns, so that a slow moment of the machine hits all paths alike.
fn times(paths: &[Path], effort: Effort) -> Vec<Times> {
    let mut samples = vec![Vec::with_capacity(effort.repetitions); paths.len()];
    for _ in 0..effort.repetitions {
        for (path, samples) in paths.iter().zip(&mut samples) {
            let clock = Instant::now();
            std::hint::black_box((path.take)(effort.timed_steps));
            samples.push(1e9 * clock.elapsed().as_secs_f64() / effort.timed_steps as f64);
        }
    }
    let times = |mut samples: Vec<f64>| {
        samples.sort_by(f64::total_cmp);
        Times { fastest: samples[0], median: samples[samples.len() / 2] }
    };
    samples.into_iter().map(times).collect()
}
