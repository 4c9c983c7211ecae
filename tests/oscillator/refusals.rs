//! Frequencies and nodes that define no step.

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
