//! What the steps preserve: the symplectic form on the constraint manifold, time reversal, momentum maps.
//!
//! A step maps `T*N = {φ(q) = 0, G ∂H/∂p = 0}` to itself. Its derivative `DΨ` comes here from the step
//! equations, by implicit differentiation at the step that was taken, with second derivatives of the discrete
//! Lagrangian by hyper-dual numbers on the generic copy of the scene: no emitted kernel takes part. Then
//! `w₁ᵀ DΨᵀ J DΨ w₂ = w₁ᵀ J w₂` must hold for vectors tangent to `T*N`, and only for those. Controls show
//! that the test fails for maps that are not symplectic.

use evi_core::baseline::Rk4;
use evi_core::generic::GenericSystem;
use evi_core::prelude::*;
use evi_core::scheme::{Interpolant, NodeCoefficients};
use evi_examples::{DoublePendulum, GRAVITY, Pendulum, SphericalPendulum, Start};
use evi_tests::scenes::{
    ChargedSphericalPendulum, DoublePendulumInAngles, Dumbbell, KapitzaPendulum, RelativisticBead,
};
use evi_tests::{Random, largest_difference, observed_order};
use nalgebra::{DMatrix, DVector};
use num_dual::HyperDual64;

/// Gradient and Hessian of a function at `x`.
fn derivatives(x: &[f64], function: impl Fn(&[HyperDual64]) -> HyperDual64) -> (DVector<f64>, DMatrix<f64>) {
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

fn vector(values: impl AsRef<[f64]>) -> DVector<f64> {
    DVector::from_column_slice(values.as_ref())
}

/// `[[a, b], [c, d]]`.
fn blocks(a: &DMatrix<f64>, b: &DMatrix<f64>, c: &DMatrix<f64>, d: &DMatrix<f64>) -> DMatrix<f64> {
    let (top, left) = (a.nrows(), a.ncols());
    DMatrix::from_fn(top + c.nrows(), left + b.ncols(), |row, col| match (row < top, col < left) {
        (true, true) => a[(row, col)],
        (true, false) => b[(row, col - left)],
        (false, true) => c[(row - top, col)],
        (false, false) => d[(row - top, col - left)],
    })
}

/// Derivatives of the constraints at a configuration.
struct ConstraintDerivatives {
    /// `G`.
    jacobian: DMatrix<f64>,
    /// `∂²φ/∂q²`, one matrix per constraint.
    curvatures: Vec<DMatrix<f64>>,
}

impl ConstraintDerivatives {
    fn of(system: &impl GenericSystem, t: f64, q: &[f64]) -> Self {
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

    /// `Σ_c x_c ∂²φ_c/∂q²`.
    fn weighted_curvature(&self, x: &DVector<f64>) -> DMatrix<f64> {
        let n = self.jacobian.ncols();
        self.curvatures.iter().zip(x).fold(DMatrix::zeros(n, n), |sum, (curvature, x)| sum + curvature * *x)
    }

    /// The matrix of rows `vᵀ ∂²φ_c/∂q²`: how `G v` changes with `q`.
    fn rate_gradient(&self, v: &DVector<f64>) -> DMatrix<f64> {
        let (m, n) = self.jacobian.shape();
        DMatrix::from_fn(m, n, |c, col| self.curvatures[c].column(col).dot(v))
    }

    /// The impulse `x` with `Gᵀ x = momentum`, which must exist to round-off of the momenta: the step
    /// equations hold.
    #[track_caller]
    fn impulse(&self, momentum: &DVector<f64>, scale: f64) -> DVector<f64> {
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

/// The discrete Lagrangian of a scheme, as a formula: nodes, weights, and curves per coordinate.
struct Action {
    h: f64,
    weights: Vec<f64>,
    offsets: Vec<f64>,
    /// By node, then coordinate.
    curves: Vec<Vec<NodeCoefficients>>,
}

impl Action {
    fn new<const K: usize, const N: usize>(
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

    /// Gradient and Hessian of `L_d` in `(q₀, q₁)`.
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
        let impulse = at_end.impulse(&(d2 - vector(end.p())), scale);
        let velocity = vector(end.v());
        let state = [q1, end.v().as_ref()].concat();
        let t = HyperDual64::from(end.t());
        let (_, hessian) = derivatives(&state, |state| system.lagrangian(t, &state[..n], &state[n..]));
        let (l_vq, l_vv) =
            (hessian.view((n, 0), (n, n)).into_owned(), hessian.view((n, n), (n, n)).into_owned());
        let kkt = blocks(&l_vv, &at_end.jacobian.transpose(), &at_end.jacobian, &zero);
        let momentum_rows = dp_minus - (&l_vq + at_end.weighted_curvature(&impulse)) * &dq1;
        let constraint_rows = -at_end.rate_gradient(&velocity) * &dq1;
        let mut inputs = DMatrix::zeros(n + m, 2 * n);
        inputs.rows_mut(0, n).copy_from(&momentum_rows);
        inputs.rows_mut(n, m).copy_from(&constraint_rows);
        let dv1 = kkt.lu().solve(&inputs).expect("a regular mass matrix").rows(0, n).into_owned();
        let dp1 = l_vq * &dq1 + l_vv * dv1;
        let mut tangent_map = DMatrix::zeros(2 * n, 2 * n);
        tangent_map.rows_mut(0, n).copy_from(&dq1);
        tangent_map.rows_mut(n, n).copy_from(&dp1);
        tangent_map
    }
}

/// Vectors tangent to `T*N` at a state, in two pictures of the same columns.
struct TangentSpace {
    /// Orthonormal `(δq, δp)`.
    momentum: DMatrix<f64>,
    /// The same vectors as `(δq, δv)`.
    velocity: DMatrix<f64>,
}

impl TangentSpace {
    fn at<S: MechanicalSystem + GenericSystem>(system: &S, state: &State<S>) -> Self {
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
fn form(w: &DMatrix<f64>) -> DMatrix<f64> {
    let n = w.nrows() / 2;
    w.rows(0, n).transpose() * w.rows(n, n) - w.rows(n, n).transpose() * w.rows(0, n)
}

mod symplecticity {
    use super::*;

    /// Defects are below this many roundings times `‖DΨ‖²` on the tangent space; measured 1.9.
    const ROUNDINGS: f64 = 8.0;
    const H: f64 = 0.05;

    /// Steps of `scheme` from `start`, against the discrete Lagrangian of `rule` and `frequencies`.
    #[track_caller]
    fn check<S, F, const K: usize, const N: usize>(
        system: S,
        scheme: Evi<K, F>,
        (rule, frequencies): (Quadrature<K>, [Frequency; N]),
        start: Start<N>,
        steps: usize,
    ) where
        S: MechanicalSystem + GenericSystem + Clone,
        F: Interpolant<S>,
        [f64; N]: Into<S::PerCoordinate<f64>>,
    {
        let action = Action::new(&rule, frequencies, H);
        let mut run = Simulation::new(system.clone(), scheme).start(start.q, start.v).expect("a start");
        let before = TangentSpace::at(&system, run.state()).momentum;
        let mut after = before.clone();
        for _ in 0..steps {
            let state = run.state().clone();
            let next = run.advance().expect("a step");
            after = action.tangent_map(&system, &state, next) * after;
        }
        let (form_before, form_after) = (form(&before), form(&after));
        assert!(form_before.amax() > 0.1, "vacuous: the form vanishes");
        assert!((&after - &before).amax() > 0.01, "vacuous: nothing moves");
        let norm = after.clone().svd(false, false).singular_values.max();
        let roundings = (form_after - form_before).amax() / (f64::EPSILON * norm * norm);
        println!("{}: {roundings:.1} roundings, norm {norm:.2}", core::panic::Location::caller());
        assert!(
            roundings <= ROUNDINGS,
            "the form changes by {roundings:.0} roundings of ‖DΨ‖² = {:e}",
            norm * norm
        );
    }

    const LINEAR: Frequency = Frequency::ZERO;
    const OMEGA: Frequency = Frequency::Trigonometric(3.13);

    fn midpoint() -> Quadrature<1> {
        Quadrature::midpoint()
    }

    fn simpson() -> Quadrature<3> {
        Quadrature::uniform()
    }

    /// Angles and rates of the unequal double pendulum, at random.
    fn random_start(seed: u64) -> (DoublePendulum, Start<4>) {
        let angles = DoublePendulumInAngles::UNEQUAL;
        let mut random = Random::new(seed);
        (angles.constrained(), angles.cartesian(random.array(-1.5, 1.5), random.array(-3.0, 3.0)))
    }

    #[test]
    fn double_pendulum_on_straight_curves() {
        for seed in 0..5 {
            for steps in [1, 5] {
                let (system, start) = random_start(seed);
                check(system, Evi::midpoint(H), (midpoint(), [LINEAR; 4]), start, steps);
                check(system, Evi::simpson(H), (simpson(), [LINEAR; 4]), start, steps);
            }
        }
    }

    #[test]
    fn double_pendulum_on_trigonometric_curves() {
        for seed in 0..5 {
            for steps in [1, 5] {
                let (system, start) = random_start(seed);
                let curves = [OMEGA; 4];
                check(system, Evi::midpoint(H).frequency(OMEGA), (midpoint(), curves), start, steps);
                check(system, Evi::simpson(H).frequency(OMEGA), (simpson(), curves), start, steps);
            }
        }
    }

    #[test]
    fn double_pendulum_on_unequal_curves() {
        let curves = [OMEGA, Frequency::Hyperbolic(2.0), LINEAR, Frequency::Trigonometric(5.0)];
        for seed in 0..5 {
            for steps in [1, 5] {
                let (system, start) = random_start(seed);
                check(system, Evi::midpoint(H).frequencies(curves), (midpoint(), curves), start, steps);
                check(system, Evi::simpson(H).frequencies(curves), (simpson(), curves), start, steps);
            }
        }
    }

    #[test]
    fn asymmetric_nodes_are_symplectic_too() {
        let (system, start) = random_start(7);
        let rule = Quadrature::interpolatory([0.0]).expect("a rule");
        check(system, Evi::new(rule, H), (rule, [LINEAR; 4]), start, 3);
    }

    #[test]
    fn spherical_pendulum() {
        let system = SphericalPendulum::UNIT;
        let start = system.one_radian();
        check(system, Evi::midpoint(H), (midpoint(), [LINEAR; 3]), start, 5);
        check(system, Evi::simpson(H), (simpson(), [LINEAR; 3]), start, 5);
        check(system, Evi::midpoint(H).frequency(OMEGA), (midpoint(), [OMEGA; 3]), start, 5);
        check(system, Evi::simpson(H).frequency(OMEGA), (simpson(), [OMEGA; 3]), start, 5);
    }

    #[test]
    fn configuration_dependent_mass() {
        let system = DoublePendulumInAngles::UNEQUAL;
        let start = DoublePendulumInAngles::MODERATE;
        let curves = [OMEGA, Frequency::Hyperbolic(2.0)];
        check(system, Evi::midpoint(H), (midpoint(), [LINEAR; 2]), start, 5);
        check(system, Evi::simpson(H), (simpson(), [LINEAR; 2]), start, 5);
        check(system, Evi::midpoint(H).frequency(OMEGA), (midpoint(), [OMEGA; 2]), start, 5);
        check(system, Evi::simpson(H).frequencies(curves), (simpson(), curves), start, 5);
    }

    #[test]
    fn gyroscopic_coupling_with_a_constraint() {
        let system = ChargedSphericalPendulum::STANDARD;
        let start = system.one_radian();
        check(system, Evi::midpoint(H), (midpoint(), [LINEAR; 3]), start, 5);
        check(system, Evi::simpson(H).frequency(OMEGA), (simpson(), [OMEGA; 3]), start, 5);
    }

    #[test]
    fn not_quadratic_in_velocity_with_a_constraint() {
        let (system, start) = (RelativisticBead::STANDARD, RelativisticBead::at_angle(1.0, -2.0));
        check(system, Evi::midpoint(H), (midpoint(), [LINEAR; 2]), start, 5);
        check(system, Evi::simpson(H).frequency(OMEGA), (simpson(), [OMEGA; 2]), start, 5);
    }

    /// Off the tangent space the form is not preserved: what is tested is the right restriction.
    #[test]
    fn holds_on_the_tangent_space_only() {
        let (system, start) = random_start(3);
        let mut run = Simulation::new(system, Evi::midpoint(H)).start(start.q, start.v).expect("a start");
        let state = run.state().clone();
        let next = run.advance().expect("a step");
        let tangent_map = Action::new(&midpoint(), [LINEAR; 4], H).tangent_map(&system, &state, next);
        let defect = (form(&tangent_map) - form(&DMatrix::identity(8, 8))).amax();
        assert!(defect > 0.1, "{defect}");
    }

    /// The tangent map against central differences of the steps themselves, from starts displaced along the
    /// manifold.
    #[test]
    fn the_tangent_map_is_the_derivative_of_the_step() {
        const DISPLACEMENT: f64 = 1e-5;
        let curves = [OMEGA, Frequency::Hyperbolic(2.0), LINEAR, Frequency::Trigonometric(5.0)];
        let (system, start) = random_start(1);
        let simulation = Simulation::new(system, Evi::simpson(H).frequencies(curves));
        let mut run = simulation.start(start.q, start.v).expect("a start");
        let state = run.state().clone();
        let next = run.advance().expect("a step");
        let tangent_map = Action::new(&simpson(), curves, H).tangent_map(&system, &state, next);
        let space = TangentSpace::at(&system, &state);
        for column in 0..space.velocity.ncols() {
            let displaced = |sign: f64| {
                let along = |i: usize| sign * DISPLACEMENT * space.velocity[(i, column)];
                let q: [f64; 4] = core::array::from_fn(|i| state.q()[i] + along(i));
                let v: [f64; 4] = core::array::from_fn(|i| state.v()[i] + along(4 + i));
                let mut run = simulation.start_projected(0.0, q, v).expect("a start");
                let phase = |state: &State<_>| vector([*state.q(), *state.p()].concat());
                let before = phase(run.state());
                (before, phase(run.advance().expect("a step")))
            };
            let ((before_plus, after_plus), (before_minus, after_minus)) = (displaced(1.0), displaced(-1.0));
            let difference = |plus: DVector<f64>, minus: DVector<f64>| (plus - minus) / (2.0 * DISPLACEMENT);
            let (before, after) =
                (difference(before_plus, before_minus), difference(after_plus, after_minus));
            assert!(before.amax() > 0.1 && after.amax() > 0.1, "vacuous");
            // Truncation δ² and round-off ε q / δ: both 1e-10 times derivatives of size 10.
            let start_error = (&before - space.momentum.column(column)).amax();
            assert!(start_error <= 1e-8, "tangent vector {column} is off by {start_error:e}");
            let error = (after - &tangent_map * before).amax();
            println!("column {column}: {start_error:e}, {error:e}");
            assert!(error <= 1e-8, "image {column} is off by {error:e}");
        }
    }
}

/// Maps that are not symplectic, and are seen not to be.
mod controls {
    use super::*;

    const PENDULUM: Pendulum = Pendulum { m: 1.0, l: 1.0, g: GRAVITY };
    const START: [f64; 2] = [1.0, 1.5];

    /// `det DΨ − 1` of a map of the phase plane, by central differences: good to `δ² + ε/δ`, some 1e-10.
    fn determinant_defect(map: impl Fn([f64; 2]) -> [f64; 2]) -> f64 {
        const DISPLACEMENT: f64 = 1e-5;
        let column = |i: usize| {
            let displaced = |sign: f64| {
                let mut point = START;
                point[i] += sign * DISPLACEMENT;
                map(point)
            };
            let (plus, minus) = (displaced(1.0), displaced(-1.0));
            [(plus[0] - minus[0]) / (2.0 * DISPLACEMENT), (plus[1] - minus[1]) / (2.0 * DISPLACEMENT)]
        };
        let (left, right) = (column(0), column(1));
        left[0] * right[1] - left[1] * right[0] - 1.0
    }

    /// One step of a scheme that is prepared for the state it starts from; `p = v` for this pendulum.
    fn step<F: Scheme<Pendulum>>(scheme: F, [q, p]: [f64; 2]) -> [f64; 2] {
        let mut run = Simulation::new(PENDULUM, scheme).start([q], [p]).expect("a start");
        let state = run.advance().expect("a step");
        [state.q()[0], state.p()[0]]
    }

    const STEPS: [f64; 4] = [0.2, 0.1, 0.05, 0.025];

    #[test]
    fn a_frequency_that_follows_the_state_loses_symplecticity_in_third_order() {
        let defects =
            STEPS.map(|h| determinant_defect(|z| step(Evi::simpson(h).frequency(z[1].abs()), z)).abs());
        let order = observed_order(&STEPS, &defects);
        println!("defects {defects:?}, order {order}");
        assert!(defects[0] > 1e-3, "{defects:?}");
        assert!((order - 3.0).abs() < 0.2, "order {order}: {defects:?}");
    }

    #[test]
    fn a_constant_frequency_does_not() {
        for h in STEPS {
            let defect = determinant_defect(|z| step(Evi::simpson(h).frequency(START[1]), z));
            assert!(defect.abs() < 1e-8, "{defect:e} at h = {h}");
        }
    }

    #[test]
    fn rk4_contracts_the_phase_plane() {
        let defect = determinant_defect(|z| step(Rk4::new(0.2), z));
        println!("rk4 {defect:e}");
        assert!(defect.abs() > 1e-5, "{defect:e}");
    }
}

mod reversibility {
    use super::*;

    /// Distance from the start in `q` and `v` after `steps` steps there and as many back.
    #[track_caller]
    fn there_and_back<S, F, const N: usize>(
        system: S,
        scheme: impl Fn(f64) -> F,
        start: Start<N>,
        steps: usize,
    ) -> f64
    where
        S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Clone,
        F: Scheme<S>,
    {
        const H: f64 = 0.02;
        let mut there = Simulation::new(system.clone(), scheme(H)).start(start.q, start.v).expect("a start");
        for _ in 0..steps {
            there.advance().expect("a step");
        }
        let turn = there.state();
        assert!(largest_difference(turn.q(), &start.q) > 0.1, "vacuous: nothing moves");
        let mut back = Simulation::new(system, scheme(-H))
            .start_at(turn.t(), *turn.q(), *turn.v())
            .expect("the end of a run is a start");
        for _ in 0..steps {
            back.advance().expect("a step back");
        }
        let end = back.state();
        assert!(end.t().abs() < 1e-12, "back at t = {}", end.t());
        let distance = largest_difference(end.q(), &start.q).max(largest_difference(end.v(), &start.v));
        println!("{}: {distance:e}", core::panic::Location::caller());
        distance
    }

    /// 32 roundings of velocities of size 4 (8.9e-16): after 100 steps, grown by the motion; measured 5.5 of
    /// them.
    const ROUND_OFF: f64 = 32.0 * 4.0 * f64::EPSILON;

    #[track_caller]
    fn check<S, F, const N: usize>(system: S, scheme: impl Fn(f64) -> F, start: Start<N>)
    where
        S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Clone,
        F: Scheme<S>,
    {
        let distance = there_and_back(system, scheme, start, 50);
        assert!(distance <= ROUND_OFF, "misses the start by {distance:e}");
    }

    fn double_pendulum() -> (DoublePendulum, Start<4>) {
        let angles = DoublePendulumInAngles::UNEQUAL;
        let Start { q, v } = DoublePendulumInAngles::MODERATE;
        (angles.constrained(), angles.cartesian(q, v))
    }

    #[test]
    fn symmetric_nodes_return_to_the_start() {
        let (system, start) = double_pendulum();
        check(system, Evi::midpoint, start);
        check(system, Evi::simpson, start);
        check(system, |h| Evi::midpoint(h).frequency(3.13), start);
        check(system, |h| Evi::simpson(h).frequency(3.13), start);
        check(system, |h| Evi::simpson(h).frequency(Frequency::Hyperbolic(2.0)), start);
        check(system, |h| Evi::new(Quadrature::<3>::gauss(), h).frequency(3.13), start);
        check(system, |h| Evi::new(Quadrature::<4>::lobatto(), h).frequency(3.13), start);
    }

    #[test]
    fn every_structure_returns_to_the_start() {
        let angles = DoublePendulumInAngles::UNEQUAL;
        check(angles, |h| Evi::simpson(h).frequency(3.13), DoublePendulumInAngles::MODERATE);
        let charged = ChargedSphericalPendulum::STANDARD;
        check(charged, |h| Evi::simpson(h).frequency(3.13), charged.one_radian());
        let bead = RelativisticBead::STANDARD;
        check(bead, |h| Evi::simpson(h).frequency(3.13), RelativisticBead::at_angle(1.0, -2.0));
        // Backward steps must see the moving constraint and the time at the nodes go backward.
        let moving = KapitzaPendulum::STANDARD;
        check(moving, |h| Evi::simpson(0.1 * h).frequency(3.13), moving.near_inverted());
    }

    #[test]
    fn the_left_rectangle_does_not() {
        let (system, start) = double_pendulum();
        let rule = Quadrature::interpolatory([0.0]).expect("a rule");
        assert!(!rule.is_symmetric());
        let distance = there_and_back(system, |h| Evi::new(rule, h), start, 50);
        assert!(distance > 1e-2, "misses the start by {distance:e} only");
    }
}

mod momentum_maps {
    use super::*;

    /// `x p_y − y p_x` of the body whose coordinates begin at `first`.
    fn angular_momentum(q: &[f64], p: &[f64], first: usize) -> f64 {
        q[first] * p[first + 1] - q[first + 1] * p[first]
    }

    /// Largest change of a function of `(q, p)` along a run.
    #[track_caller]
    fn largest_change<S, F, const N: usize>(
        system: S,
        scheme: F,
        start: Start<N>,
        steps: usize,
        quantity: impl Fn(&[f64], &[f64]) -> f64,
    ) -> f64
    where
        S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
        F: Scheme<S>,
    {
        let mut run = Simulation::new(system, scheme).start(start.q, start.v).expect("a start");
        let at_start = quantity(run.state().q(), run.state().p());
        assert!(at_start.abs() > 0.1, "vacuous: the quantity is {at_start}");
        let mut largest = 0.0_f64;
        for _ in 0..steps {
            let state = run.advance().expect("a step");
            largest = largest.max((quantity(state.q(), state.p()) - at_start).abs());
        }
        println!("{}: {largest:e}", core::panic::Location::caller());
        largest
    }

    /// Momenta of size 4 on an arm of 1, rounded at random in each of 10⁴ steps: `ε · 4 · √10⁴`; measured a
    /// quarter.
    const LONG_ROUND_OFF: f64 = 4.0 * 100.0 * f64::EPSILON;

    #[track_caller]
    fn check_spherical_pendulum<F: Scheme<SphericalPendulum>>(scheme: F) {
        let system = SphericalPendulum::UNIT;
        let change =
            largest_change(system, scheme, system.one_radian(), 10_000, |q, p| angular_momentum(q, p, 0));
        assert!(change <= LONG_ROUND_OFF, "changes by {change:e}");
    }

    #[test]
    fn angular_momentum_of_the_spherical_pendulum() {
        const H: f64 = 0.02;
        check_spherical_pendulum(Evi::midpoint(H));
        check_spherical_pendulum(Evi::simpson(H));
        check_spherical_pendulum(Evi::midpoint(H).frequency(2.0));
        check_spherical_pendulum(Evi::simpson(H).frequency(2.0));
        // Rotations about the vertical mix x and y only.
        let (x, z) = (Frequency::Trigonometric(2.0), Frequency::Hyperbolic(1.0));
        check_spherical_pendulum(Evi::simpson(H).frequencies([x, x, z]));
    }

    #[test]
    fn angular_momentum_needs_equal_frequencies_in_the_plane_of_rotation() {
        let system = SphericalPendulum::UNIT;
        let (x, y) = (Frequency::Trigonometric(2.0), Frequency::Trigonometric(3.0));
        let scheme = Evi::simpson(0.02).frequencies([x, y, Frequency::ZERO]);
        let change =
            largest_change(system, scheme, system.one_radian(), 1000, |q, p| angular_momentum(q, p, 0));
        assert!(change > 1e-4, "changes by {change:e} only");
    }

    const DUMBBELL_H: f64 = 0.05;
    const DUMBBELL_STEPS: usize = 200;

    #[track_caller]
    fn dumbbell_linear_momentum_change<F: Scheme<Dumbbell> + Copy>(scheme: F) -> f64 {
        let system = Dumbbell::STANDARD;
        let along = |i: usize| {
            let momentum = move |_: &[f64], p: &[f64]| p[i] + p[2 + i];
            largest_change(system, scheme, system.turning(), DUMBBELL_STEPS, momentum)
        };
        along(0).max(along(1))
    }

    /// Momenta of size 6, rounded at random in each of 200 steps: `ε · 6 · √200`; measured a third.
    const ROUND_OFF: f64 = 6.0 * 14.2 * f64::EPSILON;
    /// The same on an arm of 10 that the motion reaches; measured 0.6 of it.
    const ANGULAR_ROUND_OFF: f64 = 10.0 * ROUND_OFF;

    #[test]
    fn linear_momentum_of_a_free_dumbbell_on_straight_curves_or_one_node() {
        let check = |change: f64| assert!(change <= ROUND_OFF, "changes by {change:e}");
        check(dumbbell_linear_momentum_change(Evi::midpoint(DUMBBELL_H)));
        check(dumbbell_linear_momentum_change(Evi::simpson(DUMBBELL_H)));
        check(dumbbell_linear_momentum_change(Evi::midpoint(DUMBBELL_H).frequency(1.0)));
        check(dumbbell_linear_momentum_change(Evi::midpoint(DUMBBELL_H).frequency(3.0)));
        check(dumbbell_linear_momentum_change(Evi::midpoint(DUMBBELL_H).frequencies([
            Frequency::Trigonometric(3.0),
            Frequency::Hyperbolic(2.0),
            Frequency::ZERO,
            Frequency::Trigonometric(1.0),
        ])));
    }

    /// Known property: constants are not among the curves of a frequency, so translations are no symmetry of
    /// the action on more than one node. Recorded orders of magnitude: 2e-2 at ω = 1, 2 at ω = 3.
    #[test]
    fn linear_momentum_drifts_on_trigonometric_curves_with_more_nodes() {
        let change = |omega: f64| dumbbell_linear_momentum_change(Evi::simpson(DUMBBELL_H).frequency(omega));
        let (slow, fast) = (change(1.0), change(3.0));
        assert!((2e-3..0.2).contains(&slow), "{slow}");
        assert!((0.2..20.0).contains(&fast), "{fast}");
    }

    #[track_caller]
    fn check_dumbbell_angular_momentum<F: Scheme<Dumbbell>>(scheme: F) {
        let system = Dumbbell::STANDARD;
        let change = largest_change(system, scheme, system.turning(), DUMBBELL_STEPS, |q, p| {
            angular_momentum(q, p, 0) + angular_momentum(q, p, 2)
        });
        assert!(change <= ANGULAR_ROUND_OFF, "changes by {change:e}");
    }

    #[test]
    fn angular_momentum_of_a_free_dumbbell_about_the_origin() {
        check_dumbbell_angular_momentum(Evi::midpoint(DUMBBELL_H));
        check_dumbbell_angular_momentum(Evi::simpson(DUMBBELL_H));
        check_dumbbell_angular_momentum(Evi::midpoint(DUMBBELL_H).frequency(3.0));
        check_dumbbell_angular_momentum(Evi::simpson(DUMBBELL_H).frequency(3.0));
        // One frequency per body is enough.
        let (one, other) = (Frequency::Trigonometric(3.0), Frequency::Trigonometric(1.0));
        check_dumbbell_angular_momentum(Evi::simpson(DUMBBELL_H).frequencies([one, one, other, other]));
    }
}

/// The energy that a step conserves one power of `h²` better than `H`: only a map that comes from the
/// discrete Lagrangian as written has it.
mod modified_energy {
    use super::*;

    const PENDULUM: Pendulum = Pendulum { m: 1.0, l: 1.0, g: GRAVITY };

    /// `H + h² H₂` of `L = ½ v² − V(q)`, from the expansion of the discrete Lagrangian about the implicit
    /// midpoint rule, whose `H₂` is `−(V'' v² + V'²)/24` (Hairer, Lubich, Wanner, Geometric Numerical
    /// Integration, ch. IX.3):
    ///
    /// ```text
    /// δL = ½ ω² (1/12 − m₂) v² + ½ ω⁴ m₂ q² − ½ ω² (1/4 − m₂) V' q − ½ m₂ V'' v²        m₂ = Σ wⱼ σⱼ²
    /// ```
    fn modified_energy(m2: f64, omega_squared: f64, h: f64, q: f64, v: f64) -> f64 {
        let (sine, cosine) = q.sin_cos();
        let (potential, slope, curvature) = (-GRAVITY * cosine, GRAVITY * sine, GRAVITY * cosine);
        let of_midpoint = -(curvature * v * v + slope * slope) / 24.0;
        let of_nodes_and_curves = 0.5 * omega_squared * (1.0 / 12.0 - m2) * v * v
            + 0.5 * omega_squared.powi(2) * m2 * q * q
            - 0.5 * omega_squared * (0.25 - m2) * slope * q
            - 0.5 * m2 * curvature * v * v;
        0.5 * v * v + potential + h * h * (of_midpoint - of_nodes_and_curves)
    }

    #[track_caller]
    fn check<const K: usize>(rule: Quadrature<K>, frequency: Frequency) {
        let m2 = rule.weights().iter().zip(rule.offsets()).map(|(w, offset)| w * offset * offset).sum();
        let omega_squared = match frequency {
            Frequency::Trigonometric(omega) => omega * omega,
            Frequency::Hyperbolic(rate) => -rate * rate,
        };
        let steps = [0.08, 0.04, 0.02, 0.01];
        let errors = steps.map(|h| {
            let simulation = Simulation::new(PENDULUM, Evi::new(rule, h).frequency(frequency));
            let mut run = simulation.start([1.2], [0.4]).expect("a start");
            let energy =
                |state: &State<Pendulum>| modified_energy(m2, omega_squared, h, state.q()[0], state.v()[0]);
            let (start, start_modified) = (run.energy(), energy(run.state()));
            let (mut error, mut modified_error) = (0.0_f64, 0.0_f64);
            while run.state().t() < 8.0 {
                run.advance().expect("a step");
                error = error.max((run.energy() - start).abs());
                modified_error = modified_error.max((energy(run.state()) - start_modified).abs());
            }
            [error, modified_error]
        });
        let order = |quantity: usize| observed_order(&steps, &errors.map(|errors| errors[quantity]));
        println!("{}: {:.3} {:.3}", core::panic::Location::caller(), order(0), order(1));
        // The maxima are sampled at the steps, hence scatter.
        assert!((order(0) - 2.0).abs() < 0.1, "order of H {}: {errors:?}", order(0));
        assert!((order(1) - 4.0).abs() < 0.05, "order of the modified energy {}: {errors:?}", order(1));
    }

    #[test]
    fn is_conserved_to_fourth_order() {
        check(Quadrature::midpoint(), Frequency::ZERO);
        check(Quadrature::<2>::lobatto(), Frequency::ZERO);
        check(Quadrature::<3>::uniform(), Frequency::ZERO);
        check(Quadrature::<3>::gauss(), Frequency::ZERO);
        check(Quadrature::midpoint(), Frequency::Trigonometric(3.13));
        check(Quadrature::<2>::lobatto(), Frequency::Trigonometric(3.13));
        check(Quadrature::<3>::uniform(), Frequency::Trigonometric(3.13));
        check(Quadrature::<3>::gauss(), Frequency::Trigonometric(2.0));
        check(Quadrature::midpoint(), Frequency::Hyperbolic(2.5));
        check(Quadrature::<3>::uniform(), Frequency::Hyperbolic(2.5));
    }
}
