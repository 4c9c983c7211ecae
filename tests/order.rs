//! Orders of convergence on nonlinear systems, towards numbers that evi-core has no part in: certified
//! reference solutions, or extrapolation on accelerations written by hand with steps so small that its error is round-off.
//!
//! The family has order 2 for every rule that integrates `τ` exactly, whatever its number of nodes and the
//! frequency; order 1 otherwise (Marsden & West, Acta Numerica 10 (2001), thm. 2.3.1). A slope is the
//! least-squares slope over five step sizes, of the errors in `q`, `v` and the index-1 multipliers at the end
//! of the run and of the largest `|H − H₀|` on the way.

use evi_core::baseline::{Rattle, Rk4};
use evi_core::prelude::*;
use evi_examples::{DoublePendulum, SphericalPendulum, Start, StiffSpringPendulum};
use evi_tests::convergence::{Errors, measure};
use evi_tests::motions::{
    Motion, charged_particle, charged_spherical_pendulum, damped_pendulum, double_pendulum,
    double_pendulum_in_angles, kapitza_pendulum, modulated_pendulum, pendulum, relativistic_bead,
};
use evi_tests::references::{self, Certified};
use evi_tests::scenes::{
    ChargedParticle, ChargedSphericalPendulum, DampedPendulum, DoublePendulumInAngles, ModulatedPendulum,
};
use evi_tests::{distance, extrapolate_by_hand, integrate_by_hand, largest_difference, observed_order};

/// Slopes over a decade and a half of step sizes carry the next term of the error expansion: a few
/// hundredths.
const SLOPE_TOLERANCE: f64 = 0.05;
/// The largest energy error of a run is sampled at its steps, hence scatters.
const ENERGY_SLOPE_TOLERANCE: f64 = 0.1;
/// Fifty times the round-off of a thousand steps (some 2e-14): errors below this show no order.
const SMALLEST_ERROR: f64 = 1e-12;

#[track_caller]
fn check_slope(quantity: &str, h: &[f64], errors: &[f64], order: f64, tolerance: f64) {
    let smallest = errors.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(smallest > SMALLEST_ERROR, "{quantity}: round-off in {errors:?}");
    let observed = observed_order(h, errors);
    println!("{}: {quantity} {observed:.4}", core::panic::Location::caller());
    assert!(
        (observed - order).abs() <= tolerance,
        "order of {quantity} is {observed:.3}, not {order}: {errors:?}"
    );
}

/// Orders of `q`, `v` and the multipliers.
#[track_caller]
fn check_state<S, F>(motion: &Motion<S>, scheme: impl Fn(f64) -> F, order: f64) -> Errors
where
    S: MechanicalSystem + Clone,
    F: Scheme<S>,
{
    let errors = measure(motion, scheme);
    check_slope("q", &errors.h, &errors.q, order, SLOPE_TOLERANCE);
    check_slope("v", &errors.h, &errors.v, order, SLOPE_TOLERANCE);
    if !errors.multipliers.is_empty() {
        check_slope("multipliers", &errors.h, &errors.multipliers, order, SLOPE_TOLERANCE);
    }
    errors
}

/// Orders of `q`, `v`, the multipliers and the energy.
#[track_caller]
fn check<S, F>(motion: &Motion<S>, scheme: impl Fn(f64) -> F, order: f64)
where
    S: MechanicalSystem + Clone,
    F: Scheme<S>,
{
    let errors = check_state(motion, scheme, order);
    if motion.conserves_energy {
        check_slope("H", &errors.h, &errors.energy, order, ENERGY_SLOPE_TOLERANCE);
    }
}

/// Order 2 towards certified digits with `|q − q*| ≤ constant · h²`. The constants are truncation error,
/// measured and rounded up.
#[track_caller]
fn check_certified<S, F>(motion: &Motion<S>, scheme: impl Fn(f64) -> F, constant: f64)
where
    S: MechanicalSystem + Clone,
    F: Scheme<S>,
{
    let errors = check_state(motion, scheme, 2.0);
    let measured = errors.h.iter().zip(&errors.q).map(|(h, error)| error / (h * h)).fold(0.0, f64::max);
    println!("{}: |q - q*| / h^2 = {measured:.4}", core::panic::Location::caller());
    assert!(measured <= constant, "error constant {measured}, at most {constant} expected");
}

/// Coordinates of the two bobs with frequencies of their own.
const PER_BOB: [Frequency; 4] = [
    Frequency::Trigonometric(3.13),
    Frequency::Trigonometric(3.13),
    Frequency::Trigonometric(1.7),
    Frequency::Trigonometric(1.7),
];
/// Every coordinate with a frequency of its own, of all three kinds.
const PER_COORDINATE: [Frequency; 4] = [
    Frequency::Trigonometric(3.13),
    Frequency::Hyperbolic(2.0),
    Frequency::ZERO,
    Frequency::Trigonometric(5.0),
];
const HYPERBOLIC: Frequency = Frequency::Hyperbolic(2.5);

/// A user's nodes.
fn on_nodes<const K: usize>(nodes: [f64; K], h: f64) -> Evi<K> {
    Evi::new(Quadrature::interpolatory(nodes).expect("a rule"), h)
}

mod constrained_double_pendulum {
    use super::*;

    #[test]
    fn midpoint_linear() {
        check(&double_pendulum(), Evi::midpoint, 2.0);
    }

    #[test]
    fn simpson_linear() {
        check(&double_pendulum(), Evi::simpson, 2.0);
    }

    #[test]
    fn midpoint_trigonometric() {
        check(&double_pendulum(), |h| Evi::midpoint(h).frequency(3.13), 2.0);
    }

    #[test]
    fn simpson_trigonometric() {
        check(&double_pendulum(), |h| Evi::simpson(h).frequency(3.13), 2.0);
    }

    #[test]
    fn midpoint_with_a_frequency_per_bob() {
        check(&double_pendulum(), |h| Evi::midpoint(h).frequencies(PER_BOB), 2.0);
    }

    #[test]
    fn simpson_with_a_frequency_per_bob() {
        check(&double_pendulum(), |h| Evi::simpson(h).frequencies(PER_BOB), 2.0);
    }

    #[test]
    fn midpoint_with_unequal_kinds_per_coordinate() {
        check(&double_pendulum(), |h| Evi::midpoint(h).frequencies(PER_COORDINATE), 2.0);
    }

    #[test]
    fn simpson_with_unequal_kinds_per_coordinate() {
        check(&double_pendulum(), |h| Evi::simpson(h).frequencies(PER_COORDINATE), 2.0);
    }

    #[test]
    fn midpoint_hyperbolic() {
        check(&double_pendulum(), |h| Evi::midpoint(h).frequency(HYPERBOLIC), 2.0);
    }

    #[test]
    fn simpson_hyperbolic() {
        check(&double_pendulum(), |h| Evi::simpson(h).frequency(HYPERBOLIC), 2.0);
    }

    #[test]
    fn gauss_2() {
        check(&double_pendulum(), |h| Evi::new(Quadrature::<2>::gauss(), h).frequency(3.13), 2.0);
    }

    #[test]
    fn gauss_3() {
        check(&double_pendulum(), |h| Evi::new(Quadrature::<3>::gauss(), h).frequency(3.13), 2.0);
    }

    #[test]
    fn lobatto_2() {
        check(&double_pendulum(), |h| Evi::new(Quadrature::<2>::lobatto(), h).frequency(3.13), 2.0);
    }

    #[test]
    fn lobatto_4() {
        check(&double_pendulum(), |h| Evi::new(Quadrature::<4>::lobatto(), h).frequency(3.13), 2.0);
    }

    #[test]
    fn uniform_4() {
        check(&double_pendulum(), |h| Evi::new(Quadrature::<4>::uniform(), h).frequency(3.13), 2.0);
    }

    #[test]
    fn asymmetric_nodes_that_integrate_linear_functions() {
        check(&double_pendulum(), |h| on_nodes([0.1, 0.6], h).frequency(3.13), 2.0);
    }

    #[test]
    fn the_left_rectangle_has_order_1() {
        check(&double_pendulum(), |h| on_nodes([0.0], h), 1.0);
    }

    #[test]
    fn rattle() {
        check(&double_pendulum(), Rattle::new, 2.0);
    }

    #[test]
    fn rk4() {
        let motion = Motion { steps: [100, 200, 400, 800, 1600], ..double_pendulum() };
        check_state(&motion, Rk4::new, 4.0);
    }
}

mod plane_pendulum {
    use super::*;

    #[test]
    fn midpoint_linear() {
        check(&pendulum(), Evi::midpoint, 2.0);
    }

    #[test]
    fn simpson_linear() {
        check(&pendulum(), Evi::simpson, 2.0);
    }

    #[test]
    fn midpoint_trigonometric() {
        check(&pendulum(), |h| Evi::midpoint(h).frequency(3.13), 2.0);
    }

    #[test]
    fn simpson_trigonometric() {
        check(&pendulum(), |h| Evi::simpson(h).frequency(3.13), 2.0);
    }

    #[test]
    fn midpoint_hyperbolic() {
        check(&pendulum(), |h| Evi::midpoint(h).frequency(HYPERBOLIC), 2.0);
    }

    #[test]
    fn simpson_hyperbolic() {
        check(&pendulum(), |h| Evi::simpson(h).frequency(HYPERBOLIC), 2.0);
    }

    #[test]
    fn gauss_2() {
        check(&pendulum(), |h| Evi::new(Quadrature::<2>::gauss(), h), 2.0);
    }

    #[test]
    fn gauss_3() {
        check(&pendulum(), |h| Evi::new(Quadrature::<3>::gauss(), h), 2.0);
    }

    #[test]
    fn lobatto_2() {
        check(&pendulum(), |h| Evi::new(Quadrature::<2>::lobatto(), h), 2.0);
    }

    #[test]
    fn lobatto_4() {
        check(&pendulum(), |h| Evi::new(Quadrature::<4>::lobatto(), h), 2.0);
    }

    #[test]
    fn uniform_4() {
        check(&pendulum(), |h| Evi::new(Quadrature::<4>::uniform(), h), 2.0);
    }

    #[test]
    fn asymmetric_nodes_that_integrate_linear_functions() {
        check(&pendulum(), |h| on_nodes([0.0, 0.3, 1.0], h), 2.0);
    }

    #[test]
    fn the_left_rectangle_has_order_1() {
        check(&pendulum(), |h| on_nodes([0.0], h), 1.0);
    }

    #[test]
    fn any_single_node_off_the_middle_has_order_1() {
        let motion = Motion { steps: [400, 800, 1600, 3200, 6400], ..pendulum() };
        check(&motion, |h| on_nodes([0.8], h).frequency(3.13), 1.0);
    }

    #[test]
    fn rattle() {
        check(&pendulum(), Rattle::new, 2.0);
    }

    #[test]
    fn rk4() {
        check_state(&pendulum(), Rk4::new, 4.0);
    }
}

/// One scene for every structure of `L` and `φ`: what a missing term of the step equations would break.
mod structures {
    use super::*;

    #[test]
    fn configuration_dependent_mass_midpoint() {
        check(&double_pendulum_in_angles(), Evi::midpoint, 2.0);
    }

    #[test]
    fn configuration_dependent_mass_simpson_trigonometric() {
        check(&double_pendulum_in_angles(), |h| Evi::simpson(h).frequencies([3.13.into(), 1.7.into()]), 2.0);
    }

    #[test]
    fn gyroscopic_coupling_midpoint() {
        check(&charged_particle(), Evi::midpoint, 2.0);
    }

    #[test]
    fn gyroscopic_coupling_simpson_trigonometric() {
        check(&charged_particle(), |h| Evi::simpson(h).frequencies([2.0.into(), 3.0.into()]), 2.0);
    }

    #[test]
    fn gyroscopic_coupling_rk4() {
        check_state(&charged_particle(), Rk4::new, 4.0);
    }

    #[test]
    fn gyroscopic_coupling_with_a_constraint_midpoint() {
        check(&charged_spherical_pendulum(), Evi::midpoint, 2.0);
    }

    #[test]
    fn gyroscopic_coupling_with_a_constraint_simpson_trigonometric() {
        check(&charged_spherical_pendulum(), |h| Evi::simpson(h).frequency(2.0), 2.0);
    }

    #[test]
    fn gyroscopic_coupling_with_a_constraint_rk4() {
        check_state(&charged_spherical_pendulum(), Rk4::new, 4.0);
    }

    #[test]
    fn time_dependent_potential_midpoint() {
        check(&modulated_pendulum(), Evi::midpoint, 2.0);
    }

    #[test]
    fn time_dependent_potential_simpson_trigonometric() {
        check(&modulated_pendulum(), |h| Evi::simpson(h).frequency(3.0), 2.0);
    }

    #[test]
    fn time_dependent_potential_rattle() {
        check(&modulated_pendulum(), Rattle::new, 2.0);
    }

    #[test]
    fn time_dependent_potential_rk4() {
        check_state(&modulated_pendulum(), Rk4::new, 4.0);
    }

    #[test]
    fn time_dependent_mass_midpoint() {
        check(&damped_pendulum(), Evi::midpoint, 2.0);
    }

    #[test]
    fn time_dependent_mass_simpson_trigonometric() {
        check(&damped_pendulum(), |h| Evi::simpson(h).frequency(3.0), 2.0);
    }

    #[test]
    fn time_dependent_mass_rk4() {
        check_state(&damped_pendulum(), Rk4::new, 4.0);
    }

    #[test]
    fn not_quadratic_in_velocity_with_a_constraint_midpoint() {
        check(&relativistic_bead(), Evi::midpoint, 2.0);
    }

    #[test]
    fn not_quadratic_in_velocity_with_a_constraint_simpson_trigonometric() {
        check(&relativistic_bead(), |h| Evi::simpson(h).frequency(2.0), 2.0);
    }

    #[test]
    fn not_quadratic_in_velocity_with_a_constraint_rk4() {
        check_state(&relativistic_bead(), Rk4::new, 4.0);
    }

    #[test]
    fn moving_constraint_midpoint() {
        check(&kapitza_pendulum(), Evi::midpoint, 2.0);
    }

    #[test]
    fn moving_constraint_simpson_trigonometric() {
        check(&kapitza_pendulum(), |h| Evi::simpson(h).frequency(3.0), 2.0);
    }

    #[test]
    fn moving_constraint_rattle() {
        check(&kapitza_pendulum(), Rattle::new, 2.0);
    }

    #[test]
    fn moving_constraint_rk4() {
        let motion = Motion { steps: [125, 250, 500, 1000, 2000], ..kapitza_pendulum() };
        check_state(&motion, Rk4::new, 4.0);
    }
}

/// Positions, velocities and index-1 multipliers of order 2 towards certified digits.
mod certified {
    use super::*;

    fn unit(sample: usize) -> Motion<DoublePendulum> {
        let system = DoublePendulum::UNIT;
        let end = references::DOUBLE_PENDULUM[sample];
        Motion::certified(system, system.horizontal(), end, (end.t * 80.0) as u32)
    }

    fn mild(sample: usize) -> Motion<DoublePendulum> {
        let system = DoublePendulum::UNIT;
        let end = references::DOUBLE_PENDULUM_MILD[sample];
        Motion::certified(system, system.at_angles(0.1, 0.1), end, (end.t * 100.0) as u32)
    }

    fn spherical(sample: usize) -> Motion<SphericalPendulum> {
        let system = SphericalPendulum::UNIT;
        let end = references::SPHERICAL_PENDULUM[sample];
        Motion::certified(system, system.one_radian(), end, (end.t * 60.0) as u32)
    }

    /// `coarsest` steps resolve the radial oscillation of frequency `√k`: `h √k = 0.1`.
    fn stiff(k: f64, end: Certified, coarsest: u32) -> Motion<StiffSpringPendulum> {
        let system = StiffSpringPendulum::with_stiffness(k);
        Motion::certified(system, system.horizontal(), end, coarsest)
    }

    #[test]
    fn horizontal_double_pendulum_after_a_quarter() {
        check_certified(&unit(0), Evi::midpoint, 0.4);
        check_certified(&unit(0), |h| Evi::simpson(h).frequency(3.13), 0.7);
    }

    #[test]
    fn horizontal_double_pendulum_after_a_half() {
        check_certified(&unit(1), Evi::midpoint, 2.0);
        check_certified(&unit(1), |h| Evi::simpson(h).frequency(3.13), 3.0);
    }

    #[test]
    fn horizontal_double_pendulum_after_one() {
        check_certified(&unit(2), Evi::midpoint, 10.0);
        check_certified(&unit(2), |h| Evi::simpson(h).frequency(3.13), 13.0);
    }

    #[test]
    fn mild_double_pendulum_after_one() {
        check_certified(&mild(0), Evi::midpoint, 0.2);
        check_certified(&mild(0), |h| Evi::simpson(h).frequency(3.13), 0.3);
    }

    #[test]
    fn mild_double_pendulum_after_ten() {
        check_certified(&mild(1), Evi::midpoint, 2.0);
        check_certified(&mild(1), |h| Evi::simpson(h).frequency(3.13), 4.0);
    }

    #[test]
    fn spherical_pendulum_after_one() {
        check_certified(&spherical(0), Evi::midpoint, 1.0);
        check_certified(&spherical(0), |h| Evi::simpson(h).frequency(3.13), 1.5);
    }

    #[test]
    fn spherical_pendulum_after_ten() {
        check_certified(&spherical(1), Evi::midpoint, 25.0);
        check_certified(&spherical(1), |h| Evi::simpson(h).frequency(3.13), 35.0);
    }

    #[test]
    fn stiff_spring_pendulum_1e2() {
        let motion = stiff(1e2, references::STIFF_SPRING_PENDULUM_1E2, 100);
        check_certified(&motion, Evi::midpoint, 6.0);
        check_certified(&motion, Evi::simpson, 3.0);
    }

    #[test]
    fn stiff_spring_pendulum_1e4() {
        let motion = stiff(1e4, references::STIFF_SPRING_PENDULUM_1E4, 1000);
        check_certified(&motion, Evi::midpoint, 6.0);
        check_certified(&motion, Evi::simpson, 3.0);
    }
}

/// The reference by hand against certified digits, in other coordinates.
#[test]
fn extrapolation_by_hand_is_good_to_round_off() {
    let system = DoublePendulumInAngles { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g: evi_examples::GRAVITY };
    for end in references::DOUBLE_PENDULUM_MILD {
        let steps = (200.0 * end.t) as u32;
        let acceleration = |_, q: &[f64; 2], v: &[f64; 2]| system.acceleration(q, v);
        let (q, v) = extrapolate_by_hand(acceleration, ([0.1, 0.1], [0.0; 2]), end.t, steps);
        let reached = system.cartesian(q, v);
        let error = largest_difference(&reached.q, end.q).max(largest_difference(&reached.v, end.v));
        println!("after {}: {error:e}", end.t);
        // Round-off of up to 2,000 steps.
        assert!(error <= 3e-14, "off by {error:e}");
    }
}

/// Schemes that are the same map, written in different ways.
mod coincidences {
    use super::*;

    /// The state `(q, v)` of the unequal double pendulum at time 1.
    fn end<F: Scheme<DoublePendulum>>(scheme: F) -> [f64; 8] {
        let motion = double_pendulum();
        let q0: [f64; 4] = motion.q0.try_into().expect("four coordinates");
        let v0: [f64; 4] = motion.v0.try_into().expect("four velocities");
        let mut run = Simulation::new(motion.system, scheme).start(q0, v0).expect("a consistent start");
        let state = run.advance_to(1.0).expect("every step");
        core::array::from_fn(|i| if i < 4 { state.q()[i] } else { state.v()[i - 4] })
    }

    /// 32 roundings of velocities of size 4 (8.9e-16): after 100 steps, grown threefold; measured 6.5 of
    /// them.
    const ROUND_OFF: f64 = 32.0 * 4.0 * f64::EPSILON;

    #[track_caller]
    fn check_same<F: Scheme<DoublePendulum>, G: Scheme<DoublePendulum>>(one: F, other: G) {
        let difference = largest_difference(&end(one), &end(other));
        println!("{}: difference {difference:e}", core::panic::Location::caller());
        assert!(difference <= ROUND_OFF, "differ by {difference:e}");
    }

    #[test]
    fn uniform_gravity_does_not_see_the_nodes_of_straight_curves() {
        const H: f64 = 0.01;
        let midpoint = Evi::midpoint(H);
        check_same(midpoint, Evi::new(Quadrature::<2>::uniform(), H));
        check_same(midpoint, Evi::simpson(H));
        check_same(midpoint, Evi::new(Quadrature::<5>::uniform(), H));
        check_same(midpoint, Evi::new(Quadrature::<2>::gauss(), H));
        check_same(midpoint, Evi::new(Quadrature::<3>::gauss(), H));
        check_same(midpoint, Evi::new(Quadrature::<4>::lobatto(), H));
        check_same(midpoint, on_nodes([0.1, 0.6], H));
    }

    #[test]
    fn uniform_gravity_sees_the_nodes_of_trigonometric_curves() {
        let midpoint = end(Evi::midpoint(0.01).frequency(3.13));
        let simpson = end(Evi::simpson(0.01).frequency(3.13));
        let difference = largest_difference(&midpoint, &simpson);
        assert!(difference > 1e-5, "differ by {difference:e}");
    }

    #[test]
    fn rattle_is_the_member_on_lobatto_2() {
        check_same(Rattle::new(0.01), Evi::new(Quadrature::<2>::lobatto(), 0.01));
    }

    #[test]
    fn a_frequency_of_zero_is_the_linear_interpolant() {
        check_same(Evi::simpson(0.01), Evi::simpson(0.01).frequency(0.0));
        check_same(Evi::simpson(0.01), Evi::simpson(0.01).frequency(Frequency::Hyperbolic(0.0)));
    }

    #[test]
    fn equal_frequencies_per_coordinate_are_one_frequency() {
        check_same(
            Evi::simpson(0.01).frequency(3.13),
            Evi::simpson(0.01).frequencies([Frequency::Trigonometric(3.13); 4]),
        );
    }

    /// The baseline against the same method on accelerations by hand: 100 steps of a hundredth from `start`.
    #[track_caller]
    fn check_kutta<S, const N: usize>(
        system: S,
        start: Start<N>,
        acceleration: impl Fn(f64, &[f64; N], &[f64; N]) -> [f64; N],
    ) where
        S: MechanicalSystem,
        [f64; N]: Into<S::PerCoordinate<f64>>,
    {
        let mut run = Simulation::new(system, Rk4::new(0.01)).start(start.q, start.v).expect("a start");
        let state = run.advance_to(1.0).expect("every step");
        let (q, v) = integrate_by_hand(acceleration, (start.q, start.v), 1.0, 100);
        assert!(q != start.q, "vacuous: nothing moves");
        let difference =
            largest_difference(state.q().as_ref(), &q).max(largest_difference(state.v().as_ref(), &v));
        println!("{}: difference {difference:e}", core::panic::Location::caller());
        assert!(difference <= ROUND_OFF, "differ by {difference:e}");
    }

    #[test]
    fn rk4_is_kuttas_method_on_the_equations_of_motion() {
        let angles = DoublePendulumInAngles::UNEQUAL;
        check_kutta(angles, DoublePendulumInAngles::MODERATE, |_, q, v| angles.acceleration(q, v));
        let particle = ChargedParticle { m: 0.8, b: 3.0 };
        let start = Start { q: [0.7, -0.2], v: [0.3, 1.5] };
        check_kutta(particle, start, |_, q, v| particle.acceleration(q, v));
        let charged = ChargedSphericalPendulum::STANDARD;
        check_kutta(charged, charged.one_radian(), |_, q, v| charged.acceleration(q, v));
        let modulated = ModulatedPendulum { g: 9.0, a: 0.4, w: 5.0 };
        check_kutta(modulated, Start { q: [1.0], v: [-0.5] }, |t, q, _| modulated.acceleration(t, q));
        let damped = DampedPendulum { g: 9.0, c: 0.6 };
        check_kutta(damped, Start { q: [1.0], v: [-0.5] }, |_, q, v| damped.acceleration(q, v));
    }

    /// The distance to the linear result is `c u²`, from `u = 0.1` down to where round-off hides it: an
    /// interpolant with 0/0 in it would show as noise.
    #[track_caller]
    fn check_continuity<const K: usize>(evi: fn(f64) -> Evi<K>, frequency: fn(f64) -> Frequency) {
        // Few large steps: the frequency ω = u/h enters the soft modes of Simpson's rule as (ω² h)².
        const H: f64 = 0.1;
        let limit = end(evi(H));
        let distance = |u: f64| distance(&end(evi(H).frequency(frequency(u / H))), &limit);
        let constant = distance(1e-3) / 1e-6;
        assert!(constant > 0.1, "vacuous: the frequency has no effect");
        for exponent in 1..=12 {
            let u = 10.0_f64.powi(-exponent);
            let quadratic = constant * u * u;
            let deviation = (distance(u) - quadratic).abs();
            println!("u = {u:e}: {:e}, deviation {deviation:e} of {quadratic:e}", distance(u));
            // The term of order u⁴, and the round-off of two runs.
            let allowed = 20.0 * u * u * quadratic + 2.0 * ROUND_OFF;
            assert!(deviation <= allowed, "at u = {u:e} off by {deviation:e}");
        }
    }

    #[test]
    fn small_trigonometric_frequencies_tend_to_zero_without_noise() {
        check_continuity(Evi::midpoint, Frequency::Trigonometric);
        check_continuity(Evi::simpson, Frequency::Trigonometric);
    }

    #[test]
    fn small_hyperbolic_rates_tend_to_zero_without_noise() {
        check_continuity(Evi::midpoint, Frequency::Hyperbolic);
        check_continuity(Evi::simpson, Frequency::Hyperbolic);
    }
}
