//! Saddle-point systems whose constraints have a stated rank: solved on the null space of the constraints, by orthogonal bases.
//!
//! ```text
//! [ A   G₀ᵀ ] [ x ]   [ a ]        A: n × n,  G₀, G₁: m × n of rank r ≤ m
//! [ G₁  0   ] [ y ] = [ b ]
//! ```
//!
//! With orthonormal bases `[Y₁ Z₁]`, where `G₁ Z₁ = 0`, and `[Y₀ Z₀]`, where `G₀ Z₀ = 0`, the solution is `x = Y₁ w + Z₁ z` with
//! `G₁ Y₁ w = b` in `r` independent rows and `Z₀ᵀ A Z₁ z = Z₀ᵀ (a − A Y₁ w)`; of all `y` for which `G₀ᵀ y = a − A x` it is the one of
//! least norm (Benzi, Golub, Liesen, Acta Numerica 14 (2005) 1, sec. 6; Golub & Van Loan, Matrix Computations, 4th ed., sec. 5.5). No
//! product `G A⁻¹ Gᵀ` is formed, so that the condition of the constraints is not squared.
//!
//! Lengths are those of the metric `diag |Aᵢᵢ|`, in which every constraint is scaled to a gradient of length 1: the least norm is
//! that of the constraint forces, whatever units constraints and coordinates have.

use super::{Factorization, Pivoted, SingularMatrix, largest_magnitude, orthonormal};
use crate::array::Array;
use crate::scalar::Scalar;
use crate::system::MechanicalSystem;

/// A square matrix over the coordinates, by rows.
type Square<S> = <S as MechanicalSystem>::PerCoordinate<<S as MechanicalSystem>::PerCoordinate<f64>>;
/// A square matrix over the constraints, by rows.
type ConstraintSquare<S> =
    <S as MechanicalSystem>::PerConstraint<<S as MechanicalSystem>::PerConstraint<f64>>;

/// Factors of a saddle-point matrix whose constraints have rank `R`.
pub struct NullSpace<S: MechanicalSystem, const R: usize> {
    /// `1/√|Aᵢᵢ|`.
    units: S::PerCoordinate<f64>,
    /// `A` in these units.
    block: Square<S>,
    start: RowSpace<S, R>,
    end: RowSpace<S, R>,
    /// Of `Z₀ᵀ A Z₁`, behind `R` rows of the identity.
    reduced: Pivoted<Square<S>, S::PerCoordinate<usize>>,
    /// Orthonormal rows that span those of `Y₀ᵀ G₀ᵀ`, and their shares in those, a lower triangle.
    rows: ConstraintSquare<S>,
    shares: ConstraintSquare<S>,
}

/// The gradients of constraints, scaled to length 1, in an orthonormal basis whose first `R` vectors they span.
struct RowSpace<S: MechanicalSystem, const R: usize> {
    basis: Square<S>,
    /// `1/‖G_c‖`; 1 for a gradient that vanishes.
    scale: S::PerConstraint<f64>,
    /// The scaled gradient of constraint `c` is `Σ coefficients[k][c] basis[k]`.
    coefficients: ConstraintSquare<S>,
    /// The constraints that the basis was made from, in this order; `R` of them.
    independent: S::PerConstraint<usize>,
    /// The smallest part of one of them that those before it do not span.
    smallest: f64,
}

impl<S: MechanicalSystem, const R: usize> RowSpace<S, R> {
    fn new(gradients: S::PerConstraint<S::PerCoordinate<f64>>) -> Self {
        let scale = S::PerConstraint::<f64>::from_fn(|c| {
            let length = Scalar::sqrt(gradients[c].as_ref().iter().map(|x| x * x).sum::<f64>());
            if length > 0.0 { 1.0 / length } else { 1.0 }
        });
        let gradients = S::PerConstraint::<S::PerCoordinate<f64>>::from_fn(|c| {
            Array::from_fn(|i| scale[c] * gradients[c][i])
        });
        let mut basis: Square<S> = Array::from_fn(|_| Array::from_fn(|_| 0.0));
        let mut independent = S::PerConstraint::<usize>::from_fn(|c| c);
        let mut rests = gradients.clone();
        let smallest = orthonormal::span(rests.as_mut(), R, basis.as_mut(), independent.as_mut());
        orthonormal::complete(R, basis.as_mut());
        let coefficients = Array::from_fn(|k| {
            Array::from_fn(|c| if k < R { orthonormal::product(&basis[k], &gradients[c]) } else { 0.0 })
        });
        Self { basis, scale, coefficients, independent, smallest }
    }

    /// `Y w`, where the gradients of the independent constraints have the products `b` with it.
    fn position(&self, b: impl Fn(usize) -> f64) -> S::PerCoordinate<f64> {
        let mut position = S::PerCoordinate::<f64>::from_fn(|_| 0.0);
        let mut weights = S::PerConstraint::<f64>::from_fn(|_| 0.0);
        for row in 0..R {
            // An index that the optimiser sees is one.
            let constraint = self.independent[row].min(S::N_CONSTRAINTS - 1);
            let known: f64 = (0..row).map(|k| self.coefficients[k][constraint] * weights[k]).sum();
            let rest = self.scale[constraint] * b(constraint) - known;
            weights[row] = rest / self.coefficients[row][constraint];
            for i in 0..S::N_COORDINATES {
                position[i] += weights[row] * self.basis[row][i];
            }
        }
        position
    }
}

impl<S: MechanicalSystem, const R: usize> NullSpace<S, R> {
    /// Parts that are smaller than this are round-off of an `n × n` elimination.
    const SMALLEST: f64 = 4.0 * S::N_COORDINATES as f64 * f64::EPSILON;

    /// `A x` in the units of the block.
    fn block_times(&self, x: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64> {
        Array::from_fn(|row| orthonormal::product(&self.block[row], x))
    }

    /// `y` of least norm for which `G₀ᵀ y` is `force` but for what is normal to `Y₀`.
    fn shared(&self, force: &S::PerCoordinate<f64>) -> S::PerConstraint<f64> {
        let mut weights = S::PerConstraint::<f64>::from_fn(|_| 0.0);
        let mut shared = S::PerConstraint::<f64>::from_fn(|_| 0.0);
        for row in 0..R {
            let known: f64 = (0..row).map(|k| self.shares[row][k] * weights[k]).sum();
            let rest = orthonormal::product(&self.start.basis[row], force) - known;
            weights[row] = rest / self.shares[row][row];
            for c in 0..S::N_CONSTRAINTS {
                shared[c] += weights[row] * self.rows[row][c];
            }
        }
        Array::from_fn(|c| self.start.scale[c] * shared[c])
    }
}

impl<S, const R: usize> Factorization<S::PerUnknown<f64>, S::PerUnknown<S::PerUnknown<f64>>>
    for NullSpace<S, R>
where
    S: MechanicalSystem,
{
    fn factor(matrix: &S::PerUnknown<S::PerUnknown<f64>>) -> Result<Self, SingularMatrix> {
        let n = S::N_COORDINATES;
        let units = S::PerCoordinate::<f64>::from_fn(|i| {
            let row = &matrix[i].as_ref()[..n];
            let inertia = if row[i] == 0.0 { largest_magnitude(row.iter().copied()) } else { row[i].abs() };
            if inertia > 0.0 { 1.0 / Scalar::sqrt(inertia) } else { 1.0 }
        });
        let block: Square<S> =
            Array::from_fn(|row| Array::from_fn(|col| units[row] * matrix[row][col] * units[col]));
        let start =
            RowSpace::<S, R>::new(Array::from_fn(|c| Array::from_fn(|i| units[i] * matrix[i][n + c])));
        let end = RowSpace::<S, R>::new(Array::from_fn(|c| Array::from_fn(|i| units[i] * matrix[n + c][i])));
        let smallest = if start.smallest < end.smallest { start.smallest } else { end.smallest };
        // Written so that a NaN is singular.
        let has_rank = smallest > Self::SMALLEST;
        if !has_rank {
            return Err(SingularMatrix { pivot_ratio: smallest });
        }
        let columns: Square<S> =
            Array::from_fn(|k| Array::from_fn(|row| orthonormal::product(&block[row], &end.basis[k])));
        let reduced = Pivoted::factor(&Array::from_fn(|row| {
            Array::from_fn(|col| match (row < R, col < R) {
                (false, false) => orthonormal::product(&start.basis[row], &columns[col]),
                _ if row == col => 1.0,
                _ => 0.0,
            })
        }))?;
        let mut rows: ConstraintSquare<S> = Array::from_fn(|_| Array::from_fn(|_| 0.0));
        orthonormal::in_order(start.coefficients.as_ref(), R, rows.as_mut());
        let shares = Array::from_fn(|row| {
            Array::from_fn(|k| {
                if k <= row && row < R {
                    orthonormal::product(&start.coefficients[row], &rows[k])
                } else {
                    0.0
                }
            })
        });
        Ok(Self { units, block, start, end, reduced, rows, shares })
    }

    fn factor_unscaled(matrix: &S::PerUnknown<S::PerUnknown<f64>>) -> Option<Self> {
        Self::factor(matrix).ok()
    }

    fn solve(&self, rhs: &mut S::PerUnknown<f64>) {
        let n = S::N_COORDINATES;
        let force = S::PerCoordinate::<f64>::from_fn(|i| self.units[i] * rhs[i]);
        let mut x = self.end.position(|c| rhs[n + c]);
        let left = self.block_times(&x);
        let mut reduced = S::PerCoordinate::<f64>::from_fn(|k| {
            if k < R { 0.0 } else { (0..n).map(|i| self.start.basis[k][i] * (force[i] - left[i])).sum() }
        });
        self.reduced.solve(&mut reduced);
        for k in R..n {
            for i in 0..n {
                x[i] += reduced[k] * self.end.basis[k][i];
            }
        }
        let left = self.block_times(&x);
        let y = self.shared(&Array::from_fn(|i| force[i] - left[i]));
        for i in 0..n {
            rhs[i] = self.units[i] * x[i];
        }
        for c in 0..S::N_CONSTRAINTS {
            rhs[n + c] = y[c];
        }
    }

    fn pivot_ratio(&self) -> f64 {
        let smallest =
            if self.start.smallest < self.end.smallest { self.start.smallest } else { self.end.smallest };
        smallest * self.reduced.pivot_ratio()
    }
}
