//! Statistics of quantities over the members, sample by sample, without keeping the numbers.

use super::gather::{Gather, Part, Sight};
use super::sketch::Sketch;
use crate::memory::{Memory, Recall, Record};
use crate::system::MechanicalSystem;

/// A number that is seen of every member at every sample.
pub struct Quantity<S: MechanicalSystem> {
    name: String,
    bins: Bins,
    value: Box<Value<S>>,
}

type Value<S> = dyn Fn(&Sight<'_, S>) -> f64 + Sync;

/// The bins of a histogram: equal, from `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bins {
    low: f64,
    high: f64,
    count: usize,
}

impl<S: MechanicalSystem> Quantity<S> {
    /// A quantity, without a histogram.
    pub fn new(name: impl Into<String>, value: impl Fn(&Sight<'_, S>) -> f64 + Sync + 'static) -> Self {
        let bins = Bins { low: 0.0, high: 0.0, count: 0 };
        Self { name: name.into(), bins, value: Box::new(value) }
    }

    /// Counts its values in `count` equal bins from `low` to `high`, too.
    #[must_use]
    pub fn histogram(mut self, low: f64, high: f64, count: usize) -> Self {
        self.bins = Bins { low, high, count };
        self
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }
}

/// The smallest or the largest value, and whose it is; of equal ones the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extreme {
    /// The value.
    pub value: f64,
    /// Index of the member.
    pub member: usize,
}

/// How often a value fell into each bin, below all, and above all.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Histogram {
    /// Bin by bin.
    pub bins: Vec<u64>,
    /// Below the first bin.
    pub below: u64,
    /// In or above the end of the last bin.
    pub above: u64,
}

/// What many values have in common.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    count: u64,
    not_numbers: u64,
    mean: f64,
    /// Sum of the squares of the deviations from the mean.
    squares: f64,
    smallest: Extreme,
    largest: Extreme,
    sketch: Sketch,
    range: Bins,
    histogram: Histogram,
}

impl Summary {
    fn blank(range: Bins) -> Self {
        Self {
            count: 0,
            not_numbers: 0,
            mean: 0.0,
            squares: 0.0,
            smallest: Extreme { value: f64::INFINITY, member: 0 },
            largest: Extreme { value: f64::NEG_INFINITY, member: 0 },
            sketch: Sketch::default(),
            range,
            histogram: Histogram { bins: vec![0; range.count], below: 0, above: 0 },
        }
    }

    fn add(&mut self, member: usize, x: f64) {
        if x.is_nan() {
            self.not_numbers += 1;
            return;
        }
        // Welford, Technometrics 4 (1962) 419.
        self.count += 1;
        let deviation = x - self.mean;
        self.mean += deviation / self.count as f64;
        self.squares += deviation * (x - self.mean);
        if x < self.smallest.value || self.count == 1 {
            self.smallest = Extreme { value: x, member };
        }
        if x > self.largest.value || self.count == 1 {
            self.largest = Extreme { value: x, member };
        }
        self.sketch.add(x);
        let Bins { low, high, count } = self.range;
        if count > 0 {
            let place = (x - low) / (high - low) * count as f64;
            if place < 0.0 {
                self.histogram.below += 1;
            } else if place >= count as f64 {
                self.histogram.above += 1;
            } else {
                self.histogram.bins[place as usize] += 1;
            }
        }
    }

    /// Chan, Golub, LeVeque, Amer. Statist. 37 (1983) 242.
    fn absorb(&mut self, later: Self) {
        self.not_numbers += later.not_numbers;
        if later.count == 0 {
            return;
        }
        if self.count == 0 {
            *self = Self { not_numbers: self.not_numbers, ..later };
            return;
        }
        let (ours, theirs) = (self.count as f64, later.count as f64);
        let deviation = later.mean - self.mean;
        self.count += later.count;
        self.mean += deviation * (theirs / (ours + theirs));
        self.squares += later.squares + deviation * deviation * (ours * theirs / (ours + theirs));
        if later.smallest.value < self.smallest.value {
            self.smallest = later.smallest;
        }
        if later.largest.value > self.largest.value {
            self.largest = later.largest;
        }
        self.sketch.absorb(later.sketch);
        for (bin, more) in self.histogram.bins.iter_mut().zip(&later.histogram.bins) {
            *bin += more;
        }
        self.histogram.below += later.histogram.below;
        self.histogram.above += later.histogram.above;
    }

    /// Number of values.
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// Number of values that were no numbers, and count nowhere else.
    pub const fn not_numbers(&self) -> u64 {
        self.not_numbers
    }

    /// The mean; 0 without values.
    pub const fn mean(&self) -> f64 {
        self.mean
    }

    /// The variance of the values, as a sample: the sum of squares over `count − 1`; 0 for fewer than two.
    pub fn variance(&self) -> f64 {
        if self.count < 2 { 0.0 } else { self.squares / (self.count - 1) as f64 }
    }

    /// The smallest value; `None` without values.
    pub fn smallest(&self) -> Option<Extreme> {
        (self.count > 0).then_some(self.smallest)
    }

    /// The largest value; `None` without values.
    pub fn largest(&self) -> Option<Extreme> {
        (self.count > 0).then_some(self.largest)
    }

    /// The value below which the share `p` of all lies, within 2⁻⁸ of itself; `None` without values.
    pub fn quantile(&self, p: f64) -> Option<f64> {
        let within = self.sketch.quantile(p)?;
        Some(within.clamp(self.smallest.value, self.largest.value))
    }

    /// The histogram; without bins where none was asked for.
    pub const fn histogram(&self) -> &Histogram {
        &self.histogram
    }
}

impl Memory for Summary {
    fn record(&self, words: &mut Record<'_>) {
        words.count(&self.count);
        words.count(&self.not_numbers);
        words.numbers(&[self.mean, self.squares, self.smallest.value, self.largest.value]);
        words.index(&self.smallest.member);
        words.index(&self.largest.member);
        words.part(&self.sketch);
        self.histogram.bins.iter().for_each(|bin| words.count(bin));
        words.count(&self.histogram.below);
        words.count(&self.histogram.above);
    }

    fn recall(&mut self, words: &mut Recall<'_>) {
        words.count(&mut self.count);
        words.count(&mut self.not_numbers);
        let mut numbers = [0.0; 4];
        words.numbers(&mut numbers);
        [self.mean, self.squares, self.smallest.value, self.largest.value] = numbers;
        words.index(&mut self.smallest.member);
        words.index(&mut self.largest.member);
        words.part(&mut self.sketch);
        self.histogram.bins.iter_mut().for_each(|bin| words.count(bin));
        words.count(&mut self.histogram.below);
        words.count(&mut self.histogram.above);
    }
}

/// Gathers summaries of quantities at every sample.
pub struct Summaries<S: MechanicalSystem> {
    samples: usize,
    quantities: Vec<Quantity<S>>,
}

/// Summaries per sample and quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct SummaryPart {
    quantities: usize,
    summaries: Vec<Summary>,
}

impl<S: MechanicalSystem> Summaries<S> {
    /// Of an ensemble with so many samples after the start.
    pub const fn new(samples: usize, quantities: Vec<Quantity<S>>) -> Self {
        Self { samples, quantities }
    }
}

impl SummaryPart {
    /// The summary of a quantity at a sample, both counted from 0; sample 0 is the start.
    pub fn at(&self, sample: usize, quantity: usize) -> &Summary {
        &self.summaries[sample * self.quantities + quantity]
    }
}

impl<S: MechanicalSystem> Gather<S> for Summaries<S> {
    type Part = SummaryPart;

    fn blank(&self) -> SummaryPart {
        let row = self.quantities.iter().map(|quantity| Summary::blank(quantity.bins));
        let summaries = (0..=self.samples).flat_map(|_| row.clone()).collect();
        SummaryPart { quantities: self.quantities.len(), summaries }
    }

    fn see(&self, part: &mut SummaryPart, sight: &Sight<'_, S>) {
        let row = sight.sample * part.quantities;
        for (place, quantity) in self.quantities.iter().enumerate() {
            part.summaries[row + place].add(sight.member, (quantity.value)(sight));
        }
    }
}

impl Memory for SummaryPart {
    fn record(&self, words: &mut Record<'_>) {
        self.summaries.iter().for_each(|summary| words.part(summary));
    }

    fn recall(&mut self, words: &mut Recall<'_>) {
        self.summaries.iter_mut().for_each(|summary| words.part(summary));
    }
}

impl Part for SummaryPart {
    fn absorb(&mut self, later: Self) {
        for (summary, more) in self.summaries.iter_mut().zip(later.summaries) {
            summary.absorb(more);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(values: &[f64], first: usize) -> Summary {
        let mut summary = Summary::blank(Bins { low: -1.0, high: 1.0, count: 4 });
        values.iter().enumerate().for_each(|(k, x)| summary.add(first + k, *x));
        summary
    }

    #[test]
    fn parts_add_up_to_the_whole() {
        let values: Vec<f64> = (0..1000).map(|k| (f64::from(k) * 0.7).sin() + 1e3).collect();
        let mut parts = of(&values[..300], 0);
        parts.absorb(of(&[], 300));
        parts.absorb(of(&values[300..], 300));
        let whole = of(&values, 0);
        let mean = values.iter().sum::<f64>() / 1000.0;
        let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 999.0;
        for summary in [&parts, &whole] {
            assert!((summary.mean() - mean).abs() < 1e-11, "{}", summary.mean() - mean);
            assert!((summary.variance() - variance).abs() < 1e-10 * variance);
        }
        assert_eq!(parts.largest(), whole.largest());
        assert_eq!(parts.smallest(), whole.smallest());
        assert_eq!(parts.quantile(0.3), whole.quantile(0.3));
        assert_eq!(
            whole.largest().map(|extreme| values[extreme.member]),
            whole.largest().map(|extreme| extreme.value)
        );
    }

    #[test]
    fn bins_are_half_open_and_what_is_no_number_counts_apart() {
        let summary = of(&[-1.0, -0.5, 0.2, 0.999, 1.0, -2.0, f64::NAN], 0);
        assert_eq!(summary.histogram().bins, [1, 1, 1, 1]);
        assert_eq!((summary.histogram().below, summary.histogram().above), (1, 1));
        assert_eq!((summary.count(), summary.not_numbers()), (6, 1));
    }
}
