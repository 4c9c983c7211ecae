//! Singular values, by Hestenes' one-sided rotations: small ones are accurate, too, where the columns are of equal length (Demmel & Veselić,
//! SIAM J. Matrix Anal. Appl. 13 (1992) 1204). Nothing is allocated.

use super::orthonormal::product;
use crate::array::Array;
use crate::scalar::Scalar;

/// Convergence is quadratic; sizes up to a hundred take below ten sweeps.
const MOST_SWEEPS: usize = 60;

/// Overwrites `values` with the singular values of the matrix with these columns, in descending order, and the columns with rotated ones.
#[inline(never)]
pub(crate) fn singular_values<V: Array<f64>>(columns: &mut [V], values: &mut [f64]) {
    let m = columns.len();
    let largest = columns.iter().map(|column| product(column, column)).fold(0.0, f64::max);
    for _ in 0..MOST_SWEEPS {
        let mut is_orthogonal = true;
        for p in 0..m {
            for q in p + 1..m {
                is_orthogonal &= rotate(columns, p, q, largest);
            }
        }
        if is_orthogonal {
            break;
        }
    }
    for (value, column) in values.iter_mut().zip(columns) {
        *value = Scalar::sqrt(product(column, column));
    }
    // Total order, in which a NaN is the largest.
    values.sort_unstable_by(|x, y| y.total_cmp(x));
}

/// Rotates two columns until they are orthogonal; returns whether they were. What is below a rounding of the `largest` square has no direction.
fn rotate<V: Array<f64>>(columns: &mut [V], p: usize, q: usize, largest: f64) -> bool {
    let Some((head, [second, ..])) = columns.split_at_mut_checked(q) else { return true };
    let first = &mut head[p];
    let (alpha, beta, gamma) = (product(first, first), product(second, second), product(first, second));
    let negligible = f64::EPSILON * Scalar::sqrt(alpha * beta);
    let is_round_off = alpha.min(beta) <= f64::EPSILON * f64::EPSILON * largest;
    if is_round_off || gamma.abs() <= negligible {
        return true;
    }
    let half_cotangent = (beta - alpha) / (2.0 * gamma);
    let length = half_cotangent.abs() + Scalar::sqrt(1.0 + half_cotangent * half_cotangent);
    let tangent = if half_cotangent < 0.0 { -1.0 / length } else { 1.0 / length };
    let cosine = 1.0 / Scalar::sqrt(1.0 + tangent * tangent);
    let sine = tangent * cosine;
    for (x, y) in first.as_mut().iter_mut().zip(second.as_mut()) {
        (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of<const N: usize, const M: usize>(mut columns: [[f64; N]; M]) -> [f64; M] {
        let mut values = [0.0; M];
        singular_values(&mut columns, &mut values);
        values
    }

    #[test]
    fn known_values() {
        assert_eq!(of([[3.0, 0.0, 4.0], [4.0, 0.0, -3.0]]), [5.0, 5.0]);
        let values = of([[1.0, 1.0], [1.0, 1.0], [0.0, 2.0]]);
        // G Gᵀ = [[2, 2], [2, 6]]: squares 4 ± 2√2.
        let expected = [(4.0 + 8.0_f64.sqrt()).sqrt(), (4.0 - 8.0_f64.sqrt()).sqrt(), 0.0];
        assert!((0..3).all(|k| (values[k] - expected[k]).abs() < 1e-15), "{values:?}");
    }

    #[test]
    fn an_angle_of_1e_8_is_a_singular_value_and_no_round_off() {
        let angle = 1e-8_f64;
        let values = of([[1.0, 0.0], [angle.cos(), angle.sin()]]);
        // √(1 − cos angle) = √2 sin(angle/2).
        let expected = 2.0_f64.sqrt() * (0.5 * angle).sin();
        assert!((values[1] / expected - 1.0).abs() < 1e-7, "{values:?}");
    }
}
