//! What runs keep: time reversal, momentum maps, and the modified energy.

use evi_core::prelude::*;
use evi_examples::{DoublePendulum, GRAVITY, Pendulum, SphericalPendulum, Start};
use evi_tests::conservation::{angular_momentum, largest_change, there_and_back};
use evi_tests::observed_order;
use evi_tests::scenes::{
    ChargedSphericalPendulum, DoublePendulumInAngles, Dumbbell, KapitzaPendulum, RelativisticBead,
};

mod reversibility {
    use super::*;

    const H: f64 = 0.02;

    /// 32 roundings of velocities of size 4 (8.9e-16): after 100 steps, grown by the motion; measured 5.5 of
    /// them.
    const ROUND_OFF: f64 = 32.0 * 4.0 * f64::EPSILON;

    #[track_caller]
    fn check<S, F, const N: usize>(system: S, scheme: impl Fn(f64) -> F, start: Start<N>)
    where
        S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Clone,
        F: Scheme<S>,
    {
        let distance = there_and_back(system, scheme, start, H, 50);
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
        let distance = there_and_back(system, |h| Evi::new(rule, h), start, H, 50);
        assert!(distance > 1e-2, "misses the start by {distance:e} only");
    }
}

mod momentum_maps {
    use super::*;

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
