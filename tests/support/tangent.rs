//! The derivative of a step, without any emitted kernel: implicit differentiation of the step equations, with second
//! derivatives of the discrete Lagrangian by hyper-dual numbers on the generic copy of the scene.

use evi_core::generic::GenericSystem;
use evi_core::prelude::*;
use evi_core::scheme::NodeCoefficients;
use nalgebra::{DMatrix, DVector};
use num_dual::HyperDual64;

/// Gradient and Hessian of a function at `x`.
pub fn derivatives(
    x: &[f64],
    function: impl Fn(&[HyperDual64]) -> HyperDual64,
) -> (DVector<f64>, DMatrix<f64>) {
    let k = x.len();
    let (mut gradient, mut hessian) = (DVector::zeros(k), DMatrix::zeros(k, k));
    for row in 0..k {
        for col in 0..k {
            let point: Vec<HyperDual64> = (0..k)
                .map(|i| {
                    let seed = |index: usize| if i == index { 1.0 } else { 0.0 };
                    HyperDual64::new(x[i], seed(row), seed(col), 0.0)
                })
                .collect();
            let value = function(&point);
            gradient[row] = value.eps1;
            hessian[(row, col)] = value.eps1eps2;
        }
    }
    (gradient, hessian)
}

/// The numbers as a column.
pub fn vector(values: impl AsRef<[f64]>) -> DVector<f64> {
    DVector::from_column_slice(values.as_ref())
}

/// `[[a, b], [c, d]]`.
pub fn blocks(a: &DMatrix<f64>, b: &DMatrix<f64>, c: &DMatrix<f64>, d: &DMatrix<f64>) -> DMatrix<f64> {
    let (top, left) = (a.nrows(), a.ncols());
    DMatrix::from_fn(top + c.nrows(), left + b.ncols(), |row, col| match (row < top, col < left) {
        (true, true) => a[(row, col)],
        (true, false) => b[(row, col - left)],
        (false, true) => c[(row - top, col)],
        (false, false) => d[(row - top, col - left)],
    })
}

/// Derivatives of the constraints at a configuration.
pub struct ConstraintDerivatives {
    /// `G`.
    jacobian: DMatrix<f64>,
    /// `∂²φ/∂q²`, one matrix per constraint.
    curvatures: Vec<DMatrix<f64>>,
}

impl ConstraintDerivatives {
    /// At time `t` and configuration `q`.
    pub fn of(system: &impl GenericSystem, t: f64, q: &[f64]) -> Self {
        let (n, m) = (system.n_coordinates(), system.n_constraints());
        let mut jacobian = DMatrix::zeros(m, n);
        let curvatures = (0..m)
            .map(|c| {
                let (gradient, curvature) = derivatives(q, |q| {
                    let mut residuals = vec![HyperDual64::from(0.0); m];
                    system.constraints(HyperDual64::from(t), q, &mut residuals);
                    residuals[c]
                });
                jacobian.set_row(c, &gradient.transpose());
                curvature
            })
            .collect();
        Self { jacobian, curvatures }
    }

    /// `G`.
    pub const fn jacobian(&self) -> &DMatrix<f64> {
        &self.jacobian
    }

    /// `Σ_c x_c ∂²φ_c/∂q²`.
    pub fn weighted_curvature(&self, x: &DVector<f64>) -> DMatrix<f64> {
        let n = self.jacobian.ncols();
        self.curvatures.iter().zip(x).fold(DMatrix::zeros(n, n), |sum, (curvature, x)| sum + curvature * *x)
    }

    /// The matrix of rows `vᵀ ∂²φ_c/∂q²`: how `G v` changes with `q`.
    pub fn rate_gradient(&self, v: &DVector<f64>) -> DMatrix<f64> {
        let (m, n) = self.jacobian.shape();
        DMatrix::from_fn(m, n, |c, col| self.curvatures[c].column(col).dot(v))
    }

    /// The impulse `x` with `Gᵀ x = momentum`, which must exist to round-off of the momenta: the step
    /// equations hold.
    #[track_caller]
    pub fn impulse(&self, momentum: &DVector<f64>, scale: f64) -> DVector<f64> {
        let transposed = self.jacobian.transpose();
        let gram = &self.jacobian * &transposed;
        let impulse = match gram.nrows() {
            // nalgebra does not solve systems without unknowns.
            0 => DVector::zeros(0),
            _ => gram.lu().solve(&(&self.jacobian * momentum)).expect("independent constraints"),
        };
        let residual = (momentum - transposed * &impulse).amax();
        // Measured at most half a rounding.
        assert!(residual <= 4.0 * f64::EPSILON * scale, "the step equations do not hold: {residual:e}");
        impulse
    }
}

/// The discrete Lagrangian of a scheme, from which its step follows.
pub trait DiscreteAction {
    /// Gradient and Hessian of `L_d` in `(q₀, q₁)`.
    fn derivatives(
        &self,
        system: &impl GenericSystem,
        t: f64,
        q0: &[f64],
        q1: &[f64],
    ) -> (DVector<f64>, DMatrix<f64>);

    /// `DΨ`, the `2n × 2n` derivative of the step from `start` to `end` in `(q, p)`.
    #[track_caller]
    fn tangent_map<S: MechanicalSystem + GenericSystem>(
        &self,
        system: &S,
        start: &State<S>,
        end: &State<S>,
    ) -> DMatrix<f64> {
        let (n, m) = (S::N_COORDINATES, S::N_CONSTRAINTS);
        let (q0, q1) = (start.q().as_ref(), end.q().as_ref());
        let (gradient, hessian) = self.derivatives(system, start.t(), q0, q1);
        let block = |row: usize, col: usize| hessian.view((row * n, col * n), (n, n)).into_owned();
        let (d11, d12, d21, d22) = (block(0, 0), block(0, 1), block(1, 0), block(1, 1));
        let (d1, d2) = (gradient.rows(0, n).into_owned(), gradient.rows(n, n).into_owned());
        let at_start = ConstraintDerivatives::of(system, start.t(), q0);
        let at_end = ConstraintDerivatives::of(system, end.t(), q1);
        // The momenta of a step are differences of terms of size M q / h.
        let scale = d12.amax() * vector(q0).amax();

        // −D₁L_d + G₀ᵀ Λ = p₀, φ(q₁) = 0: the derivatives of q₁ with respect to (q₀, p₀).
        let impulse = at_start.impulse(&(vector(start.p()) + &d1), scale);
        let zero = DMatrix::zeros(m, m);
        let kkt = blocks(&-&d12, &at_start.jacobian.transpose(), &at_end.jacobian, &zero);
        let from_q0 = d11 - at_start.weighted_curvature(&impulse);
        let nothing = DMatrix::zeros(m, n);
        let inputs = blocks(&from_q0, &DMatrix::identity(n, n), &nothing, &nothing);
        let dq1 = kkt.lu().solve(&inputs).expect("a regular step").rows(0, n).into_owned();

        // p⁻ = D₂L_d;  ∂L/∂v + G₁ᵀ N = p⁻, G₁ v₁ = 0: the derivatives of v₁, and of p₁ = ∂L/∂v.
        let dp_minus =
            blocks(&d21, &DMatrix::zeros(n, n), &DMatrix::zeros(0, n), &DMatrix::zeros(0, n)) + d22 * &dq1;
        end_tangent_map(system, end, (&dq1, &dp_minus), &d2, scale)
    }
}

/// `DΨ` of a step that ends at `end` with the momentum `p⁻` before its projection, from the derivatives of `q₁` and `p⁻`.
#[track_caller]
pub fn end_tangent_map<S: MechanicalSystem + GenericSystem>(
    system: &S,
    end: &State<S>,
    (dq1, dp_minus): (&DMatrix<f64>, &DMatrix<f64>),
    p_minus: &DVector<f64>,
    scale: f64,
) -> DMatrix<f64> {
    let (n, m) = (S::N_COORDINATES, S::N_CONSTRAINTS);
    let q1 = end.q().as_ref();
    let at_end = ConstraintDerivatives::of(system, end.t(), q1);
    let impulse = at_end.impulse(&(p_minus - vector(end.p())), scale);
    let velocity = vector(end.v());
    let state = [q1, end.v().as_ref()].concat();
    let t = HyperDual64::from(end.t());
    let (_, hessian) = derivatives(&state, |state| system.lagrangian(t, &state[..n], &state[n..]));
    let (l_vq, l_vv) = (hessian.view((n, 0), (n, n)).into_owned(), hessian.view((n, n), (n, n)).into_owned());
    let zero = DMatrix::zeros(m, m);
    let kkt = blocks(&l_vv, &at_end.jacobian.transpose(), &at_end.jacobian, &zero);
    let momentum_rows = dp_minus - (&l_vq + at_end.weighted_curvature(&impulse)) * dq1;
    let constraint_rows = -at_end.rate_gradient(&velocity) * dq1;
    let mut inputs = DMatrix::zeros(n + m, 2 * n);
    inputs.rows_mut(0, n).copy_from(&momentum_rows);
    inputs.rows_mut(n, m).copy_from(&constraint_rows);
    let dv1 = kkt.lu().solve(&inputs).expect("a regular mass matrix").rows(0, n).into_owned();
    let dp1 = l_vq * dq1 + l_vv * dv1;
    let mut tangent_map = DMatrix::zeros(2 * n, 2 * n);
    tangent_map.rows_mut(0, n).copy_from(dq1);
    tangent_map.rows_mut(n, n).copy_from(&dp1);
    tangent_map
}

/// The discrete Lagrangian of a scheme, as a formula: nodes, weights, and curves per coordinate.
pub struct Action {
    h: f64,
    weights: Vec<f64>,
    offsets: Vec<f64>,
    /// By node, then coordinate.
    curves: Vec<Vec<NodeCoefficients>>,
}

impl Action {
    /// On the nodes of `rule`, with one frequency per coordinate, for steps of size `h`.
    pub fn new<const K: usize, const N: usize>(
        rule: &Quadrature<K>,
        frequencies: [Frequency; N],
        h: f64,
    ) -> Self {
        let curves = rule
            .offsets()
            .iter()
            .map(|&offset| frequencies.map(|f| NodeCoefficients::new(f, h, offset)).to_vec())
            .collect();
        Self { h, weights: rule.weights().to_vec(), offsets: rule.offsets().to_vec(), curves }
    }
}

impl DiscreteAction for Action {
    fn derivatives(
        &self,
        system: &impl GenericSystem,
        t: f64,
        q0: &[f64],
        q1: &[f64],
    ) -> (DVector<f64>, DMatrix<f64>) {
        let n = q0.len();
        let number = HyperDual64::from;
        derivatives(&[q0, q1].concat(), |ends| {
            let mut action = number(0.0);
            for (node, curves) in self.curves.iter().enumerate() {
                let (mut x, mut v) = (vec![number(0.0); n], vec![number(0.0); n]);
                for (i, c) in curves.iter().enumerate() {
                    let (s, d) = ((ends[i] + ends[n + i]) * 0.5, ends[n + i] - ends[i]);
                    x[i] = s * c.even + d * c.odd;
                    v[i] = (s * c.even_rate + d * c.odd_rate) / self.h;
                }
                let node_time = number(t + (0.5 + self.offsets[node]) * self.h);
                action += system.lagrangian(node_time, &x, &v) * (self.weights[node] * self.h);
            }
            action
        })
    }
}

/// Vectors tangent to `T*N` at a state, in two pictures of the same columns.
pub struct TangentSpace {
    /// Orthonormal `(δq, δp)`.
    pub momentum: DMatrix<f64>,
    /// The same vectors as `(δq, δv)`.
    pub velocity: DMatrix<f64>,
}

impl TangentSpace {
    /// At a state.
    pub fn at<S: MechanicalSystem + GenericSystem>(system: &S, state: &State<S>) -> Self {
        let (n, m) = (S::N_COORDINATES, S::N_CONSTRAINTS);
        let constraints = ConstraintDerivatives::of(system, state.t(), state.q().as_ref());
        let rate_gradient = constraints.rate_gradient(&vector(state.v()));
        let nothing = DMatrix::zeros(m, n);
        let conditions = blocks(&constraints.jacobian, &nothing, &rate_gradient, &constraints.jacobian);
        // The null space: right singular vectors of the square matrix that has zero rows below the
        // conditions.
        let mut square = DMatrix::zeros(2 * n, 2 * n);
        square.rows_mut(0, 2 * m).copy_from(&conditions);
        let svd = square.svd(false, true);
        let rows = svd.v_t.expect("asked for");
        let null: Vec<usize> = (0..2 * n).filter(|&i| svd.singular_values[i] < 1e-9).collect();
        assert_eq!(null.len(), 2 * (n - m), "independent constraints");
        let velocity = DMatrix::from_fn(2 * n, null.len(), |row, col| rows[(null[col], row)]);
        let coordinates = [state.q().as_ref(), state.v().as_ref()].concat();
        let t = HyperDual64::from(state.t());
        let (_, hessian) = derivatives(&coordinates, |x| system.lagrangian(t, &x[..n], &x[n..]));
        let mut momentum = velocity.clone();
        momentum.rows_mut(n, n).copy_from(&(hessian.rows(n, n) * &velocity));
        let qr = momentum.qr();
        let inverse = qr.r().try_inverse().expect("independent vectors");
        Self { momentum: qr.q(), velocity: velocity * inverse }
    }
}

/// `Wᵀ J W`: the symplectic form on all pairs of columns of `W`.
pub fn form(w: &DMatrix<f64>) -> DMatrix<f64> {
    let n = w.nrows() / 2;
    w.rows(0, n).transpose() * w.rows(n, n) - w.rows(n, n).transpose() * w.rows(0, n)
}

/// How much the symplectic form changes from the columns of `before` to their images `after`, in roundings of `‖DΨ‖²`.
///
/// # Panics
/// If the form vanishes or nothing moves.
#[track_caller]
pub fn symplectic_defect(before: &DMatrix<f64>, after: &DMatrix<f64>) -> f64 {
    let (form_before, form_after) = (form(before), form(after));
    assert!(form_before.amax() > 0.1, "vacuous: the form vanishes");
    assert!((after - before).amax() > 0.01, "vacuous: nothing moves");
    let norm = after.clone().svd(false, false).singular_values.max();
    let roundings = (form_after - form_before).amax() / (f64::EPSILON * norm * norm);
    println!("{}: {roundings:.1} roundings, norm {norm:.2}", core::panic::Location::caller());
    roundings
}
