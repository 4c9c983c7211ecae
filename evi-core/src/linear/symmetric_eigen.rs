//! Eigenvalues and eigenvectors of symmetric matrices, by Jacobi's rotations.
//!
//! In: a symmetric matrix by rows. Out: eigenvalues in ascending order and orthonormal eigenvectors. Nothing is allocated;
//! small eigenvalues of graded matrices are accurate, and blocks that no entry couples stay exactly uncoupled, which the usual
//! reduction to tridiagonal form does not give (Demmel & Veselić, SIAM J. Matrix Anal. Appl. 13 (1992) 1204).

use crate::array::Array;
use crate::scalar::Scalar;

/// Convergence is quadratic; sizes up to a hundred take below ten sweeps.
const MOST_SWEEPS: usize = 60;

/// `A = Σ λₖ qₖ qₖᵀ`.
pub(crate) struct SymmetricEigen<V, M> {
    /// `λₖ`, ascending.
    pub(crate) values: V,
    /// `qₖ`, one per row.
    pub(crate) vectors: M,
}

impl<V: Array<f64>, M: Array<V>> SymmetricEigen<V, M> {
    /// Of a symmetric matrix of finite numbers, of which the lower triangle is read (cyclic Jacobi: Golub & Van Loan, Matrix
    /// Computations, 4th ed., alg. 8.5.3).
    pub(crate) fn new(matrix: &M) -> Self {
        let n = M::LEN;
        let mut a = M::from_fn(|row| V::from_fn(|col| matrix[row.max(col)][row.min(col)]));
        let mut vectors = M::from_fn(|row| V::from_fn(|col| if row == col { 1.0 } else { 0.0 }));
        for _ in 0..MOST_SWEEPS {
            if is_diagonal(&a) {
                break;
            }
            for p in 0..n {
                for q in p + 1..n {
                    if a[p][q] != 0.0 {
                        rotate(&mut a, &mut vectors, p, q);
                    }
                }
            }
        }
        sorted(V::from_fn(|i| a[i][i]), vectors)
    }
}

/// Whether what is left off the diagonal is below a tenth of a rounding of the whole.
fn is_diagonal<V: Array<f64>, M: Array<V>>(a: &M) -> bool {
    const NEGLIGIBLE: f64 = 0.1 * f64::EPSILON;
    let largest = a.as_ref().iter().flat_map(|row| row.as_ref()).fold(0.0, |x: f64, y| x.max(y.abs()));
    (0..M::LEN).all(|row| (0..row).all(|col| a[row][col].abs() <= NEGLIGIBLE * largest))
}

/// The rotation of rows and columns `p` and `q` after which `a[p][q]` vanishes.
fn rotate<V: Array<f64>, M: Array<V>>(a: &mut M, vectors: &mut M, p: usize, q: usize) {
    let half_cotangent = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    // The smaller root of t² + 2 t cot 2φ − 1 = 0; 0 where the quotient overflows, as it should be.
    let length = half_cotangent.abs() + Scalar::sqrt(1.0 + half_cotangent * half_cotangent);
    let tangent = if half_cotangent < 0.0 { -1.0 / length } else { 1.0 / length };
    let cosine = 1.0 / Scalar::sqrt(1.0 + tangent * tangent);
    let sine = tangent * cosine;
    let shift = tangent * a[p][q];
    a[p][p] -= shift;
    a[q][q] += shift;
    a[p][q] = 0.0;
    a[q][p] = 0.0;
    for k in 0..M::LEN {
        if k != p && k != q {
            let (x, y) = (a[p][k], a[q][k]);
            (a[p][k], a[q][k]) = (cosine * x - sine * y, sine * x + cosine * y);
            (a[k][p], a[k][q]) = (a[p][k], a[q][k]);
        }
        let (x, y) = (vectors[p][k], vectors[q][k]);
        (vectors[p][k], vectors[q][k]) = (cosine * x - sine * y, sine * x + cosine * y);
    }
}

fn sorted<V: Array<f64>, M: Array<V>>(mut values: V, mut vectors: M) -> SymmetricEigen<V, M> {
    for k in 0..M::LEN {
        let smallest = (k..M::LEN).fold(k, |best, i| if values[i] < values[best] { i } else { best });
        values.as_mut().swap(k, smallest);
        vectors.as_mut().swap(k, smallest);
    }
    SymmetricEigen { values, vectors }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Eigen<const N: usize> = SymmetricEigen<[f64; N], [[f64; N]; N]>;

    /// `A q = λ q` and orthonormality, both in roundings of the largest entry.
    #[track_caller]
    fn check<const N: usize>(matrix: [[f64; N]; N]) -> [f64; N] {
        let Eigen { values, vectors } = Eigen::<N>::new(&matrix);
        let largest = matrix.iter().flatten().fold(f64::MIN_POSITIVE, |x, y| x.max(y.abs()));
        let mut worst = 0.0_f64;
        for k in 0..N {
            for row in 0..N {
                let product: f64 = (0..N).map(|col| matrix[row][col] * vectors[k][col]).sum();
                worst = worst.max((product - values[k] * vectors[k][row]).abs() / largest);
                let inner: f64 = (0..N).map(|col| vectors[k][col] * vectors[row][col]).sum();
                worst = worst.max((inner - if k == row { 1.0 } else { 0.0 }).abs());
            }
        }
        println!("{:.1} roundings", worst / f64::EPSILON);
        // Six sweeps of 66 rotations each: 18 roundings measured on matrices of size 12.
        assert!(worst <= 32.0 * f64::EPSILON, "off by {worst:e}");
        assert!(values.is_sorted());
        values
    }

    #[test]
    fn random_symmetric_matrices_are_diagonalised() {
        let mut bits = 1_u64;
        let mut random = || {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        for _ in 0..20 {
            let mut matrix = [[0.0; 12]; 12];
            for row in 0..12 {
                for col in 0..=row {
                    matrix[row][col] = random();
                    matrix[col][row] = matrix[row][col];
                }
            }
            check(matrix);
        }
    }

    #[test]
    fn known_values() {
        let values = check([[3.0, -1.0], [-1.0, 1.0]]);
        assert!((values[0] - (2.0 - 2.0_f64.sqrt())).abs() < 1e-15);
        assert_eq!(check([[0.0; 3]; 3]), [0.0; 3]);
        assert_eq!(check([[2.0, 0.0], [0.0, -1.0]]), [-1.0, 2.0]);
        assert_eq!(check::<0>([]), [0.0; 0]);
    }

    #[test]
    fn a_scale_of_a_power_of_two_changes_no_bit_of_the_vectors() {
        let matrix = [[2.0, 0.3, -0.1], [0.3, 1.0, 0.7], [-0.1, 0.7, -0.4]];
        let scaled = matrix.map(|row| row.map(|x| x * 1024.0));
        let (one, other) = (Eigen::<3>::new(&matrix), Eigen::<3>::new(&scaled));
        assert_eq!(one.vectors, other.vectors);
        assert_eq!(one.values.map(|x| x * 1024.0), other.values);
    }
}
