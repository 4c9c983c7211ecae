//! Dense elimination with partial pivoting, over any storage: on the stack, without a path to a panic.

use super::{Factorization, SingularMatrix};
use crate::array::Array;

/// Pivots below this fraction of the largest are round-off of an `D × D` elimination.
const fn singular_pivot_ratio(dimension: usize) -> f64 {
    4.0 * dimension as f64 * f64::EPSILON
}

/// Smallest over largest of the pivots of a `dimension × dimension` elimination, if the matrix is regular.
#[inline]
pub(crate) fn checked_pivot_ratio(
    dimension: usize,
    pivot: impl Fn(usize) -> f64,
) -> Result<f64, SingularMatrix> {
    let (mut smallest, mut largest) = (f64::INFINITY, 0.0_f64);
    for i in 0..dimension {
        let pivot = pivot(i).abs();
        // Written so that a NaN pivot survives both comparisons, and all that follow.
        smallest = if pivot >= smallest || smallest.is_nan() { smallest } else { pivot };
        largest = if pivot <= largest || largest.is_nan() { largest } else { pivot };
    }
    let pivot_ratio = match smallest {
        _ if dimension == 0 => 1.0,
        // The zero matrix, whose quotient is not a number.
        0.0 => 0.0,
        _ => smallest / largest,
    };
    if pivot_ratio > singular_pivot_ratio(dimension) {
        Ok(pivot_ratio)
    } else {
        Err(SingularMatrix { pivot_ratio })
    }
}

/// `P A = L U` with partial pivoting (Golub & Van Loan, Matrix Computations, 4th ed., alg. 3.4.1).
pub struct Pivoted<M, P> {
    /// `U` on and above the diagonal, the multipliers of `L` below it.
    rows: M,
    /// The row that step `k` exchanged with row `k`.
    exchanges: P,
    pivot_ratio: f64,
}

/// The same for a matrix of `D` rows in arrays.
pub type DenseLu<const D: usize> = Pivoted<[[f64; D]; D], [usize; D]>;

impl<V, M, P> Factorization<V, M> for Pivoted<M, P>
where
    V: Array<f64>,
    M: Array<V>,
    P: Array<usize>,
{
    #[inline]
    fn factor(matrix: &M) -> Result<Self, SingularMatrix> {
        let n = M::LEN;
        let mut rows = matrix.clone();
        let mut exchanges = P::from_fn(|k| k);
        for k in 0..n {
            let (mut pivot, mut largest) = (k, rows[k][k].abs());
            for row in k + 1..n {
                let magnitude = rows[row][k].abs();
                if magnitude > largest {
                    (pivot, largest) = (row, magnitude);
                }
            }
            exchanges[k] = pivot;
            exchange(rows.as_mut(), k, pivot);
            let (above, below) = rows.as_mut().split_at_mut(k + 1);
            let Some([pivot, right @ ..]) = above.last().and_then(|row| row.as_ref().get(k..)) else {
                continue;
            };
            // Exact zero: nothing is left to eliminate in this column; the check of the pivots reports it.
            if *pivot == 0.0 {
                continue;
            }
            let inverse_pivot = 1.0 / pivot;
            for row in below {
                let Some([first, rest @ ..]) = row.as_mut().get_mut(k..) else { continue };
                *first *= inverse_pivot;
                for (entry, above) in rest.iter_mut().zip(right) {
                    *entry -= *first * above;
                }
            }
        }
        let pivot_ratio = checked_pivot_ratio(n, |i| rows[i][i])?;
        Ok(Self { rows, exchanges, pivot_ratio })
    }

    #[inline]
    fn solve(&self, rhs: &mut V) {
        let n = M::LEN;
        // The multipliers of a column were exchanged with the rows below it: all exchanges come before the substitution.
        for k in 0..n {
            exchange(rhs.as_mut(), k, self.exchanges[k]);
        }
        for row in 0..n {
            for col in 0..row {
                rhs[row] -= self.rows[row][col] * rhs[col];
            }
        }
        for row in (0..n).rev() {
            for col in (row + 1..n).rev() {
                rhs[row] -= self.rows[row][col] * rhs[col];
            }
            rhs[row] /= self.rows[row][row];
        }
    }

    #[inline]
    fn pivot_ratio(&self) -> f64 {
        self.pivot_ratio
    }
}

/// Exchanges two elements; both are there, which the optimiser need not find out.
#[inline(always)]
pub(super) fn exchange<X>(elements: &mut [X], i: usize, j: usize) {
    if i != j && i < elements.len() && j < elements.len() {
        elements.swap(i, j);
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Const, DimMin, SMatrix, SVector};

    use super::*;

    /// Uniform numbers in `[-1, 1)` (splitmix64, Steele, Lea, Flood, OOPSLA 2014).
    fn random(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = *seed;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^= bits >> 31;
        (bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Solves 200 random systems and compares with elimination under full pivoting.
    fn check_random<const D: usize>()
    where
        Const<D>: DimMin<Const<D>, Output = Const<D>>,
    {
        /// Condition numbers of the worst matrices met here: 1.6e3 ε of the solution measured.
        const WORST_CONDITION: f64 = 1e4;
        let mut seed = D as u64;
        for _ in 0..200 {
            let matrix: [[f64; D]; D] = core::array::from_fn(|_| core::array::from_fn(|_| random(&mut seed)));
            let rhs: [f64; D] = core::array::from_fn(|_| random(&mut seed));
            let mut solution = rhs;
            let factors = DenseLu::factor(&matrix).expect("random matrices are regular");
            assert!(factors.pivot_ratio() > 0.0 && factors.pivot_ratio() <= 1.0);
            factors.solve(&mut solution);
            let oracle = SMatrix::<f64, D, D>::from_fn(|row, col| matrix[row][col])
                .full_piv_lu()
                .solve::<Const<D>, Const<1>, _>(&SVector::from(rhs))
                .expect("random matrices are regular");
            let difference = (SVector::from(solution) - oracle).norm();
            assert!(difference <= WORST_CONDITION * f64::EPSILON * oracle.norm(), "{difference:e}");
            // Backward error, independent of the condition number: 3 ε measured.
            for row in 0..D {
                let terms: [f64; D] = core::array::from_fn(|col| matrix[row][col] * solution[col]);
                let scale: f64 = terms.iter().map(|term| term.abs()).sum::<f64>() + rhs[row].abs();
                let residual = terms.iter().sum::<f64>() - rhs[row];
                assert!(residual.abs() <= 16.0 * f64::EPSILON * scale, "{residual:e}");
            }
        }
    }

    #[test]
    fn random_systems_of_every_small_size_are_solved() {
        check_random::<1>();
        check_random::<2>();
        check_random::<3>();
        check_random::<6>();
        check_random::<12>();
    }

    #[test]
    fn a_system_without_unknowns_is_regular() {
        let factors = DenseLu::<0>::factor(&[]).expect("nothing is singular about it");
        factors.solve(&mut []);
        assert_eq!(factors.pivot_ratio(), 1.0);
    }

    #[track_caller]
    fn pivot_ratio_of_singular<const D: usize>(matrix: [[f64; D]; D]) -> f64
    where
        Const<D>: DimMin<Const<D>, Output = Const<D>>,
    {
        match DenseLu::factor(&matrix) {
            Ok(factors) => panic!("factored, with pivot ratio {:e}", factors.pivot_ratio()),
            Err(SingularMatrix { pivot_ratio }) => pivot_ratio,
        }
    }

    #[test]
    fn singular_matrices_are_reported_with_their_pivots() {
        assert_eq!(pivot_ratio_of_singular([[1.0, 2.0], [2.0, 4.0]]), 0.0);
        assert_eq!(pivot_ratio_of_singular([[1.0, 0.0], [0.0, 0.0]]), 0.0);
        assert_eq!(pivot_ratio_of_singular([[1.0, 0.0], [0.0, 1e-17]]), 1e-17);
        // The third row is the mean of the others, which no entry of it represents exactly.
        let rows = [[0.1, 0.7, 0.3], [0.9, 0.2, 0.6], [0.5, 0.45, 0.45]];
        assert!(pivot_ratio_of_singular(rows) < singular_pivot_ratio(3));
    }

    #[test]
    fn the_zero_matrix_has_the_pivot_ratio_zero() {
        assert_eq!(pivot_ratio_of_singular([[0.0]]), 0.0);
        assert_eq!(pivot_ratio_of_singular([[0.0; 3]; 3]), 0.0);
    }

    #[test]
    fn a_small_regular_matrix_is_not_singular() {
        let factors = DenseLu::factor(&[[1e-200, 0.0], [0.0, 2e-200]]).expect("its pivots are alike");
        assert_eq!(factors.pivot_ratio(), 0.5);
    }

    #[test]
    fn an_entry_that_is_not_a_number_is_found_wherever_it_stands() {
        for row in 0..4 {
            for col in 0..4 {
                let mut matrix: [[f64; 4]; 4] =
                    core::array::from_fn(|i| core::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }));
                matrix[row][col] = f64::NAN;
                assert!(pivot_ratio_of_singular(matrix).is_nan(), "row {row}, column {col}");
                matrix[row][col] = f64::INFINITY;
                let pivot_ratio = pivot_ratio_of_singular(matrix);
                assert!(pivot_ratio.is_nan() || pivot_ratio == 0.0, "row {row}, column {col}: {pivot_ratio}");
            }
        }
    }

    type Factors<const N: usize> = Pivoted<[[f64; N]; N], [usize; N]>;

    #[test]
    fn rows_are_exchanged_where_a_pivot_vanishes() {
        let matrix = [[0.0, 2.0, 1.0], [1.0, 0.0, 3.0], [4.0, -1.0, 0.0]];
        let x = [0.5, -1.5, 2.0];
        let mut y: [f64; 3] = core::array::from_fn(|row| (0..3).map(|col| matrix[row][col] * x[col]).sum());
        Factors::<3>::factor(&matrix).expect("regular").solve(&mut y);
        assert!((0..3).all(|i| (y[i] - x[i]).abs() < 1e-15), "{y:?}");
    }

    #[test]
    fn singular_matrices_are_refused() {
        assert!(Factors::<2>::factor(&[[1.0, 2.0], [2.0, 4.0]]).is_err());
        assert!(Factors::<2>::factor(&[[0.0, 0.0], [0.0, 1.0]]).is_err());
        assert!(Factors::<2>::factor(&[[f64::NAN, 1.0], [0.0, 1.0]]).is_err());
        assert!(Factors::<0>::factor(&[]).is_ok());
    }
}
