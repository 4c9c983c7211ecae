//! Matrices of one or two rows: inverted in closed form, without elimination.

use super::{Factorization, SingularMatrix, largest_magnitude, reciprocal_power_of_two};
use crate::scalar::Scalar;

/// A determinant below this fraction of one of its two terms is their round-off: the two are then the same but for that.
const SMALLEST_DETERMINANT: f64 = 8.0 * f64::EPSILON;

/// The same for solutions that nobody checks by another evaluation: a determinant above has lost no more than four digits.
const SMALLEST_UNGUARDED: f64 = 1.0 / 4096.0;

/// Below, the terms of a determinant have lost digits to underflow.
const UNDERFLOW: f64 = f64::MIN_POSITIVE / f64::EPSILON;

/// The empty matrix.
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

/// A 1 × 1 matrix and its reciprocal.
pub struct Inverse1 {
    entry: f64,
    reciprocal: f64,
}

impl Factorization<[f64; 1], [[f64; 1]; 1]> for Inverse1 {
    #[inline]
    fn factor([[a]]: &[[f64; 1]; 1]) -> Result<Self, SingularMatrix> {
        // Written so that a NaN is singular; an infinite one has no reciprocal either.
        if a.abs() > 0.0 && a.abs() < f64::INFINITY {
            Self::factor_unguarded(&[[*a]])
        } else {
            Err(SingularMatrix { pivot_ratio: 0.0 * a })
        }
    }

    #[inline(always)]
    fn factor_unguarded(&[[entry]]: &[[f64; 1]; 1]) -> Result<Self, SingularMatrix> {
        Ok(Self { entry, reciprocal: 1.0 / entry })
    }

    #[inline(always)]
    fn doubt(&self) -> f64 {
        0.0 * self.entry
    }

    #[inline]
    fn factor_unscaled(matrix: &[[f64; 1]; 1]) -> Option<Self> {
        Self::factor(matrix).ok()
    }

    #[inline]
    fn solve(&self, [b]: &mut [f64; 1]) {
        *b *= self.reciprocal;
    }

    #[inline(always)]
    fn solve_up_to_factor(&self, _: &mut [f64; 1]) -> f64 {
        self.reciprocal
    }

    #[inline]
    fn pivot_ratio(&self) -> f64 {
        1.0
    }
}

/// A 2 × 2 matrix by its adjugate and its determinant: one division, where elimination waits for two, and none of the
/// products waits for it.
pub struct Inverse2 {
    /// In any unit.
    matrix: [[f64; 2]; 2],
    /// The inverse over the adjugate of `matrix`.
    per_adjugate: f64,
}

impl Factorization<[f64; 2], [[f64; 2]; 2]> for Inverse2 {
    #[inline]
    fn factor(matrix: &[[f64; 2]; 2]) -> Result<Self, SingularMatrix> {
        Self::with_determinant_above(SMALLEST_DETERMINANT, matrix)
    }

    #[inline(always)]
    fn factor_unguarded(matrix: &[[f64; 2]; 2]) -> Result<Self, SingularMatrix> {
        Self::with_determinant_above(SMALLEST_UNGUARDED, matrix)
    }

    #[inline]
    fn factor_of_any_size(matrix: &[[f64; 2]; 2]) -> Result<Self, SingularMatrix> {
        Self::factor(matrix).or_else(|_| Self::in_own_unit(matrix))
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
        self.per_adjugate
    }

    #[inline]
    fn pivot_ratio(&self) -> f64 {
        singular(terms(&self.matrix)).pivot_ratio
    }
}

impl Inverse2 {
    /// Factors a matrix whose determinant is more than the `smallest` fraction of one of its two terms.
    #[inline(always)]
    fn with_determinant_above(smallest: f64, &matrix: &[[f64; 2]; 2]) -> Result<Self, SingularMatrix> {
        let [main, other] = terms(&matrix);
        let determinant = main - other;
        // By squares: no digit is lost to underflow in a determinant whose square has not vanished.
        if determinant * determinant > (smallest * smallest) * (main * main) {
            Ok(Self { matrix, per_adjugate: 1.0 / determinant })
        } else {
            Err(singular([main, other]))
        }
    }

    /// Factors a matrix whose determinant over- or underflows, in the unit in which its largest entry is nearly 1: a power of two, which
    /// changes no digit.
    #[cold]
    fn in_own_unit(matrix: &[[f64; 2]; 2]) -> Result<Self, SingularMatrix> {
        let unit = reciprocal_power_of_two(largest_magnitude(matrix.as_flattened().iter().copied()));
        let matrix = matrix.map(|row| row.map(|entry| entry * unit));
        let [main, other] = terms(&matrix);
        let determinant = main - other;
        let per_adjugate = unit / determinant;
        // Written so that a NaN is singular.
        let is_regular = determinant.abs() > SMALLEST_DETERMINANT * main.abs() + UNDERFLOW;
        if !(is_regular && per_adjugate.is_finite()) {
            return Err(singular([main, other]));
        }
        // A solution is found from two factors, neither of which should leave the numbers: each has half of the powers of ten.
        let half = reciprocal_power_of_two(Scalar::sqrt(per_adjugate.abs()));
        Ok(Self {
            matrix: matrix.map(|row| row.map(|entry| entry / half)),
            per_adjugate: per_adjugate * half,
        })
    }
}

/// The terms of which the determinant is the difference.
#[inline(always)]
fn terms([[a, b], [c, d]]: &[[f64; 2]; 2]) -> [f64; 2] {
    [a * d, b * c]
}

/// What is left of the terms of a determinant: 0 for the zero matrix, NaN where an entry is.
#[inline(always)]
fn singular([main, other]: [f64; 2]) -> SingularMatrix {
    let magnitude = main.abs() + other.abs();
    SingularMatrix { pivot_ratio: if magnitude == 0.0 { 0.0 } else { (main - other).abs() / magnitude } }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix without symmetry, in a unit that is a power of two.
    fn in_unit(exponent: i32) -> [[f64; 2]; 2] {
        [[3.0, -0.7], [1.1, 0.2]].map(|row| row.map(|entry: f64| entry * Scalar::powi(2.0_f64, exponent)))
    }

    fn solution(matrix: &[[f64; 2]; 2], rhs: [f64; 2]) -> [f64; 2] {
        let mut x = rhs;
        Inverse2::factor_of_any_size(matrix).expect("regular in every unit").solve(&mut x);
        x
    }

    #[test]
    fn units_in_which_the_determinant_is_no_number_change_no_digit() {
        let expected = solution(&in_unit(0), [0.3, -1.7]);
        for exponent in [-1000, -700, -539, -520, -511, -300, -240, 0, 240, 500, 511, 520, 700, 1000] {
            let unit = Scalar::powi(2.0_f64, exponent);
            let x = solution(&in_unit(exponent), [0.3 * unit, -1.7 * unit]);
            for (x, expected) in x.iter().zip(expected) {
                // Powers of two commute with every rounding; only the order of two of them differs.
                assert!((x - expected).abs() <= 2.0 * f64::EPSILON * expected.abs(), "2^{exponent}: {x:e}");
            }
        }
    }

    #[test]
    fn a_determinant_with_digits_lost_to_underflow_is_not_inverted_as_it_stands() {
        for exponent in -1074..=1023 {
            let matrix = in_unit(exponent);
            if let Ok(factors) = Inverse2::factor(&matrix) {
                let exact = 1.0 / (3.0 * 0.2 + 0.7 * 1.1);
                let unit = Scalar::powi(2.0_f64, exponent);
                let found = factors.per_adjugate * unit * unit;
                assert!((found - exact).abs() <= 4.0 * f64::EPSILON * exact, "2^{exponent}: {found:e}");
            }
        }
        assert!(Inverse2::factor(&in_unit(-1000)).is_err() && Inverse2::factor(&in_unit(-200)).is_ok());
    }

    #[test]
    fn dependent_rows_are_singular_in_every_unit() {
        for unit in [1e-300, 1e-160, 1.0, 1e160, 1e300] {
            let matrix = [[0.1, 0.3], [0.2, 0.6]].map(|row: [f64; 2]| row.map(|entry| entry * unit));
            let error = Inverse2::factor_of_any_size(&matrix).err().expect("dependent");
            assert!(error.pivot_ratio <= f64::EPSILON, "{unit:e}: {error}");
        }
        assert_eq!(Inverse2::factor_of_any_size(&[[0.0; 2]; 2]).err().map(|e| e.pivot_ratio), Some(0.0));
        for entry in [f64::NAN, f64::INFINITY] {
            assert!(Inverse2::factor_of_any_size(&[[entry, 0.1], [0.2, 0.3]]).is_err());
        }
    }
}
