//! Matrices of one or two rows: inverted in closed form, without elimination.

use super::{Factorization, SingularMatrix};

/// A determinant below this fraction of one of its two terms is their round-off: the two are then the same but for that.
const SMALLEST_DETERMINANT: f64 = 8.0 * f64::EPSILON;

/// The empty matrix.
#[derive(Clone)]
pub struct Inverse0;

impl Factorization<[f64; 0], [[f64; 0]; 0]> for Inverse0 {
    #[inline]
    fn factor(_: &[[f64; 0]; 0]) -> Result<Self, SingularMatrix> {
        Ok(Self)
    }

    #[inline]
    fn factor_unscaled(matrix: &[[f64; 0]; 0]) -> Option<Self> {
        Self::factor(matrix).ok()
    }

    #[inline]
    fn solve(&self, _: &mut [f64; 0]) {}

    #[inline]
    fn pivot_ratio(&self) -> f64 {
        1.0
    }
}

/// The reciprocal of a 1 × 1 matrix.
#[derive(Clone)]
pub struct Inverse1(f64);

impl Factorization<[f64; 1], [[f64; 1]; 1]> for Inverse1 {
    #[inline]
    fn factor([[a]]: &[[f64; 1]; 1]) -> Result<Self, SingularMatrix> {
        // Written so that a NaN is singular.
        if a.abs() > 0.0 { Ok(Self(1.0 / a)) } else { Err(SingularMatrix { pivot_ratio: 0.0 * a }) }
    }

    #[inline]
    fn factor_unscaled(matrix: &[[f64; 1]; 1]) -> Option<Self> {
        Self::factor(matrix).ok()
    }

    #[inline]
    fn solve(&self, [b]: &mut [f64; 1]) {
        *b *= self.0;
    }

    #[inline(always)]
    fn solve_up_to_factor(&self, _: &mut [f64; 1]) -> f64 {
        self.0
    }

    #[inline]
    fn pivot_ratio(&self) -> f64 {
        1.0
    }
}

/// A 2 × 2 matrix by its adjugate and its determinant: one division, where elimination waits for two, and none of the
/// products waits for it.
#[derive(Clone)]
pub struct Inverse2 {
    matrix: [[f64; 2]; 2],
    reciprocal_determinant: f64,
}

impl Factorization<[f64; 2], [[f64; 2]; 2]> for Inverse2 {
    #[inline]
    fn factor(&matrix: &[[f64; 2]; 2]) -> Result<Self, SingularMatrix> {
        let [[a, b], [c, d]] = matrix;
        let main = a * d;
        let determinant = main - b * c;
        if determinant.abs() > SMALLEST_DETERMINANT * main.abs() {
            Ok(Self { matrix, reciprocal_determinant: 1.0 / determinant })
        } else {
            // 0 for the zero matrix, NaN where an entry is.
            let magnitude = magnitude_of_terms(&matrix);
            Err(SingularMatrix {
                pivot_ratio: if magnitude == 0.0 { 0.0 } else { determinant.abs() / magnitude },
            })
        }
    }

    #[inline]
    fn factor_unscaled(matrix: &[[f64; 2]; 2]) -> Option<Self> {
        Self::factor(matrix).ok()
    }

    #[inline]
    fn solve(&self, x: &mut [f64; 2]) {
        let r = self.solve_up_to_factor(x);
        *x = x.map(|x| x * r);
    }

    #[inline(always)]
    fn solve_up_to_factor(&self, x: &mut [f64; 2]) -> f64 {
        let [[a, b], [c, d]] = self.matrix;
        *x = [d * x[0] - b * x[1], a * x[1] - c * x[0]];
        self.reciprocal_determinant
    }

    #[inline]
    fn pivot_ratio(&self) -> f64 {
        1.0 / (self.reciprocal_determinant.abs() * magnitude_of_terms(&self.matrix))
    }
}

/// Sum of the magnitudes of the determinant's terms.
fn magnitude_of_terms([[a, b], [c, d]]: &[[f64; 2]; 2]) -> f64 {
    (a * d).abs() + (b * c).abs()
}
