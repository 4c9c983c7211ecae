//! Galerkin steps and their derivatives without any emitted kernel and without the tables of evi-core: curves from raw functions,
//! derivatives of the action by hyper-dual numbers on the generic copy of the scene, Newton's iteration on dense matrices.

use evi_core::generic::GenericSystem;
use evi_core::prelude::*;
use nalgebra::{DMatrix, DVector};
use num_dual::HyperDual64;

use crate::tangent::{ConstraintDerivatives, derivatives, end_tangent_map};

/// The action of a step through `s + 1` Lobatto nodes.
pub struct GalerkinAction {
    h: f64,
    nodes: Vec<f64>,
    weights: Vec<f64>,
    /// `h` times the rate at node `j` per point `a`, one matrix per coordinate.
    rates: Vec<DMatrix<f64>>,
}

/// A step by this action.
pub struct GalerkinStep {
    /// Positions at the end.
    pub q: Vec<f64>,
    /// `DΨ`, the `2n × 2n` derivative in `(q, p)`.
    pub tangent_map: DMatrix<f64>,
}

/// The functions of a curve and their derivatives at `x`: powers, and for a frequency the last two replaced by cosine and sine.
fn functions(s: usize, u: f64, x: f64) -> (Vec<f64>, Vec<f64>) {
    let powers = if u == 0.0 { s + 1 } else { s - 1 };
    let mut values: Vec<f64> = (0..powers).map(|k| x.powi(k as i32)).collect();
    let mut rates: Vec<f64> =
        (0..powers).map(|k| if k == 0 { 0.0 } else { k as f64 * x.powi(k as i32 - 1) }).collect();
    if u != 0.0 {
        values.extend([(u * x).cos(), (u * x).sin()]);
        rates.extend([-u * (u * x).sin(), u * (u * x).cos()]);
    }
    (values, rates)
}

impl GalerkinAction {
    /// On the Lobatto rule with `K = s + 1` nodes, with one frequency (or 0) per coordinate, for steps of size `h`.
    ///
    /// # Panics
    /// If the points do not determine a curve.
    pub fn new<const K: usize, const N: usize>(frequencies: [f64; N], h: f64) -> Self {
        let rule = Quadrature::<K>::lobatto();
        let rates = frequencies.iter().map(|omega| {
            let (mut values, mut rates) = (DMatrix::zeros(K, K), DMatrix::zeros(K, K));
            for (node, &x) in rule.offsets().iter().enumerate() {
                let (value, rate) = functions(K - 1, omega * h, x);
                values.row_mut(node).copy_from_slice(&value);
                rates.row_mut(node).copy_from_slice(&rate);
            }
            rates * values.try_inverse().expect("points that determine a curve")
        });
        Self { h, nodes: rule.nodes().to_vec(), weights: rule.weights().to_vec(), rates: rates.collect() }
    }

    /// Gradient and Hessian of `L_d` in all points.
    fn derivatives(
        &self,
        system: &impl GenericSystem,
        t: f64,
        points: &[f64],
    ) -> (DVector<f64>, DMatrix<f64>) {
        let n = system.n_coordinates();
        derivatives(points, |points| {
            let mut action = HyperDual64::from(0.0);
            for (j, node) in self.nodes.iter().enumerate() {
                let x = &points[j * n..(j + 1) * n];
                let rate = |i: usize| {
                    let terms = (0..self.nodes.len()).map(|a| points[a * n + i] * self.rates[i][(j, a)]);
                    terms.fold(HyperDual64::from(0.0), |sum, term| sum + term) / self.h
                };
                let v: Vec<HyperDual64> = (0..n).map(rate).collect();
                let time = HyperDual64::from(t + node * self.h);
                action += system.lagrangian(time, x, &v) * (self.weights[j] * self.h);
            }
            action
        })
    }

    /// The step from `start`, and its derivative where it ends at `end`.
    ///
    /// # Panics
    /// If Newton's iteration does not find it, or the momentum of `end` is not that of the action but for its projection.
    #[track_caller]
    pub fn step<S: MechanicalSystem + GenericSystem>(
        &self,
        system: &S,
        start: &State<S>,
        end: &State<S>,
    ) -> GalerkinStep {
        let (n, m, s) = (S::N_COORDINATES, S::N_CONSTRAINTS, self.nodes.len() - 1);
        let (t, q0, v0) = (start.t(), start.q().as_ref(), start.v().as_ref());
        let time = |a: usize| t + self.nodes[a] * self.h;
        let mut points: Vec<f64> = (0..=s)
            .flat_map(|a| (0..n).map(move |i| (a, i)))
            .map(|(a, i)| q0[i] + self.nodes[a] * self.h * v0[i])
            .collect();
        // h times the multipliers, weighted.
        let mut impulses = DVector::<f64>::zeros(s * m);
        let dimension = s * (n + m);
        let mut matrix = DMatrix::zeros(dimension, dimension);
        for _ in 0..30 {
            let (gradient, hessian) = self.derivatives(system, t, &points);
            let mut residual = DVector::zeros(dimension);
            matrix.fill(0.0);
            matrix.view_mut((0, 0), (s * n, s * n)).copy_from(&-hessian.view((0, n), (s * n, s * n)));
            residual.rows_mut(0, s * n).copy_from(&-gradient.rows(0, s * n));
            for i in 0..n {
                residual[i] -= start.p()[i];
            }
            for a in 0..=s {
                let q = &points[a * n..(a + 1) * n];
                let constraints = ConstraintDerivatives::of(system, time(a), q);
                if a < s {
                    let impulse = impulses.rows(a * m, m).into_owned();
                    let mut rows = residual.rows_mut(a * n, n);
                    rows += constraints.jacobian().transpose() * &impulse;
                    matrix
                        .view_mut((a * n, s * n + a * m), (n, m))
                        .copy_from(&constraints.jacobian().transpose());
                    if a > 0 {
                        let mut block = matrix.view_mut((a * n, (a - 1) * n), (n, n));
                        block += constraints.weighted_curvature(&impulse);
                    }
                }
                if a > 0 {
                    let mut residuals = vec![HyperDual64::from(0.0); m];
                    let q: Vec<HyperDual64> = q.iter().map(|&q| HyperDual64::from(q)).collect();
                    system.constraints(HyperDual64::from(time(a)), &q, &mut residuals);
                    for c in 0..m {
                        residual[s * n + (a - 1) * m + c] = residuals[c].re;
                    }
                    matrix
                        .view_mut((s * n + (a - 1) * m, (a - 1) * n), (m, n))
                        .copy_from(constraints.jacobian());
                }
            }
            let update = matrix.clone().lu().solve(&residual).expect("a regular step");
            for k in 0..s * n {
                points[n + k] -= update[k];
            }
            impulses -= update.rows(s * n, s * m);
            if update.rows(0, s * n).amax() < 1e-15 {
                break;
            }
        }
        // The matrix belongs to the last iterate but one, which differs by round-off.
        let (gradient, hessian) = self.derivatives(system, t, &points);
        let at_start = ConstraintDerivatives::of(system, t, q0);
        let mut inputs = DMatrix::zeros(dimension, 2 * n);
        inputs.view_mut((0, 0), (s * n, n)).copy_from(&hessian.view((0, 0), (s * n, n)));
        let mut block = inputs.view_mut((0, 0), (n, n));
        block -= at_start.weighted_curvature(&impulses.rows(0, m).into_owned());
        inputs.view_mut((0, n), (n, n)).copy_from(&DMatrix::identity(n, n));
        let inner = matrix.lu().solve(&inputs).expect("a regular step");
        let dq1 = inner.rows((s - 1) * n, n).into_owned();
        let last = hessian.rows(s * n, n);
        let mut dp_minus = last.columns(n, s * n) * inner.rows(0, s * n);
        let mut from_q0 = dp_minus.columns_mut(0, n);
        from_q0 += last.columns(0, n);
        let p_minus = gradient.rows(s * n, n).into_owned();
        // The momenta of a step are sums over nodes and points of terms of size M q / h.
        let scale = self.nodes.len().pow(2) as f64
            * last.amax()
            * points.iter().fold(0.0, |largest: f64, q| largest.max(q.abs()));
        let tangent_map = end_tangent_map(system, end, (&dq1, &dp_minus), &p_minus, scale);
        GalerkinStep { q: points[s * n..].to_vec(), tangent_map }
    }
}
