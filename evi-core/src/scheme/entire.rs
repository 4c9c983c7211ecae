//! Functions of `z = (ω h)²` that are entire: trigonometric for `z > 0`, hyperbolic for `z < 0`, without a seam at 0.

use super::Frequency;
use crate::scalar::Scalar;

/// `z = (ω h)²` of a trigonometric curve, `−(r h)²` of a hyperbolic one.
pub(crate) fn squared_phase(frequency: Frequency, h: f64) -> f64 {
    let phase = frequency.value() * h;
    match frequency {
        Frequency::Trigonometric(_) => phase * phase,
        Frequency::Hyperbolic(_) => -phase * phase,
    }
}

/// `sin √z / √z`.
pub(crate) fn sinc(z: f64) -> f64 {
    let root = Scalar::sqrt(z.abs());
    if root == 0.0 {
        1.0
    } else if z > 0.0 {
        Scalar::sin(root) / root
    } else {
        Scalar::sinh(root) / root
    }
}

/// `(1 − sin √z / √z) / z`, which is `1/6` at 0.
pub(crate) fn sinc_defect(z: f64) -> f64 {
    /// Below this the quotient would lose a digit, and ten terms of the series have an error below round-off.
    const SERIES: f64 = 2.0;
    if z.abs() > SERIES {
        return (1.0 - sinc(z)) / z;
    }
    // Σ (−z)ᵏ / (2k + 3)! = (1 − z/(4·5) (1 − z/(6·7) (1 − …))) / 6
    (0..10).rev().fold(1.0, |rest, k| 1.0 - z * rest / f64::from((2 * k + 4) * (2 * k + 5))) / 6.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_and_quotient_meet() {
        for z in [1.999_999_f64, -1.999_999] {
            let quotient = (1.0 - sinc(z)) / z;
            assert!((sinc_defect(z) - quotient).abs() <= 4.0 * f64::EPSILON, "{z}");
        }
        assert_eq!(sinc_defect(0.0), 1.0 / 6.0);
        assert!((sinc_defect(1e-3) - (1.0 / 6.0 - 1e-3 / 120.0 + 1e-6 / 5040.0)).abs() < 1e-14);
        // Half a turn: the sine vanishes.
        let pi_squared = core::f64::consts::PI.powi(2);
        assert!((sinc_defect(pi_squared) * pi_squared - 1.0).abs() < 1e-15);
    }

    #[test]
    fn no_seam_at_zero() {
        for z in [1e-3, 1e-9, 1e-15, 0.0] {
            assert!((sinc(z) - (1.0 - z / 6.0)).abs() <= z * z + f64::EPSILON);
            assert!((sinc(-z) - (1.0 + z / 6.0)).abs() <= z * z + f64::EPSILON);
        }
    }
}
