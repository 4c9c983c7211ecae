//! Error and run time of one method on one scene at one step size or tolerance.

use std::time::Instant;

use evi_core::comparison::{Failure, Solver};

use super::scenes::{AnyScene, Deviation};

/// How long to measure a run.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Fewest timed samples, unless a single run takes longer than all of them should.
    pub samples: usize,
    /// A sample is the mean of so many runs that it takes this long, in seconds.
    pub sample_seconds: f64,
    /// The samples together take no longer than this, in seconds, beyond the first run.
    pub seconds: f64,
}

/// A run that reached the horizon.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// Median of the samples of the time from the prepared start to the horizon, in seconds.
    pub seconds: f64,
    /// Distance between the quartiles of the samples; `None` of a single sample.
    pub seconds_spread: Option<f64>,
    /// Number of steps.
    pub steps: u64,
    /// `‖q − q*‖` at the horizon.
    pub position_error: f64,
    /// Largest deviations at a step. Where energy is not conserved, its deviation from the reference at the horizon.
    pub deviation: Deviation,
}

/// Runs to the horizon: once to look at every step, and several times for the clock. Preparation is not in the time.
///
/// # Errors
/// Why the method does not start, or which step it could not take.
pub fn measure(
    scene: &dyn AnyScene,
    method: usize,
    resolution: f64,
    effort: Effort,
) -> Result<Outcome, Failure> {
    let horizon = scene.facts().horizon;
    let mut solver = scene.start(method, resolution)?;
    let mut deviation = Deviation::default();
    solver.advance_visiting(horizon, &mut |solver| {
        deviation = deviation.or_larger(scene.deviation(solver));
    })?;
    let distance = scene.distance_from_reference(&*solver);
    deviation.energy = deviation.energy.or(Some(distance.energy));
    let steps = solver.steps();
    let mut seconds = || -> Result<f64, Failure> {
        let mut solver = scene.start(method, resolution)?;
        let clock = Instant::now();
        solver.advance_to(horizon)?;
        Ok(clock.elapsed().as_secs_f64())
    };
    let Samples { median, spread } = sample(&mut seconds, effort)?;
    Ok(Outcome {
        seconds: median,
        seconds_spread: spread,
        steps,
        position_error: distance.position,
        deviation,
    })
}

struct Samples {
    median: f64,
    spread: Option<f64>,
}

/// Repeats `run`, which returns the seconds that it took.
fn sample(run: &mut impl FnMut() -> Result<f64, Failure>, effort: Effort) -> Result<Samples, Failure> {
    let first = run()?;
    let runs_per_sample = (effort.sample_seconds / first).ceil().clamp(1.0, 1e4) as u32;
    let sample = runs_per_sample as f64 * first;
    if effort.samples as f64 * sample > effort.seconds && first > effort.seconds {
        return Ok(Samples { median: first, spread: None });
    }
    let count = ((effort.seconds / sample) as usize).clamp(effort.samples, 5 * effort.samples);
    let mut samples = Vec::with_capacity(count);
    for _ in 0..count {
        let mut total = 0.0;
        for _ in 0..runs_per_sample {
            total += run()?;
        }
        samples.push(total / f64::from(runs_per_sample));
    }
    samples.sort_by(f64::total_cmp);
    let quantile = |fraction: f64| samples[(fraction * (count - 1) as f64).round() as usize];
    Ok(Samples { median: quantile(0.5), spread: Some(quantile(0.75) - quantile(0.25)) })
}

/// Largest energy error in each of equal windows of a long run.
#[derive(Clone, Debug)]
pub struct LongRun {
    /// End of each window.
    pub times: Vec<f64>,
    /// Largest `|H − H₀|` in it.
    pub energy_errors: Vec<f64>,
    /// Why the run ended early.
    pub failure: Option<String>,
}

/// Runs for `duration` and looks at the energy of every step.
///
/// # Errors
/// Why the method does not start.
pub fn long_run(
    scene: &dyn AnyScene,
    method: usize,
    resolution: f64,
    duration: f64,
    windows: usize,
) -> Result<LongRun, Failure> {
    let mut solver = scene.start(method, resolution)?;
    let mut long = LongRun { times: Vec::new(), energy_errors: Vec::new(), failure: None };
    for window in 1..=windows {
        let end = duration * window as f64 / windows as f64;
        let mut largest = 0.0_f64;
        let mut look = |solver: &dyn Solver| {
            largest = largest.max(scene.deviation(solver).energy.unwrap_or(f64::NAN));
        };
        if let Err(failure) = solver.advance_visiting(end, &mut look) {
            long.failure = Some(failure.to_string());
            break;
        }
        long.times.push(end);
        long.energy_errors.push(largest);
    }
    Ok(long)
}
