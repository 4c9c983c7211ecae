//! Where steps stay bounded, to the number.

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
