//! Whether a conserved quantity drifts.
//!
//! In: a time series of the quantity. Out: the slope of a straight line through its block means, with an interval
//! that allows for the correlation of neighbouring blocks.

/// A linear trend with its 95 % confidence interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// Least-squares slope per sample.
    pub slope: f64,
    /// Half-width of the 95 % interval of the slope.
    pub half_width: f64,
}

impl Drift {
    /// The trend of `samples` through the means of `blocks` blocks of equal length; samples that do not fill a
    /// block are left out. `None` for fewer than eight blocks or fewer samples than blocks.
    pub fn of(samples: &[f64], blocks: usize) -> Option<Self> {
        let length = samples.len().checked_div(blocks)?;
        if length == 0 {
            return None;
        }
        let means: Vec<f64> = samples
            .chunks_exact(length)
            .take(blocks)
            .map(|block| block.iter().sum::<f64>() / length as f64)
            .collect();
        Self::of_block_means(&means, length as f64)
    }

    /// The trend through the means of consecutive blocks of `length` samples each. `None` for fewer than eight.
    ///
    /// The variance of the slope is the Newey-West estimate (Econometrica 55 (1987) 703) with the Bartlett kernel
    /// over `4 (blocks/100)^{2/9}` lags: residuals of an oscillating energy are correlated between blocks, and an
    /// interval for independent residuals would be too narrow or too wide.
    pub fn of_block_means(means: &[f64], length: f64) -> Option<Self> {
        const FEWEST_BLOCKS: usize = 8;
        /// 97.5 % quantile of the normal distribution.
        const QUANTILE: f64 = 1.96;
        let blocks = means.len();
        if blocks < FEWEST_BLOCKS {
            return None;
        }
        let centre = (blocks - 1) as f64 / 2.0;
        let average = means.iter().sum::<f64>() / blocks as f64;
        let abscissa = |block: usize| block as f64 - centre;
        let spread: f64 = (0..blocks).map(|block| abscissa(block).powi(2)).sum();
        let slope =
            means.iter().enumerate().map(|(block, mean)| abscissa(block) * (mean - average)).sum::<f64>()
                / spread;
        let scores: Vec<f64> = means
            .iter()
            .enumerate()
            .map(|(block, mean)| abscissa(block) * (mean - average - slope * abscissa(block)))
            .collect();
        let lags = (4.0 * (blocks as f64 / 100.0).powf(2.0 / 9.0)).floor() as usize;
        let covariance = |lag: usize| -> f64 { scores.iter().zip(&scores[lag..]).map(|(a, b)| a * b).sum() };
        let variance = covariance(0)
            + 2.0
                * (1..=lags).map(|lag| (1.0 - lag as f64 / (lags + 1) as f64) * covariance(lag)).sum::<f64>();
        let standard_error = variance.max(0.0).sqrt() / spread;
        let per_sample = 1.0 / length;
        Some(Self { slope: slope * per_sample, half_width: QUANTILE * standard_error * per_sample })
    }

    /// Whether a slope of zero lies in the interval.
    pub fn is_indistinguishable_from_zero(&self) -> bool {
        self.slope.abs() <= self.half_width
    }
}

#[cfg(test)]
mod tests {
    use super::Drift;

    fn oscillation(k: usize) -> f64 {
        1e-6 * (0.037 * k as f64).sin() + 3e-7 * (0.011 * k as f64).cos()
    }

    #[test]
    fn a_bounded_oscillation_has_no_drift() {
        let samples: Vec<f64> = (0..100_000).map(oscillation).collect();
        let drift = Drift::of(&samples, 64).unwrap();
        assert!(drift.is_indistinguishable_from_zero(), "{drift:?}");
        assert!(drift.half_width < 1e-12, "{drift:?}");
    }

    #[test]
    fn a_trend_far_below_the_oscillation_is_found() {
        let samples: Vec<f64> = (0..100_000).map(|k| oscillation(k) + 1e-12 * k as f64).collect();
        let drift = Drift::of(&samples, 64).unwrap();
        assert!(!drift.is_indistinguishable_from_zero(), "{drift:?}");
        assert!((drift.slope - 1e-12).abs() <= drift.half_width, "{drift:?}");
    }

    #[test]
    fn too_few_blocks_or_samples_give_no_estimate() {
        assert_eq!(Drift::of(&[1.0; 100], 7), None);
        assert_eq!(Drift::of(&[1.0; 5], 8), None);
        assert_eq!(Drift::of(&[], 0), None);
    }
}
