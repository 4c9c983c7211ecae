//! Verdicts: what a run was, decided from what was observed of it, here and nowhere else.
//!
//! Energies are errors `H − H₀` in units of the energy that the motion exchanges, constraints are `|φ| / ‖G‖‖q‖`. In this order:
//!
//! | verdict | when |
//! |---|---|
//! | refused | the run did not start: a typed error says why |
//! | diverged | an energy error beyond [`DIVERGED`] that is [`GROWTH`] times as large in the second half of the run as in the first, a configuration [`DIVERGED`] times as long as the motion's, or numbers that are not finite |
//! | no solution | a step ended with a typed error: Newton's iteration found no end of it, or its matrix was singular |
//! | drifting | the energy has a slope outside of its interval that makes [`TREND`] of its largest error, over [`PERIODS`] periods at least; or constraints are left beyond [`LEFT`] |
//! | bounded | the energy error exceeds [`LARGE`], and none of the above |
//! | stable | all else |

use evi_core::report::Drift;
use serde::Serialize;

use crate::observation::{Ending, Observation, Sample};

/// Energy errors of so many times the energy that is exchanged are no oscillation about the truth.
pub(crate) const DIVERGED: f64 = 100.0;
/// Errors that grow by this factor from one half of a run to the other grow on.
const GROWTH: f64 = 4.0;
/// Energy errors up to this fraction of the energy that is exchanged are those of a method that resolves the motion.
pub(crate) const LARGE: f64 = 0.1;
/// Constraints that hold are within a few roundings, 1e-15; those that a method differentiates are left step by step.
pub(crate) const LEFT: f64 = 1e-11;
/// The part of the largest energy error that a trend has to explain. Of a line it is all, of an oscillation little.
const TREND: f64 = 0.5;
/// Energy errors below this are round-off of the longest runs here.
const ROUND_OFF: f64 = 1e-11;
/// Over fewer periods of the slowest motion an oscillation looks like a trend.
const PERIODS: f64 = 5.0;
/// Blocks whose means the slope is fitted through.
const BLOCKS: usize = 40;

/// What a run was, with the numbers that say so.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "verdict", rename_all = "snake_case")]
pub(crate) enum Verdict {
    /// Resolved, without a trend.
    Stable(Bounds),
    /// Energy errors as large as the motion, but no more.
    Bounded(Bounds),
    /// A quantity leaves its value and does not return.
    Drifting(Drifting),
    /// Beyond all proportion.
    Diverged(Divergence),
    /// Not begun.
    Refused { reason: String },
    /// Not continued.
    NoSolution(Unsolved),
}

/// What bounds a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Bounds {
    /// First step with an energy error beyond [`LARGE`].
    pub(crate) first_step: Option<u64>,
    /// Largest energy error.
    pub(crate) excursion: f64,
    pub(crate) slope: Option<Slope>,
}

/// A slope of the energy error per step, with half of its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Slope {
    pub(crate) per_step: f64,
    pub(crate) half_width: f64,
}

/// What drifts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Drifting {
    pub(crate) of: Drifter,
    /// First step from which on it shows.
    pub(crate) first_step: u64,
    /// Largest error of it.
    pub(crate) excursion: f64,
    pub(crate) slope: Option<Slope>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Drifter {
    Energy,
    Constraint,
}

/// How far a run went before it was given up.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Divergence {
    /// First step beyond [`DIVERGED`], or after which there was no finite one.
    pub(crate) first_step: u64,
    /// Largest energy error that was a number.
    pub(crate) excursion: f64,
}

/// The step that was not found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Unsolved {
    /// Number of the step, the first being 1.
    pub(crate) step: u64,
    /// Constraint residual at the last iterate.
    pub(crate) residual: Option<f64>,
    /// Smallest pivot ratio on the way.
    pub(crate) pivot: Option<f64>,
    pub(crate) reason: String,
    /// Largest energy error up to there.
    pub(crate) excursion: f64,
}

/// A verdict without its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Kind {
    Stable,
    Bounded,
    Drifting,
    Diverged,
    Refused,
    NoSolution,
}

impl Kind {
    /// Everything but [`Stable`](Self::Stable): what theory says of steps beyond a limit, where the motion is not linear.
    pub(crate) const NOT_STABLE: &'static [Self] =
        &[Self::Bounded, Self::Drifting, Self::Diverged, Self::NoSolution];
    /// Verdicts on methods that keep the energy near its value.
    pub(crate) const KEPT: &'static [Self] = &[Self::Stable, Self::Bounded];

    /// As in tables and files.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Stable => "stable",
            Self::Bounded => "bounded",
            Self::Drifting => "drifting",
            Self::Diverged => "diverged",
            Self::Refused => "refused",
            Self::NoSolution => "no solution",
        }
    }
}

impl Verdict {
    pub(crate) const fn kind(&self) -> Kind {
        match self {
            Self::Stable(_) => Kind::Stable,
            Self::Bounded(_) => Kind::Bounded,
            Self::Drifting(_) => Kind::Drifting,
            Self::Diverged(_) => Kind::Diverged,
            Self::Refused { .. } => Kind::Refused,
            Self::NoSolution(_) => Kind::NoSolution,
        }
    }

    /// The first step at which it shows.
    pub(crate) const fn first_step(&self) -> Option<u64> {
        match self {
            Self::Stable(bounds) | Self::Bounded(bounds) => bounds.first_step,
            Self::Drifting(drifting) => Some(drifting.first_step),
            Self::Diverged(divergence) => Some(divergence.first_step),
            Self::Refused { .. } => None,
            Self::NoSolution(unsolved) => Some(unsolved.step),
        }
    }

    /// Largest energy error of the run; of a drifting constraint, its.
    pub(crate) const fn excursion(&self) -> Option<f64> {
        match self {
            Self::Stable(bounds) | Self::Bounded(bounds) => Some(bounds.excursion),
            Self::Drifting(drifting) => Some(drifting.excursion),
            Self::Diverged(divergence) => Some(divergence.excursion),
            Self::Refused { .. } => None,
            Self::NoSolution(unsolved) => Some(unsolved.excursion),
        }
    }

    pub(crate) const fn slope(&self) -> Option<Slope> {
        match self {
            Self::Stable(bounds) | Self::Bounded(bounds) => bounds.slope,
            Self::Drifting(drifting) => drifting.slope,
            _ => None,
        }
    }

    /// Why there was no run, or no further step.
    pub(crate) fn reason(&self) -> Option<&str> {
        match self {
            Self::Refused { reason } | Self::NoSolution(Unsolved { reason, .. }) => Some(reason),
            _ => None,
        }
    }
}

/// The verdict on a run.
pub(crate) fn on(observation: &Observation) -> Verdict {
    if let Ending::NotStarted { reason } = &observation.ending {
        return Verdict::Refused { reason: reason.clone() };
    }
    let samples = &observation.samples;
    let excursion = largest(samples.iter().map(|sample| sample.energy.abs()));
    if let Some(first_step) = first_divergent(observation) {
        return Verdict::Diverged(Divergence { first_step, excursion });
    }
    if let Ending::Failed { step, residual, pivot, reason } = &observation.ending {
        let (step, residual, pivot, reason) = (*step, *residual, *pivot, reason.clone());
        return Verdict::NoSolution(Unsolved { step, residual, pivot, reason, excursion });
    }
    let slope = slope(observation);
    if let Some(trend) = slope.filter(|slope| is_trend(slope, observation, excursion)) {
        let first_step = shows_from(samples, excursion);
        return Verdict::Drifting(Drifting {
            of: Drifter::Energy,
            first_step,
            excursion,
            slope: Some(trend),
        });
    }
    if let Some(first) = samples.iter().find(|sample| sample.constraint > LEFT) {
        let excursion = largest(samples.iter().map(|sample| sample.constraint));
        return Verdict::Drifting(Drifting {
            of: Drifter::Constraint,
            first_step: first.step,
            excursion,
            slope,
        });
    }
    let first_step = samples.iter().find(|sample| sample.energy.abs() > LARGE).map(|sample| sample.step);
    let bounds = Bounds { first_step, excursion, slope };
    if first_step.is_some() { Verdict::Bounded(bounds) } else { Verdict::Stable(bounds) }
}

fn first_divergent(observation: &Observation) -> Option<u64> {
    let samples = &observation.samples;
    // Written so that a NaN is beyond.
    let is_within = |sample: &Sample| {
        sample.energy.abs() < f64::INFINITY && sample.size <= DIVERGED * observation.largest_size
    };
    let (first, second) = samples.split_at(samples.len() / 2);
    let [first, second] = [first, second].map(|half| largest(half.iter().map(|sample| sample.energy.abs())));
    let grows = second > DIVERGED && second > GROWTH * first;
    let is_beyond = |sample: &Sample| !is_within(sample) || (grows && sample.energy.abs() > DIVERGED);
    samples.iter().find(|sample| is_beyond(sample)).map(|sample| sample.step).or(match observation.ending {
        Ending::NotFinite { step } => Some(step),
        _ => None,
    })
}

fn slope(observation: &Observation) -> Option<Slope> {
    let per_sample = observation.steps_per_sample as f64;
    let energies: Vec<f64> = observation.samples.iter().map(|sample| sample.energy).collect();
    let drift = Drift::of(&energies, BLOCKS)?;
    let slope = Slope { per_step: drift.slope / per_sample, half_width: drift.half_width / per_sample };
    (slope.per_step.is_finite() && slope.half_width.is_finite()).then_some(slope)
}

fn is_trend(slope: &Slope, observation: &Observation, excursion: f64) -> bool {
    let over_the_run = slope.per_step.abs() * observation.steps as f64;
    observation.periods >= PERIODS
        && excursion > ROUND_OFF
        && slope.per_step.abs() > slope.half_width
        && over_the_run >= TREND * excursion
}

/// The step from which on errors stay beyond a fifth of the largest.
fn shows_from(samples: &[Sample], excursion: f64) -> u64 {
    let below = samples.iter().rposition(|sample| sample.energy.abs() < 0.2 * excursion);
    samples.get(below.map_or(0, |last| last + 1)).or(samples.last()).map_or(0, |sample| sample.step)
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.filter(|value| value.is_finite()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A run of 2,000 steps over 20 periods with these energy errors and constraint residuals.
    fn run(energy: impl Fn(f64) -> f64, constraint: impl Fn(f64) -> f64) -> Observation {
        let sample = |k: u64| Sample {
            step: k,
            energy: energy(k as f64),
            constraint: constraint(k as f64),
            ..Sample::at_rest()
        };
        let samples = (1..=2000).map(sample).collect();
        Observation { samples, steps: 2000, periods: 20.0, ..Observation::nothing() }
    }

    fn wave(k: f64) -> f64 {
        (0.063 * k).sin()
    }

    #[test]
    fn a_small_oscillation_is_stable_and_a_large_one_bounded() {
        let small = on(&run(|k| 1e-3 * wave(k), |_| 1e-16));
        assert_eq!((small.kind(), small.first_step()), (Kind::Stable, None));
        let large = on(&run(|k| 0.5 * wave(k), |_| 1e-16));
        assert_eq!((large.kind(), large.first_step()), (Kind::Bounded, Some(4)));
        assert!(large.excursion().is_some_and(|excursion| (excursion - 0.5).abs() < 1e-3));
    }

    #[test]
    fn a_trend_drifts_but_not_below_round_off_nor_within_few_periods() {
        let drifting = run(|k| 1e-5 * k + 1e-3 * wave(k), |_| 0.0);
        let Verdict::Drifting(Drifting { of: Drifter::Energy, slope: Some(slope), first_step, .. }) =
            on(&drifting)
        else {
            panic!("{:?}", on(&drifting));
        };
        assert!((slope.per_step - 1e-5).abs() <= slope.half_width, "{slope:?}");
        assert!((300..600).contains(&first_step), "{first_step}");
        let round_off = run(|k| 1e-16 * k, |_| 0.0);
        assert_eq!(on(&round_off).kind(), Kind::Stable);
        let short = Observation { periods: 0.3, ..drifting };
        assert_eq!(on(&short).kind(), Kind::Stable);
    }

    #[test]
    fn energies_that_are_large_from_the_start_and_stay_so_are_bounded() {
        let large = run(|k| 400.0 * wave(k).abs(), |_| 0.0);
        assert_eq!((on(&large).kind(), on(&large).first_step()), (Kind::Bounded, Some(1)));
    }

    #[test]
    fn constraints_that_are_left_drift() {
        let verdict = on(&run(|_| 0.0, |k| 1e-14 * k));
        let Verdict::Drifting(Drifting { of: Drifter::Constraint, first_step, .. }) = verdict else {
            panic!("{verdict:?}");
        };
        assert_eq!(first_step, 1001);
    }

    #[test]
    fn what_grows_without_bound_diverges_also_where_it_ends_without_a_solution() {
        let growing = run(|k| 1e-6 * (0.02 * k).exp(), |_| 0.0);
        let ending = Ending::Failed { step: 2001, residual: None, pivot: None, reason: "none".into() };
        for observation in [Observation { ending, ..growing.clone() }, growing] {
            // 50 ln 1e8
            assert_eq!((on(&observation).kind(), on(&observation).first_step()), (Kind::Diverged, Some(922)));
        }
        let not_a_number = run(|k| if k < 7.0 { 0.0 } else { f64::NAN }, |_| 0.0);
        assert_eq!((on(&not_a_number).kind(), on(&not_a_number).first_step()), (Kind::Diverged, Some(7)));
        let not_finite = Observation { ending: Ending::NotFinite { step: 9 }, ..Observation::nothing() };
        assert_eq!((on(&not_finite).kind(), on(&not_finite).first_step()), (Kind::Diverged, Some(9)));
    }

    #[test]
    fn typed_errors_keep_their_numbers() {
        let ending = Ending::NotStarted { reason: "the step size is 0".into() };
        let refused = on(&Observation { ending, ..Observation::nothing() });
        assert_eq!((refused.kind(), refused.reason()), (Kind::Refused, Some("the step size is 0")));
        let ending =
            Ending::Failed { step: 66, residual: Some(0.08), pivot: Some(0.3), reason: "no end".into() };
        let unsolved = on(&Observation { ending, ..run(|_| 0.2, |_| 0.0) });
        assert_eq!((unsolved.kind(), unsolved.first_step()), (Kind::NoSolution, Some(66)));
        assert_eq!(unsolved.reason(), Some("no end"));
    }
}
