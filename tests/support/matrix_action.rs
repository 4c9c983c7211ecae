//! The discrete Lagrangian of a matrix frequency as a formula, with cotangents and cosecants of the matrix `hW`: shares nothing
//! with the entire functions, kicks and drifts of evi-core.

use evi_core::generic::GenericSystem;
use evi_core::prelude::*;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use num_dual::HyperDual64;

use crate::tangent::{DiscreteAction, derivatives};

/// `½ (q₀'K_A q₀ + q₁'K_A q₁) + q₀'K_B q₁ − h Σ wⱼ U(xⱼ)`, `K_A = M W cot hW`, `K_B = −M W / sin hW`.
pub struct MatrixFrequencyAction {
    h: f64,
    weights: Vec<f64>,
    stiffness: DMatrix<f64>,
    reference: DVector<f64>,
    multipliers: Vec<f64>,
    /// `K_A` and `K_B`.
    own: DMatrix<f64>,
    mixed: DMatrix<f64>,
    /// By node: position per start and per end of a step.
    curves: Vec<(DMatrix<f64>, DMatrix<f64>)>,
}

impl MatrixFrequencyAction {
    /// For masses on the diagonal; `filter` is a function of the phase `w h`.
    pub fn new<const K: usize>(
        rule: &Quadrature<K>,
        (masses, stiffness): (&[f64], DMatrix<f64>),
        reference: &[f64],
        multipliers: &[f64],
        filter: impl Fn(f64) -> f64,
        h: f64,
    ) -> Self {
        let root =
            DMatrix::from_diagonal(&DVector::from_iterator(masses.len(), masses.iter().map(|m| m.sqrt())));
        let inverse = root.clone().try_inverse().expect("positive masses");
        let SymmetricEigen { eigenvalues, eigenvectors } =
            (&inverse * &stiffness * &inverse).symmetric_eigen();
        let function = |f: &dyn Fn(f64) -> f64| {
            // The smallest squared frequencies of the tests are zeros up to rounding.
            let values = eigenvalues.map(|squared| f(squared.max(1e-12).sqrt()));
            &eigenvectors * DMatrix::from_diagonal(&values) * eigenvectors.transpose()
        };
        let curves = rule
            .nodes()
            .iter()
            .map(|tau| {
                let start = function(&|w| filter(w * h) * (w * h * (1.0 - tau)).sin() / (w * h).sin());
                let end = function(&|w| filter(w * h) * (w * h * tau).sin() / (w * h).sin());
                (&inverse * start * &root, &inverse * end * &root)
            })
            .collect();
        Self {
            h,
            weights: rule.weights().to_vec(),
            reference: DVector::from_column_slice(reference),
            multipliers: multipliers.to_vec(),
            own: &root * function(&|w| w / (w * h).tan()) * &root,
            mixed: &root * function(&|w| -w / (w * h).sin()) * &root,
            stiffness,
            curves,
        }
    }

    /// `U`: potential and multipliers times constraints, less the quadratic part.
    fn rest(&self, system: &impl GenericSystem, t: f64, y: &[HyperDual64]) -> HyperDual64 {
        let number = HyperDual64::from;
        let x: Vec<HyperDual64> =
            y.iter().zip(self.reference.iter()).map(|(y, reference)| *y + *reference).collect();
        let mut residuals = vec![number(0.0); self.multipliers.len()];
        system.constraints(number(t), &x, &mut residuals);
        let mut rest = -system.lagrangian(number(t), &x, &vec![number(0.0); x.len()]);
        for (residual, multiplier) in residuals.iter().zip(&self.multipliers) {
            rest += *residual * *multiplier;
        }
        rest - form(&self.stiffness, y, y) * 0.5
    }
}

/// `aᵀ A b`.
fn form(matrix: &DMatrix<f64>, a: &[HyperDual64], b: &[HyperDual64]) -> HyperDual64 {
    let mut sum = HyperDual64::from(0.0);
    for (row, a) in a.iter().enumerate() {
        for (col, b) in b.iter().enumerate() {
            sum += *a * *b * matrix[(row, col)];
        }
    }
    sum
}

impl DiscreteAction for MatrixFrequencyAction {
    fn derivatives(
        &self,
        system: &impl GenericSystem,
        t: f64,
        q0: &[f64],
        q1: &[f64],
    ) -> (DVector<f64>, DMatrix<f64>) {
        let n = q0.len();
        derivatives(&[q0, q1].concat(), |ends| {
            let y: Vec<HyperDual64> = (0..2 * n).map(|i| ends[i] - self.reference[i % n]).collect();
            let (y0, y1) = y.split_at(n);
            let mut action =
                (form(&self.own, y0, y0) + form(&self.own, y1, y1)) * 0.5 + form(&self.mixed, y0, y1);
            for (weight, (start, end)) in self.weights.iter().zip(&self.curves) {
                let x: Vec<HyperDual64> = (0..n)
                    .map(|row| {
                        (0..n).fold(HyperDual64::from(0.0), |sum, col| {
                            sum + y0[col] * start[(row, col)] + y1[col] * end[(row, col)]
                        })
                    })
                    .collect();
                action -= self.rest(system, t, &x) * (weight * self.h);
            }
            action
        })
    }
}
