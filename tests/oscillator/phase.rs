//! The phase of a step against its closed formula.

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
