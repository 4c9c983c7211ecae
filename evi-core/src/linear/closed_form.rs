//! Matrices of one or two rows: inverted in closed form, without elimination.

use super::{Factorization, SingularMatrix};

/// A determinant below this fraction of its two terms is their round-off.
const SMALLEST_DETERMINANT: f64 = 4.0 * f64::EPSILON;

/// The empty matrix.
pub struct Inverse0;

impl Factorization<[f64; 0], [[f64; 0]; 0]> for Inverse0 {
    #[inline]
    fn factor(_: &[[f64; 0]; 0]) -> Result<Self, SingularMatrix> {
        Ok(Self)
    }

    #[inline]
    fn solve(&self, _: &mut [f64; 0]) {}

    #[inline]
    fn pivot_ratio(&self) -> f64 {
        1.0
    }
}

/// The reciprocal of a 1 × 1 matrix.
pub struct Inverse1(f64);

impl Factorization<[f64; 1], [[f64; 1]; 1]> for Inverse1 {
    #[inline]
    fn factor([[a]]: &[[f64; 1]; 1]) -> Result<Self, SingularMatrix> {
        // Written so that a NaN is singular.
        if a.abs() > 0.0 { Ok(Self(1.0 / a)) } else { Err(SingularMatrix { pivot_ratio: 0.0 * a }) }
    }

    #[inline]
    fn solve(&self, [b]: &mut [f64; 1]) {
        *b *= self.0;
    }

    #[inline]
    fn pivot_ratio(&self) -> f64 {
        1.0
    }
}

/// The inverse of a 2 × 2 matrix by its determinant: one division, where elimination waits for two.
pub struct Inverse2 {
    inverse: [[f64; 2]; 2],
    pivot_ratio: f64,
}

impl Factorization<[f64; 2], [[f64; 2]; 2]> for Inverse2 {
    #[inline]
    fn factor([[a, b], [c, d]]: &[[f64; 2]; 2]) -> Result<Self, SingularMatrix> {
        let (main, other) = (a * d, b * c);
        let (determinant, magnitude) = (main - other, main.abs() + other.abs());
        if determinant.abs() > SMALLEST_DETERMINANT * magnitude {
            let r = 1.0 / determinant;
            let pivot_ratio = determinant.abs() / magnitude;
            Ok(Self { inverse: [[d * r, -b * r], [-c * r, a * r]], pivot_ratio })
        } else {
            // 0 for the zero matrix, NaN where an entry is.
            Err(SingularMatrix {
                pivot_ratio: if magnitude == 0.0 { 0.0 } else { determinant.abs() / magnitude },
            })
        }
    }

    #[inline]
    fn solve(&self, x: &mut [f64; 2]) {
        let [[a, b], [c, d]] = self.inverse;
        *x = [a * x[0] + b * x[1], c * x[0] + d * x[1]];
    }

    #[inline]
    fn pivot_ratio(&self) -> f64 {
        self.pivot_ratio
    }
}
