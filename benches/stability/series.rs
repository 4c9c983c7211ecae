//! A long run from its start to its end, in as few numbers as a figure shows.

use serde::Serialize;

use crate::observation::{Observation, Sample};

/// Points of a curve: more than a figure resolves.
const POINTS: usize = 250;

/// Largest magnitudes over equal stretches of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Series {
    /// Last step of every stretch.
    steps: Vec<u64>,
    /// `|H − H₀|`, in units of the energy that the motion exchanges.
    energy: Vec<f64>,
    /// `|φ| / ‖G‖‖q‖`.
    constraint: Vec<f64>,
    /// `|G v|` relative to its terms.
    hidden_constraint: Vec<f64>,
    /// Change of a conserved momentum, relative to `‖q‖ ‖p‖`; zero where there is none.
    momentum: Vec<f64>,
}

impl Series {
    pub(crate) fn of(observation: &Observation) -> Self {
        let samples = &observation.samples;
        let stretch = samples.len().div_ceil(POINTS).max(1);
        let largest = |quantity: fn(&Sample) -> f64| {
            let of_stretch =
                |samples: &[Sample]| samples.iter().map(|sample| quantity(sample).abs()).fold(0.0, larger);
            samples.chunks(stretch).map(of_stretch).collect()
        };
        Self {
            steps: samples.chunks(stretch).filter_map(<[Sample]>::last).map(|sample| sample.step).collect(),
            energy: largest(|sample| sample.energy),
            constraint: largest(|sample| sample.constraint),
            hidden_constraint: largest(|sample| sample.hidden),
            momentum: largest(|sample| sample.momentum),
        }
    }
}

/// The larger of two magnitudes; NaN if one is.
fn larger(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stretch_shows_its_largest_magnitude_and_a_number_that_is_none() {
        let mut seen = Observation::nothing();
        seen.samples = (1..=1000).map(|step| Sample { step, ..Sample::at_rest() }).collect();
        seen.samples[5].energy = -3.0;
        seen.samples[999].constraint = f64::NAN;
        let series = Series::of(&seen);
        assert_eq!((series.steps.len(), series.steps[1], series.steps[249]), (POINTS, 8, 1000));
        assert_eq!(series.energy[..3], [0.0, 3.0, 0.0]);
        assert!(series.constraint[249].is_nan() && series.constraint[248] == 0.0);
        assert!(Series::of(&Observation::nothing()).steps.is_empty());
    }
}
