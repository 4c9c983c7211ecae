//! Whether the energy of a run drifts, estimated while it runs.

use core::convert::Infallible;
use core::ops::ControlFlow;

use super::{Observer, Watched};
use crate::report::Drift;

/// Means of the energy over blocks of equal length, of a run of any length in storage of one size: where all blocks are full, neighbours become
/// one, and blocks are twice as long from there on.
///
/// [`drift`](Self::drift) fits a line through them, with an interval that allows for the correlation of blocks. It says whether the energy drifts
/// where the motion is regular, and over many periods of its slowest motion; chaotic motions change their energy by diffusion, which is no line.
///
/// ```
/// use evi_core::prelude::*;
/// use evi_core::watch::EnergyDrift;
/// # #[derive(MechanicalSystem)]
/// # #[evi(coordinates(theta), kinetic = 0.5 * der(theta).powi(2), potential = -rate.powi(2) * theta.cos())]
/// # struct Pendulum { rate: f64 }
/// let mut run = Simulation::new(Pendulum { rate: 3.0 }, Evi::midpoint(0.05)).start([1.0], [0.0])?;
/// let mut energy = EnergyDrift::of(&run);
/// run.advance_observed(500.0, &mut energy)?;
/// let drift = energy.drift().expect("long enough");
/// assert!(drift.is_indistinguishable_from_zero());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct EnergyDrift {
    /// Changes since here are averaged: small numbers lose no digits.
    start_energy: f64,
    means: [f64; Self::MOST_BLOCKS],
    /// How many of them are known.
    blocks: usize,
    /// Steps per block.
    length: u64,
    /// Of the steps that do not fill a block yet.
    sum: f64,
    steps: u64,
    largest_change: f64,
}

impl EnergyDrift {
    /// Blocks are joined at so many, so that from half as many steps on there are always at least half as many blocks.
    pub const MOST_BLOCKS: usize = 128;

    /// Nothing seen yet, of a run from where it stands.
    pub fn of<R: Watched>(run: &R) -> Self {
        Self {
            start_energy: run.total_energy(),
            means: [0.0; Self::MOST_BLOCKS],
            blocks: 0,
            length: 1,
            sum: 0.0,
            steps: 0,
            largest_change: 0.0,
        }
    }

    /// The trend of the energy per step, with its interval; `None` before the eighth step.
    pub fn drift(&self) -> Option<Drift> {
        Drift::of_block_means(&self.means[..self.blocks], self.length as f64)
    }

    /// Largest `|H − H₀|` seen; NaN if one was.
    pub const fn largest_change(&self) -> f64 {
        self.largest_change
    }

    fn add(&mut self, change: f64) {
        // Written so that a NaN stays.
        let is_smaller = change.abs() <= self.largest_change;
        if !is_smaller && !self.largest_change.is_nan() {
            self.largest_change = change.abs();
        }
        self.sum += change;
        self.steps += 1;
        if self.steps < self.length {
            return;
        }
        if self.blocks == Self::MOST_BLOCKS {
            self.join();
            if self.steps < self.length {
                return;
            }
        }
        self.means[self.blocks] = self.sum / self.length as f64;
        self.blocks += 1;
        (self.sum, self.steps) = (0.0, 0);
    }

    /// Joins neighbours.
    fn join(&mut self) {
        self.blocks /= 2;
        for k in 0..self.blocks {
            self.means[k] = 0.5 * (self.means[2 * k] + self.means[2 * k + 1]);
        }
        self.length *= 2;
    }
}

impl<R: Watched> Observer<R> for EnergyDrift {
    type Reason = Infallible;

    #[inline]
    fn see(&mut self, run: &R) -> ControlFlow<Infallible> {
        self.add(run.total_energy() - self.start_energy);
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nothing_seen() -> EnergyDrift {
        EnergyDrift {
            start_energy: 0.0,
            means: [0.0; EnergyDrift::MOST_BLOCKS],
            blocks: 0,
            length: 1,
            sum: 0.0,
            steps: 0,
            largest_change: 0.0,
        }
    }

    fn oscillation(k: usize) -> f64 {
        1e-6 * (0.037 * k as f64).sin() + 1e-12 * k as f64
    }

    #[test]
    fn blocks_are_those_of_the_whole_series() {
        for steps in [7, 8, 127, 128, 129, 255, 256, 257, 5_000, 100_003] {
            let samples: Vec<f64> = (0..steps).map(oscillation).collect();
            let mut energy = nothing_seen();
            samples.iter().for_each(|sample| energy.add(*sample));
            let EnergyDrift { blocks, length, .. } = energy;
            if steps < 8 {
                assert_eq!(energy.drift(), None);
                continue;
            }
            // All samples but those of the last block, which is not full.
            assert_eq!(blocks, steps / length as usize, "{steps} steps");
            assert!(steps < 128 || (64..=128).contains(&blocks), "{steps} steps");
            let expected = Drift::of(&samples[..blocks * length as usize], blocks).unwrap();
            let drift = energy.drift().unwrap();
            // Means of pairs of means are rounded otherwise than sums.
            let error =
                (drift.slope - expected.slope).abs().max((drift.half_width - expected.half_width).abs());
            assert!(error <= 1e-9 * expected.slope.abs(), "{steps} steps: {drift:?}, {expected:?}");
        }
    }

    #[test]
    fn a_change_that_is_not_a_number_is_the_largest() {
        let mut energy = nothing_seen();
        [1.0, f64::NAN, 2.0].into_iter().for_each(|change| energy.add(change));
        assert!(energy.largest_change().is_nan());
    }
}
