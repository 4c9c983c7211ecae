//! The index-1 equations of a scene over any scalar.

use std::cmp::Ordering;

use evi_core::array::Array;
use evi_core::scalar::Scalar;
use evi_core::system::{LagrangianGradient, MechanicalSystem};

/// A scene's constants over `T`.
pub(crate) struct Index1<S: MechanicalSystem, T: Scalar> {
    constants: S::PerConstant<T>,
}

impl<S: MechanicalSystem, T: Scalar + PartialOrd> Index1<S, T> {
    /// The parameters are exact in `T`: they are the `f64` of the system.
    pub(crate) fn new(system: &S) -> Self {
        let parameters = system.parameters();
        let parameters = S::PerParameter::<T>::from_fn(|i| T::from_f64(parameters[i]));
        Self { constants: S::constants(&parameters) }
    }

    /// `q̈` from `M q̈ + Gᵀλ = ∂L/∂q − (∂²L/∂v∂q) v − ∂²L/∂v∂t + f` and `G q̈ = −γ`; without inputs.
    pub(crate) fn acceleration(&self, t: T, q: &S::PerCoordinate<T>, v: &S::PerCoordinate<T>) -> Vec<T> {
        let (zero, constants) = (T::from_f64(0.0), &self.constants);
        let n = S::N_COORDINATES;
        let (LagrangianGradient { force, .. }, hessian) = S::lagrangian_derivatives(constants, t, q, v);
        let (_, jacobian) = S::constraint_derivatives(constants, t, q);
        let forces = S::forces(constants, t, q, v, &Array::from_fn(|_| zero));
        let curvature = S::constraint_curvature(constants, t, q, v);
        let mut right: Vec<T> = (0..n).map(|i| force[i] + forces[i]).collect();
        right.extend((0..S::N_CONSTRAINTS).map(|c| -curvature[c]));
        for entry in S::STRUCTURE.hessian.vq {
            right[entry.row] =
                right[entry.row] - entry.value(constants.as_ref(), hessian.as_ref()) * v[entry.col];
        }
        for entry in S::STRUCTURE.hessian.vt {
            right[entry.row] = right[entry.row] - entry.value(constants.as_ref(), hessian.as_ref());
        }
        let mut matrix = vec![vec![zero; right.len()]; right.len()];
        for entry in S::STRUCTURE.hessian.vv {
            let value = entry.value(constants.as_ref(), hessian.as_ref());
            matrix[entry.row][entry.col] = value;
            matrix[entry.col][entry.row] = value;
        }
        for entry in S::STRUCTURE.jacobian.q {
            let value = entry.value(constants.as_ref(), jacobian.as_ref());
            matrix[n + entry.row][entry.col] = value;
            matrix[entry.col][n + entry.row] = value;
        }
        let mut solution = solve(matrix, right);
        solution.truncate(n);
        solution
    }
}

/// Gauss's elimination with partial pivoting.
fn solve<T: Scalar + PartialOrd>(mut matrix: Vec<Vec<T>>, mut right: Vec<T>) -> Vec<T> {
    let n = right.len();
    for k in 0..n {
        // With a NaN any pivot is as good as another: the solution is NaN.
        let larger = |&a: &usize, &b: &usize| {
            matrix[a][k].abs().partial_cmp(&matrix[b][k].abs()).unwrap_or(Ordering::Equal)
        };
        let pivot = (k..n).max_by(larger).expect("a row");
        matrix.swap(k, pivot);
        right.swap(k, pivot);
        for row in k + 1..n {
            // Most entries of a large matrix are exactly zero.
            if matrix[row][k] == T::from_f64(0.0) {
                continue;
            }
            let factor = matrix[row][k] / matrix[k][k];
            for col in k..n {
                matrix[row][col] = matrix[row][col] - factor * matrix[k][col];
            }
            right[row] = right[row] - factor * right[k];
        }
    }
    for k in (0..n).rev() {
        for col in k + 1..n {
            right[k] = right[k] - matrix[k][col] * right[col];
        }
        right[k] = right[k] / matrix[k][k];
    }
    right
}
