//! Dense elimination with partial pivoting, on the stack.

use nalgebra::{Const, DimMin, LU, SMatrix, SVector};

use super::{Factorization, SingularMatrix};

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
pub struct DenseLu<const D: usize>
where
    Const<D>: DimMin<Const<D>, Output = Const<D>>,
{
    factors: LU<f64, Const<D>, Const<D>>,
    pivot_ratio: f64,
}

impl<const D: usize> Factorization<[f64; D], [[f64; D]; D]> for DenseLu<D>
where
    Const<D>: DimMin<Const<D>, Output = Const<D>>,
{
    #[inline]
    fn factor(matrix: &[[f64; D]; D]) -> Result<Self, SingularMatrix> {
        let factors = LU::new(SMatrix::<f64, D, D>::from_fn(|row, col| matrix[row][col]));
        let pivot_ratio = checked_pivot_ratio(D, |i| factors.lu_internal()[(i, i)])?;
        Ok(Self { factors, pivot_ratio })
    }

    #[inline]
    fn solve(&self, rhs: &mut [f64; D]) {
        // nalgebra's triangular solve counts down from D − 1.
        if D == 0 {
            return;
        }
        let mut solution = SVector::<f64, D>::from(*rhs);
        let solved = self.factors.solve_mut(&mut solution);
        assert!(solved, "a factored matrix has nonzero pivots");
        *rhs = solution.into();
    }

    #[inline]
    fn pivot_ratio(&self) -> f64 {
        self.pivot_ratio
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::SMatrix;

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
}
