//! The symplectic form on the constraint manifold.
//!
//! A step maps `T*N = {φ(q) = 0, G ∂H/∂p = 0}` to itself. With its derivative `DΨ` (`evi_tests::tangent`, in which no
//! emitted kernel takes part), `w₁ᵀ DΨᵀ J DΨ w₂ = w₁ᵀ J w₂` must hold for vectors tangent to `T*N`, and only for those.
//! Controls show that the test fails for maps that are not symplectic.

use evi_core::baseline::Rk4;
use evi_core::generic::GenericSystem;
use evi_core::prelude::*;
use evi_core::scheme::Interpolant;
use evi_examples::{DoublePendulum, GRAVITY, Pendulum, SphericalPendulum, Start};
use evi_tests::scenes::{ChargedSphericalPendulum, DoublePendulumInAngles, RelativisticBead};
use evi_tests::tangent::{Action, DiscreteAction, TangentSpace, form, symplectic_defect, vector};
use evi_tests::{Random, observed_order};
use nalgebra::{DMatrix, DVector};

mod symplecticity {
    use super::*;

    /// Defects are below this many roundings times `‖DΨ‖²` on the tangent space; measured 2.9.
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
        let roundings = symplectic_defect(&before, &after);
        assert!(roundings <= ROUNDINGS, "the form changes by {roundings:.0} roundings");
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
