//! Schemes that are the same map, written in different ways.

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
