//! How far a frequency is from where steps lose their meaning.

use core::f64::consts::PI;

use super::{Frequency, Quadrature};
use crate::scalar::Scalar;

/// Where the phase `u = ω h` of a coordinate lies between 0, multiples of π, and the phase at which the nodes no longer determine a step.
///
/// At `u = kπ` the ends of a step do not determine the curve between them. Before, where `cos u + Σ wⱼ cos(u (1 − 2cⱼ)) = 0`, the
/// equations of a step lose the end of it: at `π/2` for the trapezoidal rule, `2π/3` for Simpson's, `π` for the midpoint. Near these the
/// scheme is refused; the distance tells how much is left.
///
/// ```
/// use std::f64::consts::PI;
/// use evi_core::scheme::{Frequency, Quadrature, Resonance};
/// let simpson = Quadrature::<3>::uniform();
/// let resonance = Resonance::of(Frequency::from(3.0), &simpson, 0.5);
/// assert_eq!(resonance.phase, 1.5);
/// assert!((resonance.limit - 2.0 * PI / 3.0).abs() < 1e-14);
/// assert!((resonance.margin() - (2.0 * PI / 3.0 - 1.5)).abs() < 1e-14);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resonance {
    /// `u = |ω h|`, or the rate times `|h|` of a hyperbolic curve.
    pub phase: f64,
    /// Distance of `u` from the nearest `kπ`, `k ≥ 1`; infinite for a hyperbolic curve.
    pub to_resonance: f64,
    /// The smallest `u` at which the nodes do not determine the end of a step, `π` at most; infinite for a hyperbolic curve.
    pub limit: f64,
}

impl Resonance {
    /// Of a curve of this frequency in steps of size `h`, sampled by `rule`.
    pub fn of<const K: usize>(frequency: Frequency, rule: &Quadrature<K>, h: f64) -> Self {
        let phase = (frequency.value() * h).abs();
        match frequency {
            Frequency::Trigonometric(_) => {
                Self { phase, to_resonance: to_multiple_of_pi(phase), limit: first_limit(rule) }
            }
            Frequency::Hyperbolic(_) => Self { phase, to_resonance: f64::INFINITY, limit: f64::INFINITY },
        }
    }

    /// What is left before the nearer of the two; negative beyond the limit, where steps exist, but oscillate against the motion.
    pub const fn margin(&self) -> f64 {
        self.to_resonance.min(self.limit - self.phase)
    }
}

/// Distance from the nearest `kπ`, `k ≥ 1`.
pub(crate) fn to_multiple_of_pi(phase: f64) -> f64 {
    // The cast saturates, and rounds a positive number as wanted.
    let nearest = ((phase / PI + 0.5) as u64).max(1);
    (phase - nearest as f64 * PI).abs()
}

/// The smallest zero of `cos u + Σ wⱼ cos(2uσⱼ)` in `(0, π]`, which is 2 at `u = 0`; `π` if there is none before.
fn first_limit<const K: usize>(rule: &Quadrature<K>) -> f64 {
    /// Rules whose zeros are nearer to each other would need more than a hundred nodes.
    const INTERVALS: u32 = 128;
    let nodes = || rule.weights().iter().zip(rule.offsets());
    let inertia =
        |u: f64| Scalar::cos(u) + nodes().map(|(w, offset)| w * Scalar::cos(2.0 * u * offset)).sum::<f64>();
    let at = |k: u32| PI * f64::from(k) / f64::from(INTERVALS);
    // The midpoint touches 0 at π: that is no zero before it.
    let Some(k) = (1..INTERVALS).find(|&k| inertia(at(k)) <= 0.0) else {
        return if inertia(PI) < 0.0 { bisected(inertia, at(INTERVALS - 1), PI) } else { PI };
    };
    bisected(inertia, at(k - 1), at(k))
}

/// The zero between `low` and `high`, where the function is positive and not.
fn bisected(function: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        // Neighbouring numbers.
        if !(low < middle && middle < high) {
            return middle;
        }
        if function(middle) > 0.0 { low = middle } else { high = middle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check<const K: usize>(rule: Quadrature<K>, expected: f64) {
        let limit = first_limit(&rule);
        assert!((limit - expected).abs() <= 4.0 * f64::EPSILON, "{limit}, expected {expected}");
    }

    #[test]
    fn limits_are_those_of_the_literature() {
        check(Quadrature::midpoint(), PI);
        check(Quadrature::<2>::uniform(), PI / 2.0);
        check(Quadrature::<3>::uniform(), 2.0 * PI / 3.0);
        // Two Gauss nodes: the zero of cos u + cos(u/√3), by the sum of cosines: u (1 + 1/√3) = π.
        check(Quadrature::<2>::gauss(), PI / (1.0 + 1.0 / 3.0_f64.sqrt()));
        check(Quadrature::<3>::lobatto(), 2.0 * PI / 3.0);
    }

    #[test]
    fn schemes_are_refused_at_the_limit_and_not_before() {
        use crate::scheme::basis::checked_coefficients;
        let rule = Quadrature::<4>::gauss();
        let limit = first_limit(&rule);
        let at = |u: f64| checked_coefficients(Frequency::from(u), 0, &rule, 1.0).is_ok();
        assert!(at(0.99 * limit) && !at(limit) && at(1.01 * limit), "{limit}");
    }

    #[test]
    fn the_nearest_multiple_of_pi_is_never_0() {
        for (phase, expected) in
            [(0.0, PI), (0.1, PI - 0.1), (3.0, PI - 3.0), (5.0, 2.0 * PI - 5.0), (7.0, 7.0 - 2.0 * PI)]
        {
            assert!((to_multiple_of_pi(phase) - expected).abs() < 1e-15, "{phase}");
        }
        assert_eq!(
            Resonance::of(Frequency::Hyperbolic(9.0), &Quadrature::<3>::uniform(), 1.0).margin(),
            f64::INFINITY
        );
    }
}
