//! Quantiles of numbers that are not kept: counts in buckets of equal relative width.
//!
//! A bucket holds the floats that agree in sign, exponent and the first [`DIGITS`] binary digits, so that quantiles are off by at most
//! `2^−(DIGITS + 1)` of their value (Masson, Rim, Lee, Proc. VLDB 12 (2019) 2195, with the buckets of the float format). Counts are whole numbers:
//! sketches add up to the same one in any order.

use std::collections::BTreeMap;

use crate::memory::{Memory, Recall, Record};

/// Binary digits that a bucket keeps.
const DIGITS: u32 = 7;
const DROPPED: u32 = f64::MANTISSA_DIGITS - 1 - DIGITS;

/// Counts of numbers by bucket.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sketch(BTreeMap<i64, u64>);

/// The bits of a float in the order of the numbers; its own inverse.
const fn ordered(bits: i64) -> i64 {
    bits ^ ((bits >> 63) & i64::MAX)
}

impl Sketch {
    /// Adds a number that is no NaN.
    pub fn add(&mut self, x: f64) {
        *self.0.entry(ordered(x.to_bits() as i64) >> DROPPED).or_default() += 1;
    }

    /// Adds the numbers of another sketch.
    pub fn absorb(&mut self, other: Self) {
        for (bucket, count) in other.0 {
            *self.0.entry(bucket).or_default() += count;
        }
    }

    /// How many numbers there are.
    pub fn count(&self) -> u64 {
        self.0.values().sum()
    }

    /// The number below which the share `p` of all lies, by the nearest rank; `None` without numbers.
    pub fn quantile(&self, p: f64) -> Option<f64> {
        let rank = (p.clamp(0.0, 1.0) * self.count() as f64).ceil().max(1.0) as u64;
        let mut below = 0;
        let bucket = self.0.iter().find_map(|(bucket, count)| {
            below += count;
            (below >= rank).then_some(*bucket)
        })?;
        let at = |ordered_bits: i64| f64::from_bits(ordered(ordered_bits) as u64);
        let (first, last) = (at(bucket << DROPPED), at(((bucket + 1) << DROPPED) - 1));
        // An infinity shares its bucket with what is no number.
        Some(match (first.is_finite(), last.is_finite()) {
            (true, true) => 0.5 * first + 0.5 * last,
            _ if first.is_infinite() => first,
            _ => last,
        })
    }
}

impl Memory for Sketch {
    fn record(&self, words: &mut Record<'_>) {
        words.index(&self.0.len());
        for (bucket, count) in &self.0 {
            words.count(&(*bucket as u64));
            words.count(count);
        }
    }

    fn recall(&mut self, words: &mut Recall<'_>) {
        let mut buckets = 0;
        words.index(&mut buckets);
        self.0.clear();
        for _ in 0..buckets {
            let (mut bucket, mut count) = (0, 0);
            words.count(&mut bucket);
            words.count(&mut count);
            self.0.insert(bucket as i64, count);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of both signs over eleven decades.
    fn numbers() -> Vec<f64> {
        (0..5000_i32).map(|k| (f64::from(k) * 0.37).sin() * 10.0_f64.powi(k % 11 - 5)).collect()
    }

    #[test]
    fn quantiles_are_within_their_bound() {
        let mut numbers = numbers();
        let mut sketch = Sketch::default();
        numbers.iter().for_each(|x| sketch.add(*x));
        numbers.sort_by(f64::total_cmp);
        let mut largest = 0.0_f64;
        for k in 0..=100 {
            let p = f64::from(k) / 100.0;
            let rank = ((p * 5000.0).ceil().max(1.0)) as usize;
            let exact = numbers[rank - 1];
            let found = sketch.quantile(p).expect("numbers");
            largest = largest.max(((found - exact) / exact).abs());
        }
        assert!(largest > 1e-4 && largest <= 1.0 / 256.0, "{largest:e}");
        assert_eq!(Sketch::default().quantile(0.5), None);
    }

    #[test]
    fn sketches_add_up_in_any_order() {
        let all = numbers();
        let of = |numbers: &[f64]| {
            let mut sketch = Sketch::default();
            numbers.iter().for_each(|x| sketch.add(*x));
            sketch
        };
        let (mut forth, mut back) = (of(&all[..1234]), of(&all[1234..]));
        forth.absorb(of(&all[1234..]));
        back.absorb(of(&all[..1234]));
        assert_eq!(forth, of(&all));
        assert_eq!(back, forth);
    }

    #[test]
    fn zeros_and_infinities_have_buckets() {
        let mut sketch = Sketch::default();
        [f64::NEG_INFINITY, 0.0, f64::INFINITY].iter().for_each(|x| sketch.add(*x));
        assert_eq!(sketch.quantile(0.0), Some(f64::NEG_INFINITY));
        assert!(sketch.quantile(0.5).expect("three").abs() < f64::MIN_POSITIVE);
        assert_eq!(sketch.quantile(1.0), Some(f64::INFINITY));
    }
}
