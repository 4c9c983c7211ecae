//! What a scheme makes of a mode that does not have its frequency.

use super::{Frequency, NodeCoefficients, Quadrature};
use crate::scalar::Scalar;

/// The rate at which a step makes the mode `ÿ = −κ y` grow, per unit of time; 0 if the mode stays bounded.
///
/// `squared_frequency` is `κ`: positive for an oscillation, 0 for a free motion, negative for one that grows in truth. For
/// mirror-symmetric nodes, `S₂ = Σ wⱼ sin² uσⱼ`, `C₂ = 1 − S₂`, an oscillation of frequency `μ` is stable iff `S₂/C₂ < (μ/ω)² < C₂/S₂`. A
/// free motion grows like `cosh rt` with `r ≈ ω² |h| √(Σ wⱼ σⱼ²)`, except on the midpoint. On straight curves a mode is stable up to
/// `μ |h| = (Σ wⱼ σⱼ²)^(−1/2)`.
///
/// Exact for the modes of a scene without constraints whose coordinates share one frequency, and for motions that the constraints of
/// a scene leave straight, such as translations; else it tells the size of the effect.
///
/// ```
/// use evi_core::scheme::{Frequency, Quadrature, growth_rate};
/// let simpson = Quadrature::<3>::uniform();
/// let free = growth_rate(Frequency::from(3.0), &simpson, 0.01, 0.0);
/// assert!((free / (9.0 * 0.01 / 12.0_f64.sqrt()) - 1.0).abs() < 1e-3);
/// assert_eq!(growth_rate(Frequency::from(3.0), &simpson, 0.01, 9.0), 0.0);
/// ```
pub fn growth_rate<const K: usize>(
    frequency: Frequency,
    rule: &Quadrature<K>,
    h: f64,
    squared_frequency: f64,
) -> f64 {
    let z = squared_frequency * h * h;
    // h D₁D₂L_d, h (D₁ + D₂)²L_d and h (D₂ − D₁)²L_d of the mode.
    let (mut mixed, mut together, mut apart) = (0.0, 0.0, 0.0);
    for (weight, offset) in rule.weights().iter().zip(rule.offsets()) {
        let c = NodeCoefficients::new(frequency, h, *offset);
        mixed += weight * (c.start_rate() * c.end_rate() - z * c.start() * c.end());
        together += weight * (c.even_rate * c.even_rate - z * c.even * c.even);
        apart += 4.0 * weight * (c.odd_rate * c.odd_rate - z * c.odd * c.odd);
    }
    // Half the trace of a step of determinant 1 is −(D₁D₁ + D₂D₂)/(2 D₁D₂) L_d: below −1 or above 1 by these.
    let above = -0.5 * together / mixed;
    let below = 0.5 * apart / mixed;
    let excess = if above > 0.0 { above } else { below };
    // arcosh(1 + excess), without the cancellation.
    if excess > 0.0 { 2.0 * libm::asinh(Scalar::sqrt(0.5 * excess)) / h.abs() } else { 0.0 }
}
