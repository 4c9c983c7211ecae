//! Constraints at a configuration, with what is tangential to them.

use evi_core::generic::GenericSystem;
use num_dual::Dual64;

use crate::check::{dot, norm};

/// `φ`, `G` and `∂φ/∂t` by dual numbers.
pub(crate) struct Tangents {
    pub(crate) residuals: Vec<f64>,
    pub(crate) rows: Vec<Vec<f64>>,
    pub(crate) rates: Vec<f64>,
    /// An orthonormal basis of the rows of `G`.
    normals: Vec<Vec<f64>>,
}

/// What is left of a row beside the others, of so small a part of it, is round-off: the row depends on them.
const DEPENDENT: f64 = 1e-13;

impl Tangents {
    pub(crate) fn at<S: GenericSystem>(system: &S, t: f64, q: &[f64]) -> Self {
        let (n, m) = (system.n_coordinates(), system.n_constraints());
        let zero = Dual64::from_re(0.0);
        let mut values = vec![zero; m];
        let mut moved: Vec<Dual64> = q.iter().map(|&q| Dual64::from_re(q)).collect();
        let mut rows = vec![vec![0.0; n]; m];
        for i in 0..n {
            moved[i] = Dual64::new(q[i], 1.0);
            system.constraints(Dual64::from_re(t), &moved, &mut values);
            moved[i] = Dual64::from_re(q[i]);
            for (row, value) in rows.iter_mut().zip(&values) {
                row[i] = value.eps;
            }
        }
        system.constraints(Dual64::new(t, 1.0), &moved, &mut values);
        let residuals = values.iter().map(|value| value.re).collect();
        let rates = values.iter().map(|value| value.eps).collect();
        let normals = orthonormal(&rows);
        Self { residuals, rows, rates, normals }
    }

    /// The least-squares residual of `r + Gᵀℓ` over `ℓ`.
    pub(crate) fn tangential(&self, mut r: Vec<f64>) -> Vec<f64> {
        // Twice, for the normals are orthogonal to round-off only and ℓ may be large.
        for normal in self.normals.iter().chain(&self.normals) {
            subtract(&mut r, normal);
        }
        r
    }
}

/// Gram and Schmidt's method, twice, without the rows that depend on others.
fn orthonormal(rows: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for row in rows {
        let mut left = row.clone();
        for normal in basis.iter().chain(&basis) {
            subtract(&mut left, normal);
        }
        let length = norm(&left);
        if length > DEPENDENT * norm(row) {
            left.iter_mut().for_each(|x| *x /= length);
            basis.push(left);
        }
    }
    basis
}

fn subtract(r: &mut [f64], normal: &[f64]) {
    let part = dot(r, normal);
    r.iter_mut().zip(normal).for_each(|(r, normal)| *r -= part * normal);
}
