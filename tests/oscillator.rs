//! Exact facts about the linear test equation, and about the nodes and curves that a scheme is made of.
//!
//! For `L = ½ v² − ½ μ² q²`, the method frequency `ω`, `u = ω h` and mirror-symmetric nodes `σⱼ = cⱼ − ½`,
//! put `S₂ = Σ wⱼ sin² uσⱼ`, `C₂ = 1 − S₂`, `κ = C₂ − S₂`. The discrete Lagrangian is the quadratic form
//!
//! ```text
//! L_d = (h/8) { (ω² C₂ − μ² S₂) d² / sin² ½u + 4 (ω² S₂ − μ² C₂) s² / cos² ½u }
//! ```
//!
//! in `d = q₁ − q₀` and `s = ½ (q₀ + q₁)`, and from it follow phase, momentum factor and limits of stability.
//! Steps are measured as the 2 × 2 matrix of the map `(q, p) → (q, p)` of a unit mass.

use core::f64::consts::PI;

use evi_core::prelude::*;
use evi_core::scheme::{Interpolant, NodeCoefficients};
use evi_examples::HarmonicOscillator;
use evi_tests::observed_order;

/// A few roundings of numbers of order one.
const ROUND_OFF: f64 = 1e-14;

/// The matrix of one step, columns from `(q, p) = (1, 0)` and `(0, 1)`.
#[track_caller]
fn step_matrix<const K: usize, F>(mu: f64, scheme: Evi<K, F>) -> [[f64; 2]; 2]
where
    F: Interpolant<HarmonicOscillator> + Copy,
{
    let column = |q: f64, v: f64| {
        let simulation = Simulation::new(HarmonicOscillator { m: 1.0, k: mu * mu }, scheme);
        let mut run = simulation.start([q], [v]).expect("a start");
        let state = run.advance().expect("a step");
        [state.q()[0], state.p()[0]]
    };
    let (left, right) = (column(1.0, 0.0), column(0.0, 1.0));
    [[left[0], right[0]], [left[1], right[1]]]
}

/// `Σ wⱼ f(σⱼ)`.
fn sum<const K: usize>(rule: &Quadrature<K>, f: impl Fn(f64) -> f64) -> f64 {
    rule.weights().iter().zip(rule.offsets()).map(|(weight, offset)| weight * f(*offset)).sum()
}

fn user_rule() -> Quadrature<2> {
    Quadrature::interpolatory([0.125, 0.875]).expect("a rule")
}

fn left_rectangle() -> Quadrature<1> {
    Quadrature::interpolatory([0.0]).expect("a rule")
}

mod phase {
    use super::*;

    /// `tan² ½θ` of a symmetric step of determinant 1, from its off-diagonal entries: `1 − cos θ` would
    /// cancel.
    fn tan2_of_half(matrix: [[f64; 2]; 2]) -> f64 {
        let cosine = 0.5 * (matrix[0][0] + matrix[1][1]);
        -matrix[0][1] * matrix[1][0] / (1.0 + cosine).powi(2)
    }

    /// `tan² ½θ = tan² ½u (μ² C₂ − ω² S₂) / (ω² C₂ − μ² S₂)` with h = 1, continued to imaginary `u`.
    #[track_caller]
    fn check_formula<const K: usize>(rule: Quadrature<K>) {
        let mut largest = 0.0_f64;
        for mu in [0.1, 0.3, 0.7, 1.0] {
            for omega in [0.15, 0.3, 0.5, 0.9, 1.1] {
                let s2 = sum(&rule, |offset| (omega * offset).sin().powi(2));
                let c2 = 1.0 - s2;
                let ratio = (mu * mu * c2 - omega * omega * s2) / (omega * omega * c2 - mu * mu * s2);
                let expected = (0.5 * omega).tan().powi(2) * ratio;
                let matrix = step_matrix(mu, Evi::new(rule, 1.0).frequency(omega));
                largest = largest.max((tan2_of_half(matrix) - expected).abs());

                let s2 = sum(&rule, |offset| (omega * offset).sinh().powi(2));
                let c2 = 1.0 + s2;
                let ratio = (mu * mu * c2 - omega * omega * s2) / (omega * omega * c2 - mu * mu * s2);
                let expected = (0.5 * omega).tanh().powi(2) * ratio;
                let matrix = step_matrix(mu, Evi::new(rule, 1.0).frequency(Frequency::Hyperbolic(omega)));
                largest = largest.max((tan2_of_half(matrix) - expected).abs());
            }
        }
        println!("{}: {largest:e}", core::panic::Location::caller());
        assert!(largest > 0.0 && largest <= ROUND_OFF, "off by {largest:e}");
    }

    #[test]
    fn follows_the_formula_on_every_symmetric_rule() {
        check_formula(Quadrature::midpoint());
        check_formula(Quadrature::<2>::uniform());
        check_formula(Quadrature::<3>::uniform());
        check_formula(Quadrature::<4>::uniform());
        check_formula(Quadrature::<5>::uniform());
        check_formula(Quadrature::<2>::gauss());
        check_formula(Quadrature::<3>::gauss());
        check_formula(Quadrature::<4>::lobatto());
        check_formula(Quadrature::<5>::lobatto());
        check_formula(user_rule());
    }

    /// `tan² ½θ = ¼ (μh)² / (1 − m₂ (μh)²)` with `m₂ = Σ wⱼ σⱼ²` for straight curves.
    #[track_caller]
    fn check_linear<const K: usize>(rule: Quadrature<K>) {
        let m2 = sum(&rule, |offset| offset * offset);
        for mu in [0.05, 0.4, 1.0, 1.7] {
            let expected = 0.25 * mu * mu / (1.0 - m2 * mu * mu);
            let measured = tan2_of_half(step_matrix(mu, Evi::new(rule, 1.0)));
            assert!((measured - expected).abs() <= ROUND_OFF * (1.0 + expected), "{measured} for {expected}");
        }
    }

    #[test]
    fn follows_the_formula_on_straight_curves() {
        check_linear(Quadrature::midpoint());
        check_linear(Quadrature::<2>::uniform());
        check_linear(Quadrature::<3>::uniform());
        check_linear(Quadrature::<3>::gauss());
        check_linear(user_rule());
    }

    /// At `ω = μ` one step is `[cos u, sin u/(ω kₜ); −ω kₜ sin u, cos u]` with `kₜ = u κ / sin u`: the phase
    /// is exact on any nodes, the momentum is not.
    #[track_caller]
    fn check_momentum_factor<const K: usize>(rule: Quadrature<K>) {
        for u in [0.1, 0.5, 1.0, 1.4] {
            let (h, kappa) = (0.5, sum(&rule, |offset| (2.0 * u * offset).cos()));
            let omega = u / h;
            let impedance = omega * u * kappa / u.sin();
            let matrix = step_matrix(omega, Evi::new(rule, h).frequency(omega));
            let expected = [[u.cos(), u.sin() / impedance], [-impedance * u.sin(), u.cos()]];
            for (measured, expected) in matrix.as_flattened().iter().zip(expected.as_flattened()) {
                let tolerance = ROUND_OFF * expected.abs().max(1.0);
                assert!((measured - expected).abs() <= tolerance, "{matrix:?} for {expected:?}, u = {u}");
            }
        }
    }

    #[test]
    fn is_exact_at_the_own_frequency_and_the_momentum_is_off_by_its_factor() {
        check_momentum_factor(Quadrature::midpoint());
        check_momentum_factor(Quadrature::<2>::uniform());
        check_momentum_factor(Quadrature::<3>::uniform());
        check_momentum_factor(Quadrature::<3>::gauss());
        check_momentum_factor(Quadrature::<4>::lobatto());
        check_momentum_factor(user_rule());
    }
}

mod order {
    use super::*;

    const MU: f64 = 1.0;
    /// Not a multiple of the half period, where an exact phase would hide every error.
    const T: f64 = 10.0;
    const START: (f64, f64) = (1.0, 0.5);

    /// Orders of `q`, `p` and `H` at time 10 from `(q₀, p₀)`, over steps that all end there.
    #[track_caller]
    fn check<const K: usize>(rule: Quadrature<K>, omega: f64, steps: [u32; 5], order: f64) {
        let system = HarmonicOscillator { m: 1.0, k: MU * MU };
        let (q, p) = system.exact(T, START.0, START.1);
        let energy = 0.5 * (START.1.powi(2) + START.0.powi(2));
        let h = steps.map(|n| T / f64::from(n));
        let errors: [[f64; 3]; 5] = h.map(|h| {
            let simulation = Simulation::new(system, Evi::new(rule, h).frequency(omega));
            let mut run = simulation.start([START.0], [START.1]).expect("a start");
            run.advance_to(T).expect("every step");
            let state = run.state();
            [(state.q()[0] - q).abs(), (state.p()[0] - p).abs(), (run.energy() - energy).abs()]
        });
        for (quantity, name) in ["q", "p", "H"].into_iter().enumerate() {
            let errors = errors.map(|errors| errors[quantity]);
            // A hundred times the round-off of the longest run.
            assert!(errors.iter().all(|error| *error > 1e-12), "{name}: round-off in {errors:?}");
            let observed = observed_order(&h, &errors);
            println!("{}: {name} {observed:.4}", core::panic::Location::caller());
            assert!(
                (observed - order).abs() <= 0.05,
                "order of {name}: {observed:.3}, not {order}; {errors:?}"
            );
        }
    }

    const FINE: [u32; 5] = [200, 400, 800, 1600, 3200];
    const COARSE: [u32; 5] = [40, 60, 80, 120, 160];
    const COARSEST: [u32; 5] = [16, 20, 24, 32, 40];

    #[test]
    fn at_the_own_frequency_is_the_order_of_the_quadrature() {
        check(left_rectangle(), MU, FINE, 1.0);
        check(Quadrature::midpoint(), MU, FINE, 2.0);
        check(Quadrature::<2>::uniform(), MU, FINE, 2.0);
        check(Quadrature::<3>::uniform(), MU, COARSE, 4.0);
        check(Quadrature::<2>::gauss(), MU, COARSE, 4.0);
        check(Quadrature::<3>::gauss(), MU, COARSEST, 6.0);
        check(Quadrature::<4>::lobatto(), MU, COARSEST, 6.0);
    }

    #[test]
    fn at_any_other_frequency_is_2() {
        check(Quadrature::midpoint(), 1.1 * MU, FINE, 2.0);
        check(Quadrature::<2>::uniform(), 1.1 * MU, FINE, 2.0);
        check(Quadrature::<3>::uniform(), 1.1 * MU, FINE, 2.0);
        check(Quadrature::<3>::gauss(), 1.1 * MU, FINE, 2.0);
        check(Quadrature::<4>::lobatto(), 1.1 * MU, FINE, 2.0);
        check(left_rectangle(), 1.1 * MU, FINE, 1.0);
    }
}

mod stability {
    use super::*;

    /// Distance of a free particle from the origin at time 10, when it starts at rest at distance 1.
    fn free_particle<const K: usize>(rule: Quadrature<K>, omega: f64, h: f64) -> f64 {
        let scheme = Evi::new(rule, h).frequency(omega);
        let simulation = Simulation::new(HarmonicOscillator { m: 1.0, k: 0.0 }, scheme);
        let mut run = simulation.start([1.0], [0.0]).expect("a start");
        run.advance_to(10.0).expect("every step").q()[0]
    }

    /// Known property: a curve of frequency ω sees a free particle as unstable, with rate `ω² h √m₂`.
    #[track_caller]
    fn check_growth<const K: usize>(rule: Quadrature<K>, h: f64, tolerance: f64) {
        let omega_squared = 9.81_f64;
        let rate = omega_squared * h * sum(&rule, |offset| offset * offset).sqrt();
        let (measured, expected) = (free_particle(rule, omega_squared.sqrt(), h), (10.0 * rate).cosh());
        println!("growth {measured}, expected {expected}");
        assert!(expected > 1.01, "vacuous");
        assert!((measured / expected - 1.0).abs() <= tolerance, "{measured}, expected {expected}");
    }

    #[test]
    fn a_free_particle_drifts_away_on_more_than_one_node() {
        // The rate is that of small steps; its next term is of relative size u²/12.
        check_growth(Quadrature::<3>::uniform(), 0.01, 1e-4);
        check_growth(Quadrature::<3>::uniform(), 0.1, 0.05);
        check_growth(Quadrature::<2>::gauss(), 0.01, 1e-4);
        check_growth(Quadrature::<4>::lobatto(), 0.01, 1e-4);
        check_growth(Quadrature::<2>::uniform(), 0.01, 1e-3);
    }

    #[test]
    fn simpson_on_a_free_particle_grows_as_recorded() {
        let omega = 9.81_f64.sqrt();
        let simpson = Quadrature::<3>::uniform();
        let (fine, coarse) = (free_particle(simpson, omega, 0.01), free_particle(simpson, omega, 0.1));
        // The figures on record have five and three digits.
        assert!((fine - 1.0404).abs() <= 5e-5, "{fine}");
        assert!((coarse - 8.72).abs() <= 5e-3, "{coarse}");
    }

    #[test]
    fn a_free_particle_stays_at_rest_on_the_midpoint() {
        let omega = 9.81_f64.sqrt();
        for h in [0.01, 0.1, 0.5] {
            let q = free_particle(Quadrature::midpoint(), omega, h);
            assert!((q - 1.0).abs() <= ROUND_OFF, "{q} at h = {h}");
        }
    }

    /// `|½ tr|` is below 1 just inside the limit of `μh` and above 1 just beyond.
    #[track_caller]
    fn check_limit<const K: usize>(rule: Quadrature<K>, limit: f64) {
        let half_trace = |mu: f64| {
            let matrix = step_matrix(mu, Evi::new(rule, 1.0));
            0.5 * (matrix[0][0] + matrix[1][1])
        };
        let (inside, beyond) = (half_trace(limit * (1.0 - 1e-6)), half_trace(limit * (1.0 + 1e-6)));
        assert!(inside > -1.0 && inside < -0.99, "{inside} below the limit");
        assert!(beyond < -1.0, "{beyond} above the limit");
    }

    #[test]
    fn straight_curves_are_stable_up_to_the_inverse_root_of_the_second_moment() {
        check_limit(Quadrature::<2>::uniform(), 2.0);
        check_limit(Quadrature::<3>::uniform(), 12.0_f64.sqrt());
        check_limit(Quadrature::<2>::gauss(), 12.0_f64.sqrt());
        check_limit(Quadrature::<3>::gauss(), 12.0_f64.sqrt());
        check_limit(Quadrature::<4>::lobatto(), 12.0_f64.sqrt());
    }

    #[test]
    fn the_midpoint_is_stable_at_every_step_size() {
        for mu in [1.0, 4.0, 30.0, 1e3] {
            let matrix = step_matrix(mu, Evi::midpoint(1.0));
            let half_trace = 0.5 * (matrix[0][0] + matrix[1][1]);
            assert!(half_trace.abs() < 1.0, "{half_trace} at μh = {mu}");
        }
    }

    /// Mode μ is stable iff `S₂/C₂ < (μ/ω)² < C₂/S₂`.
    #[test]
    fn a_mode_is_stable_between_its_bounds_only() {
        let (rule, omega) = (Quadrature::<3>::uniform(), 0.8_f64);
        let s2 = sum(&rule, |offset| (omega * offset).sin().powi(2));
        let (lower, upper) = (omega * (s2 / (1.0 - s2)).sqrt(), omega * ((1.0 - s2) / s2).sqrt());
        let is_stable = |mu: f64| {
            let matrix = step_matrix(mu, Evi::new(rule, 1.0).frequency(omega));
            (matrix[0][0] + matrix[1][1]).abs() < 2.0
        };
        assert!(!is_stable(lower * 0.999) && is_stable(lower * 1.001), "lower bound {lower}");
        assert!(is_stable(upper * 0.999) && !is_stable(upper * 1.001), "upper bound {upper}");
    }
}

/// A body in uniform gravity.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(coordinates(y), kinetic = 0.5 * m * der(y).powi(2), potential = m * g * y)]
struct FallingBody {
    m: f64,
    g: f64,
}

#[test]
fn a_body_falls_on_the_midpoint_with_the_gravity_of_the_formula() {
    let (g, h) = (9.81, 0.1);
    for u in [1e-3, 0.1, 0.5, 1.0, 1.5] {
        let scheme = Evi::midpoint(h).frequency(u / h);
        let mut run =
            Simulation::new(FallingBody { m: 1.0, g }, scheme).start([0.0], [0.0]).expect("a start");
        let mut y = vec![0.0];
        for _ in 0..10 {
            y.push(run.advance().expect("a step").q()[0]);
        }
        let half: f64 = 0.5 * u;
        let expected = -g * h * h * (half.sin() / half).powi(2) / half.cos();
        for window in y.windows(3) {
            let measured = window[2] - 2.0 * window[1] + window[0];
            // Second differences of positions of size 5.
            assert!(
                (measured - expected).abs() <= 4.0 * 5.0 * f64::EPSILON,
                "{measured}, expected {expected}"
            );
        }
        // 1 + u²/24 + O(u⁴)
        let excess = -expected / (g * h * h) - 1.0;
        assert!((excess - u * u / 24.0).abs() <= 0.1 * u.powi(4) + 4.0 * f64::EPSILON, "{excess} at u = {u}");
    }
}

mod refusals {
    use super::*;

    #[track_caller]
    fn error<const K: usize>(rule: Quadrature<K>, u: f64) -> Option<SchemeError> {
        let scheme = Evi::new(rule, 0.5).frequency(u / 0.5);
        match Simulation::new(HarmonicOscillator { m: 1.0, k: 0.0 }, scheme).start([1.0], [0.0]) {
            Ok(_) => None,
            Err(StartError::Scheme(error)) => Some(error),
            Err(other) => panic!("{other}"),
        }
    }

    /// Refused at `u` for want of inertia, accepted beside it: the coefficient `1e-3` is within `1e-3` of the
    /// root.
    #[track_caller]
    fn check_inertia<const K: usize>(rule: Quadrature<K>, u: f64) {
        match error(rule, u) {
            Some(SchemeError::VanishingInertia { coordinate: 0, phase, kinetic_coefficient }) => {
                assert!((phase - u).abs() < 1e-12 && kinetic_coefficient.abs() < 1e-12);
            }
            other => panic!("{other:?}"),
        }
        for beside in [u - 2e-3, u + 2e-3] {
            assert_eq!(error(rule, beside), None, "at u = {beside}");
        }
    }

    #[test]
    fn where_the_nodes_do_not_see_the_inertia() {
        check_inertia(Quadrature::<2>::uniform(), PI / 2.0);
        check_inertia(Quadrature::<3>::uniform(), 2.0 * PI / 3.0);
    }

    #[test]
    fn where_a_hyperbolic_curve_leaves_no_inertia_between_the_ends() {
        let error = |rate: f64| {
            let scheme = Evi::simpson(0.5).frequency(Frequency::Hyperbolic(rate));
            Simulation::new(HarmonicOscillator { m: 1.0, k: 0.0 }, scheme).start([1.0], [0.0]).err()
        };
        assert!(matches!(error(100.0), Some(StartError::Scheme(SchemeError::VanishingInertia { .. }))));
        assert_eq!(error(10.0), None);
    }

    /// Refused where `|sin u| < 1e-3`, accepted beside it.
    #[track_caller]
    fn check_resonance<const K: usize>(rule: Quadrature<K>, u: f64) {
        for resonant in [u - 0.9e-3, u, u + 0.9e-3] {
            match error(rule, resonant) {
                Some(SchemeError::ResonantFrequency { coordinate: 0, phase, sine }) => {
                    assert!((phase - resonant).abs() < 1e-12 && (sine - resonant.sin()).abs() < 1e-12);
                }
                other => panic!("{other:?} at u = {resonant}"),
            }
        }
        for beside in [u - 2e-3, u + 2e-3] {
            assert_eq!(error(rule, beside), None, "at u = {beside}");
        }
    }

    #[test]
    fn where_two_points_do_not_determine_the_curve() {
        check_resonance(Quadrature::midpoint(), PI);
        check_resonance(Quadrature::<3>::uniform(), PI);
        check_resonance(Quadrature::<3>::gauss(), PI);
        check_resonance(Quadrature::midpoint(), 2.0 * PI);
    }

    #[test]
    fn nothing_below_a_right_angle_on_rules_with_inner_nodes() {
        for step in 1..=150 {
            let u = 0.01 * f64::from(step);
            assert_eq!(error(Quadrature::midpoint(), u), None, "at u = {u}");
            assert_eq!(error(Quadrature::<3>::uniform(), u), None, "at u = {u}");
            assert_eq!(error(Quadrature::<3>::gauss(), u), None, "at u = {u}");
            assert_eq!(error(Quadrature::<4>::lobatto(), u), None, "at u = {u}");
        }
    }
}

mod rules {
    use super::*;

    /// Moments `Σ wⱼ cⱼᵏ = 1/(k+1)` up to `degree` and not beyond; nodes ascend.
    #[track_caller]
    fn check_moments<const S: usize>(rule: Quadrature<S>, degree: i32) {
        let absolute: f64 = rule.weights().iter().map(|weight| weight.abs()).sum();
        let error = |k: i32| {
            let moment: f64 =
                rule.weights().iter().zip(rule.nodes()).map(|(weight, node)| weight * node.powi(k)).sum();
            (moment - 1.0 / f64::from(k + 1)).abs()
        };
        let worst = (0..=degree).map(error).fold(0.0, f64::max);
        println!("{}: moments to {worst:e}, beyond {:e}", core::panic::Location::caller(), error(degree + 1));
        // Eight roundings per unit of weight.
        assert!(worst <= 8.0 * f64::EPSILON * absolute, "moments of degree ≤ {degree} are off by {worst:e}");
        // The first moment missed by the rules below is missed by at least 1e-8 (Gauss with 6 nodes).
        assert!(error(degree + 1) > 1e-9, "more exact than degree {degree}");
        assert!(rule.nodes().is_sorted(), "{:?}", rule.nodes());
    }

    #[track_caller]
    fn check_symmetric<const S: usize>(rule: Quadrature<S>) {
        assert!(rule.is_symmetric());
        for j in 0..S {
            // Equality of bits, up to the sign of a middle zero.
            assert!(rule.offsets()[j] == -rule.offsets()[S - 1 - j], "offset {j}");
            assert!(rule.weights()[j].to_bits() == rule.weights()[S - 1 - j].to_bits(), "weight {j}");
        }
    }

    fn check_uniform<const S: usize>() {
        // An odd number of symmetric nodes gains a degree.
        check_moments(Quadrature::<S>::uniform(), if S % 2 == 1 { S as i32 } else { S as i32 - 1 });
        check_symmetric(Quadrature::<S>::uniform());
    }

    fn check_gauss<const S: usize>() {
        check_moments(Quadrature::<S>::gauss(), 2 * S as i32 - 1);
        check_symmetric(Quadrature::<S>::gauss());
    }

    fn check_lobatto<const S: usize>() {
        check_moments(Quadrature::<S>::lobatto(), 2 * S as i32 - 3);
        check_symmetric(Quadrature::<S>::lobatto());
        let nodes = Quadrature::<S>::lobatto().nodes();
        assert!(nodes[0] == 0.0 && nodes[S - 1] == 1.0, "ends, exactly");
    }

    #[test]
    fn uniform_rules_have_the_degree_of_newton_cotes() {
        check_uniform::<1>();
        check_uniform::<2>();
        check_uniform::<3>();
        check_uniform::<4>();
        check_uniform::<5>();
        check_uniform::<6>();
        check_uniform::<7>();
        check_uniform::<8>();
        check_uniform::<9>();
    }

    #[test]
    fn gauss_rules_have_twice_the_degree() {
        check_gauss::<1>();
        check_gauss::<2>();
        check_gauss::<3>();
        check_gauss::<4>();
        check_gauss::<5>();
        check_gauss::<6>();
    }

    #[test]
    fn lobatto_rules_have_twice_the_degree_but_two() {
        check_lobatto::<2>();
        check_lobatto::<3>();
        check_lobatto::<4>();
        check_lobatto::<5>();
        check_lobatto::<6>();
        check_lobatto::<7>();
    }

    #[test]
    fn user_nodes_integrate_their_interpolants() {
        let rule = |nodes| Quadrature::<3>::interpolatory(nodes).expect("a rule");
        check_moments(left_rectangle(), 0);
        check_moments(user_rule(), 1);
        check_symmetric(user_rule());
        check_moments(rule([0.0, 0.3, 1.0]), 2);
        check_moments(rule([0.1, 0.25, 0.9]), 2);
        assert!(!rule([0.0, 0.3, 1.0]).is_symmetric());
        // Their offsets from the middle differ in the last bit.
        check_symmetric(Quadrature::interpolatory([0.2, 0.8]).expect("a rule"));
        check_symmetric(Quadrature::interpolatory([0.7, 0.3]).expect("a rule"));
        check_symmetric(rule([0.05, 0.5, 0.95]));
    }

    #[track_caller]
    fn check_values<const S: usize>(rule: Quadrature<S>, nodes: [f64; S], weights: [f64; S]) {
        for j in 0..S {
            let (node, weight) = (rule.nodes()[j], rule.weights()[j]);
            assert!((node - nodes[j]).abs() <= f64::EPSILON, "node {j}: {node}, not {}", nodes[j]);
            let tolerance = 4.0 * f64::EPSILON;
            assert!((weight - weights[j]).abs() <= tolerance, "weight {j}: {weight}, not {}", weights[j]);
        }
    }

    #[test]
    fn have_the_known_nodes_and_weights() {
        let mirrored = |offset: f64| [0.5 - offset, 0.5 + offset];
        check_values(Quadrature::midpoint(), [0.5], [1.0]);
        check_values(Quadrature::<2>::uniform(), [0.0, 1.0], [0.5, 0.5]);
        check_values(Quadrature::<3>::uniform(), [0.0, 0.5, 1.0], [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0]);
        let boole = [7.0, 32.0, 12.0, 32.0, 7.0].map(|weight| weight / 90.0);
        check_values(Quadrature::<5>::uniform(), [0.0, 0.25, 0.5, 0.75, 1.0], boole);
        check_values(Quadrature::<2>::gauss(), mirrored(3.0_f64.sqrt() / 6.0), [0.5, 0.5]);
        let [a, b] = mirrored(15.0_f64.sqrt() / 10.0);
        check_values(Quadrature::<3>::gauss(), [a, 0.5, b], [5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0]);
        let [a, b] = mirrored(5.0_f64.sqrt() / 10.0);
        let weights = [1.0, 5.0, 5.0, 1.0].map(|weight| weight / 12.0);
        check_values(Quadrature::<4>::lobatto(), [0.0, a, b, 1.0], weights);
        let [a, b] = mirrored(21.0_f64.sqrt() / 14.0);
        let weights = [9.0, 49.0, 64.0, 49.0, 9.0].map(|weight| weight / 180.0);
        check_values(Quadrature::<5>::lobatto(), [0.0, a, 0.5, b, 1.0], weights);
    }

    #[test]
    fn uniform_weights_turn_negative_at_nine_nodes() {
        assert!(Quadrature::<8>::uniform().weights().iter().all(|&weight| weight > 0.0));
        let weight = Quadrature::<9>::uniform().weights()[2];
        assert!((weight + 928.0 / 28350.0).abs() <= 8.0 * f64::EPSILON, "{weight}");
    }
}

mod curves {
    use super::*;

    const PHASES: [f64; 8] = [1e-8, 1e-6, 1e-4, 1e-2, 0.1, 0.5, 1.0, 1.5];
    const NODES: [f64; 7] = [0.0, 0.1, 0.25, 0.5, 0.7, 0.9375, 1.0];

    /// Eight roundings at the scale of the largest of the functions compared.
    fn near(measured: f64, expected: f64, scale: f64) -> bool {
        (measured - expected).abs() <= 8.0 * f64::EPSILON * scale
    }

    /// `g₁ = sin u(1−τ)/sin u`, `g₂ = sin uτ/sin u` and their derivatives times `h`, or the hyperbolic ones.
    #[track_caller]
    fn check_functions(kind: fn(f64) -> Frequency, sine: fn(f64) -> f64, cosine: fn(f64) -> f64) {
        for u in PHASES {
            for tau in NODES {
                let c = NodeCoefficients::new(kind(u), 1.0, tau - 0.5);
                let (start, end) = (u * (0.5 - (tau - 0.5)), u * tau);
                let scale = 1.0_f64.max(u * cosine(u) / sine(u));
                let pairs = [
                    (c.start(), sine(start) / sine(u)),
                    (c.end(), sine(end) / sine(u)),
                    (c.start_rate(), -u * cosine(start) / sine(u)),
                    (c.end_rate(), u * cosine(end) / sine(u)),
                ];
                for (measured, expected) in pairs {
                    assert!(near(measured, expected, scale), "{measured} for {expected}, u = {u}, τ = {tau}");
                }
            }
        }
    }

    #[test]
    fn trigonometric_ones_are_ratios_of_sines() {
        check_functions(Frequency::Trigonometric, f64::sin, f64::cos);
    }

    #[test]
    fn hyperbolic_ones_are_ratios_of_hyperbolic_sines() {
        check_functions(Frequency::Hyperbolic, f64::sinh, f64::cosh);
    }

    /// What constants lose on a curve: `1 − g₁ − g₂ = −2 sin(½uτ) sin(½u(1−τ))/cos ½u` and
    /// `h (g₁' + g₂') = −u sin uσ/cos ½u`, the latter to a relative rounding although it is of order `u²`.
    #[test]
    fn translation_defects_have_no_cancellation() {
        for u in PHASES {
            for tau in NODES {
                let offset = tau - 0.5;
                let (half, left, right) = (0.5 * u, 0.5 * u * tau, 0.5 * u * (1.0 - tau));
                let c = NodeCoefficients::new(Frequency::Trigonometric(u), 1.0, offset);
                let defect = -2.0 * left.sin() * right.sin() / half.cos();
                assert!(near(1.0 - c.start() - c.end(), defect, 1.0), "u = {u}, τ = {tau}");
                let rate = -u * (u * offset).sin() / half.cos();
                assert!(near(c.even_rate, rate, rate.abs()), "u = {u}, τ = {tau}");
                assert!(
                    (c.start_rate() + c.end_rate() - rate).abs() <= 4.0 * f64::EPSILON,
                    "u = {u}, τ = {tau}"
                );

                let c = NodeCoefficients::new(Frequency::Hyperbolic(u), 1.0, offset);
                let defect = 2.0 * left.sinh() * right.sinh() / half.cosh();
                assert!(near(1.0 - c.start() - c.end(), defect, 1.0), "u = {u}, τ = {tau}");
                let rate = u * (u * offset).sinh() / half.cosh();
                assert!(near(c.even_rate, rate, rate.abs()), "u = {u}, τ = {tau}");
            }
        }
    }

    #[test]
    fn large_hyperbolic_rates_stay_finite_and_decay_from_the_ends() {
        for u in [40.0, 100.0, 300.0, 700.0] {
            for tau in NODES {
                let c = NodeCoefficients::new(Frequency::Hyperbolic(u), 1.0, tau - 0.5);
                // sinh uτ / sinh u → exp(−u(1−τ)) (1 − exp(−2uτ)); the exponent carries u roundings.
                let end = (-u * (1.0 - tau)).exp() * -(-2.0 * u * tau).exp_m1();
                let start = (-u * tau).exp() * -(-2.0 * u * (1.0 - tau)).exp_m1();
                let tolerance = 4.0 * u * f64::EPSILON;
                let numbers = [c.even, c.odd, c.even_rate, c.odd_rate];
                assert!(numbers.iter().all(|number| number.is_finite()), "{c:?}");
                // start and end are differences of even and odd: absolute at the scale of the larger one.
                let scale = start.max(end).max(f64::MIN_POSITIVE);
                assert!(
                    (c.end() - end).abs() <= tolerance * scale,
                    "{} for {end}, u = {u}, τ = {tau}",
                    c.end()
                );
                assert!((c.start() - start).abs() <= tolerance * scale, "u = {u}, τ = {tau}");
            }
        }
    }

    #[test]
    fn mirrored_nodes_have_mirrored_coefficients() {
        for frequency in [Frequency::Trigonometric(1.3), Frequency::Hyperbolic(1.3), Frequency::ZERO] {
            for offset in [0.0, 0.1, 0.3, 0.5] {
                let (left, right) = (
                    NodeCoefficients::new(frequency, 0.7, -offset),
                    NodeCoefficients::new(frequency, 0.7, offset),
                );
                // Equality of numbers, to the last bit: the action of a step must be its own mirror image.
                assert_eq!(
                    (left.even, -left.odd, -left.even_rate, left.odd_rate),
                    (right.even, right.odd, right.even_rate, right.odd_rate)
                );
                // A step back uses the same curve.
                assert_eq!(NodeCoefficients::new(frequency, -0.7, offset), right);
            }
        }
    }

    #[test]
    fn small_phases_go_over_into_straight_lines() {
        for u in [1e-3, 1e-5, 1e-7, 1e-9, 1e-12, 0.0] {
            for frequency in [Frequency::Trigonometric(u), Frequency::Hyperbolic(u)] {
                for offset in [-0.5, -0.2, 0.0, 0.4] {
                    let curved = NodeCoefficients::new(frequency, 1.0, offset);
                    let straight = NodeCoefficients::straight(offset);
                    // The rate of the ends is u²/2 (1 + u²/12); everything else is nearer.
                    let tolerance = 0.6 * u * u + 2.0 * f64::EPSILON;
                    let differences = [
                        curved.even - straight.even,
                        curved.odd - straight.odd,
                        curved.even_rate - straight.even_rate,
                        curved.odd_rate - straight.odd_rate,
                    ];
                    assert!(differences.iter().all(|x| x.abs() <= tolerance), "{curved:?}, u = {u}");
                }
            }
        }
    }
}
