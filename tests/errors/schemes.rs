//! Schemes, rules and matrices that are refused.

use super::*;

#[test]
fn a_step_size_that_defines_no_step_is_refused() {
    for h in [0.0, -0.0, f64::INFINITY, f64::NEG_INFINITY] {
        let error = check_equal(scheme_error(DOUBLE, Evi::midpoint(h)), SchemeError::StepSize { h });
        check_text(&error, &["step size", "finite and not zero"]);
        check_equal(scheme_error(DOUBLE, Evi::simpson(h).frequency(1.0)), SchemeError::StepSize { h });
        check_equal(scheme_error(DOUBLE, Rattle::new(h)), SchemeError::StepSize { h });
        check_equal(scheme_error(DOUBLE, Rk4::new(h)), SchemeError::StepSize { h });
    }
    let error = scheme_error(DOUBLE, Evi::midpoint(f64::NAN));
    assert_error!(error, SchemeError::StepSize { h } if h.is_nan());
    check_text(&error, &["got NaN"]);
    // What has no square is written by its digits, not by 170 zeros.
    for (h, text) in [(1e-170, "got 1e-170"), (-2.5e300, "got -2.5e300")] {
        check_text(&scheme_error(DOUBLE, Evi::midpoint(h)), &[text]);
    }
}

#[test]
fn a_frequency_that_is_negative_or_not_finite_is_refused_with_its_coordinate() {
    let error = scheme_error(DOUBLE, Evi::midpoint(0.1).frequency(-2.0));
    check_equal(error, SchemeError::Frequency { coordinate: 0, value: -2.0 });
    check_text(&error, &["frequency", "coordinate 0", "not negative", "-2"]);
    let frequencies = [0.0.into(), 1.0.into(), Frequency::Hyperbolic(f64::INFINITY), 1.0.into()];
    let error = scheme_error(DOUBLE, Evi::simpson(0.1).frequencies(frequencies));
    check_equal(error, SchemeError::Frequency { coordinate: 2, value: f64::INFINITY });
    let error = scheme_error(DOUBLE, Evi::midpoint(0.1).frequency(f64::NAN));
    assert_error!(error, SchemeError::Frequency { coordinate: 0, value } if value.is_nan());
}

#[test]
fn a_resonant_frequency_is_refused() {
    use std::f64::consts::PI;
    let error = scheme_error(DOUBLE, Evi::midpoint(0.5).frequency(2.0 * PI));
    let SchemeError::ResonantFrequency { coordinate: 0, phase, sine } = error else {
        panic!("{error:?}");
    };
    assert!((phase - PI).abs() < 1e-15 && sine.abs() < 1e-15, "{error:?}");
    check_text(&error, &["resonant frequency", "coordinate 0", "3.14159", "Choose ω h"]);
    // Back in time, the phase is the same.
    let error = scheme_error(DOUBLE, Evi::simpson(-0.5).frequency(4.0 * PI));
    assert_error!(error, SchemeError::ResonantFrequency { phase, .. } if (phase - 2.0 * PI).abs() < 1e-15);
    // A hyperbolic curve between two points is always unique.
    assert!(
        Simulation::new(DOUBLE, Evi::midpoint(0.5).frequency(Frequency::Hyperbolic(2.0 * PI)))
            .start(HANGING, [0.0; 4])
            .is_ok()
    );
}

#[test]
fn a_frequency_at_which_the_nodes_do_not_see_the_inertia_is_refused() {
    use std::f64::consts::PI;
    let blind = |error: SchemeError, expected_phase: f64| {
        let SchemeError::VanishingInertia { coordinate: 0, phase, kinetic_coefficient } = error else {
            panic!("{error:?}");
        };
        assert!((phase - expected_phase).abs() < 1e-12, "{error:?}");
        assert!(kinetic_coefficient.abs() < 1e-12, "{error:?}");
        check_text(&error, &["do not see the inertia", "coordinate 0", "Choose a smaller"]);
    };
    let trapezoid = Evi::new(Quadrature::<2>::uniform(), 0.1).frequency(5.0 * PI);
    blind(scheme_error(DOUBLE, trapezoid), PI / 2.0);
    blind(scheme_error(DOUBLE, Evi::simpson(0.1).frequency(20.0 * PI / 3.0)), 2.0 * PI / 3.0);
    // The midpoint sees it at both phases.
    for phase in [PI / 2.0, 2.0 * PI / 3.0] {
        let midpoint = Evi::midpoint(0.1).frequency(10.0 * phase);
        assert!(Simulation::new(DOUBLE, midpoint).start(HANGING, [0.0; 4]).is_ok());
    }
}

#[test]
fn rattle_refuses_a_mass_matrix_that_depends_on_the_configuration() {
    let error = scheme_error(DoublePendulumInAngles::UNEQUAL, Rattle::new(0.01));
    assert_error!(error, SchemeError::UnsupportedStructure { scheme: "RATTLE", .. });
    check_text(&error, &["RATTLE needs", "constant mass matrix"]);
    let error = scheme_error(Melting { end: 1.0 }, Rattle::new(0.01));
    assert_error!(error, SchemeError::UnsupportedStructure { scheme: "RATTLE", .. });
}

#[test]
fn rattle_refuses_a_mass_matrix_that_is_singular() {
    let error = scheme_error(HeldTwice { m: 0.0 }, Rattle::new(0.01));
    assert_error!(error, SchemeError::UnsupportedStructure { scheme: "RATTLE", .. });
    check_text(&error, &["RATTLE needs", "regular"]);
}

#[test]
fn nodes_outside_the_unit_interval_are_refused() {
    for (nodes, index) in [([-1e-300, 1.0], 0), ([0.0, 1.0 + f64::EPSILON], 1), ([0.5, f64::INFINITY], 1)] {
        let error = Quadrature::interpolatory(nodes).expect_err("outside");
        check_equal(error, QuadratureError::OutsideUnitInterval { index, node: nodes[index] });
        check_text(&error, &[&format!("node {index}"), "[0, 1]"]);
    }
    let error = Quadrature::interpolatory([0.5, f64::NAN]).expect_err("not a number");
    assert_error!(error, QuadratureError::OutsideUnitInterval { index: 1, node } if node.is_nan());
    check_text(&error, &["node 1", "NaN"]);
    assert!(Quadrature::interpolatory([0.0, 1.0]).is_ok());
}

#[test]
fn coinciding_nodes_are_refused() {
    let error = Quadrature::interpolatory([0.25, 0.75, 0.25]).expect_err("two nodes are one");
    check_equal(error, QuadratureError::CoincidingNodes { first: 0, second: 2, node: 0.25 });
    check_text(&error, &["nodes 0 and 2", "coincide", "0.25"]);
    // The two zeros are one node.
    let error = Quadrature::interpolatory([0.0, -0.0]).expect_err("two nodes are one");
    assert_error!(error, QuadratureError::CoincidingNodes { first: 0, second: 1, .. });
}

#[test]
fn a_singular_matrix_is_reported_with_its_pivots() {
    let error = DenseLu::factor(&[[1.0, 1.0], [1.0, 1.0]]).err().expect("dependent rows");
    check_equal(error, SingularMatrix { pivot_ratio: 0.0 });
    check_text(&error, &["matrix is singular", "pivot"]);
    let error = DenseLu::factor(&[[1.0, f64::NAN], [1.0, 1.0]]).err().expect("not a number");
    assert!(error.pivot_ratio.is_nan());
}
