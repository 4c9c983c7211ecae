//! Starts that are refused.

use super::*;

#[test]
fn numbers_of_a_start_that_are_not_finite_are_refused() {
    let scheme = Evi::midpoint(0.01);
    let error = start_error(DOUBLE, scheme, [0.0, -1.0, f64::INFINITY, -2.0], [0.0; 4]);
    check_equal(error, StartError::NotFinite { quantity: "position", index: 2, value: f64::INFINITY });
    check_text(&error, &["position 2", "not finite", "inf"]);
    let error = start_error(DOUBLE, scheme, HANGING, [0.0, f64::NEG_INFINITY, 0.0, 0.0]);
    check_equal(error, StartError::NotFinite { quantity: "velocity", index: 1, value: f64::NEG_INFINITY });
    let error = start_error(DOUBLE, scheme, [f64::NAN; 4], [0.0; 4]);
    assert_error!(error, StartError::NotFinite { quantity: "position", index: 0, value } if value.is_nan());
    let error = Simulation::new(DOUBLE, scheme).start_at(f64::NAN, HANGING, [0.0; 4]).err().unwrap();
    assert_error!(error, StartError::NotFinite { quantity: "time", index: 0, value } if value.is_nan());
    let error = Simulation::new(DOUBLE, scheme).start_projected(0.0, [f64::NAN; 4], [0.0; 4]).err().unwrap();
    assert_error!(error, StartError::NotFinite { quantity: "position", index: 0, .. });
}

#[test]
fn a_parameter_that_is_not_finite_is_refused_by_name() {
    let system = DoublePendulum { m2: f64::NAN, ..DOUBLE };
    let error = start_error(system, Evi::midpoint(0.01), HANGING, [0.0; 4]);
    assert_error!(error, StartError::Parameter { name: "m2", value } if value.is_nan());
    check_text(&error, &["parameter `m2`", "not finite", "NaN"]);
    // Before a scheme that depends on it, and where no energy contains it.
    let error = start_error(system, Evi::trapezoid(0.01).linearised_at(HANGING), HANGING, [0.0; 4]);
    assert_error!(error, StartError::Parameter { name: "m2", .. });
    let error = start_error(Bead { size: f64::INFINITY }, Evi::midpoint(0.01), [0.0, 1.0], [0.0; 2]);
    check_equal(error, StartError::Parameter { name: "size", value: f64::INFINITY });
    let simulation = Simulation::new(Bead { size: f64::NAN }, Evi::midpoint(0.01));
    let error = simulation.start_projected(0.0, [0.0, 1.0], [0.0; 2]).err().unwrap();
    assert_error!(error, StartError::Parameter { name: "size", .. });
}

#[test]
fn a_point_of_linearisation_that_is_not_finite_is_refused() {
    let error = scheme_error(DOUBLE, Evi::trapezoid(0.1).linearised_at([0.0, f64::NAN, 0.0, -2.0]));
    assert_error!(
        error,
        SchemeError::Linearisation(LinearisationError::Point { quantity: "position", index: 1, value }) if value.is_nan()
    );
    check_text(&error, &["position 1", "not finite", "NaN"]);
    let error =
        scheme_error(DOUBLE, Evi::trapezoid(0.1).linearised_along(HANGING, [f64::INFINITY, 0.0, 0.0, 0.0]));
    assert_error!(
        error,
        SchemeError::Linearisation(LinearisationError::Point { quantity: "velocity", index: 0, .. })
    );
}

#[test]
fn a_velocity_whose_energy_overflows_is_refused() {
    let error = start_error(OSCILLATOR, Evi::midpoint(0.01), [0.0], [1e200]);
    assert_error!(error, StartError::NotFinite { quantity: "energy", index: 0, .. });
}

#[test]
fn a_position_beside_a_constraint_is_refused_by_name() {
    let error = start_error(DOUBLE, Evi::midpoint(0.01), [0.0, -1.0, 0.0, -2.001], [0.0; 4]);
    assert_error!(
        error,
        StartError::InconsistentPosition { constraint: ConstraintLabel::Name("rod2"), residual, allowed }
            if (residual - (1.001_f64.powi(2) - 1.0)).abs() < 1e-12 && allowed > 0.0 && allowed < 1e-10
    );
    check_text(&error, &["`rod2`", "residual 2.00", "allowed", "start_projected"]);
    // Thirteen decimals of the same position pass.
    assert!(Simulation::new(DOUBLE, Evi::midpoint(0.01)).start([0.6, -0.8, 0.6, -1.8], [0.0; 4]).is_ok());
}

#[test]
fn a_velocity_that_leaves_a_constraint_is_refused_by_name() {
    let error = start_error(SPHERICAL, Evi::midpoint(0.01), [0.0, 0.0, -1.0], [3.0, 0.0, 4.0]);
    let StartError::InconsistentVelocity { constraint, residual, allowed } = error else {
        panic!("{error:?}");
    };
    assert_eq!(constraint, ConstraintLabel::Name("rod"));
    // The constraint's gradient is (0, 0, −2): of the velocity, four fifths lead away.
    assert!((residual - 0.8).abs() < 1e-15 && allowed < 1e-10, "{error:?}");
    check_text(&error, &["`rod`", "velocity", "of its terms", "start_projected"]);
}

#[test]
fn a_start_without_mass_is_singular() {
    let massless = HarmonicOscillator { m: 0.0, ..OSCILLATOR };
    let error = start_error(massless, Evi::midpoint(0.01), [1.0], [0.0]);
    let singular = SingularMatrix { pivot_ratio: 0.0 };
    check_equal(error, StartError::Projection(ProjectionError::Singular(singular)));
    check_text(&error, &["start", "mass matrix and constraints do not determine the motion", "pivot"]);
    // The inner rod would hold a massless inner bob in its place; the outer one lets its bob turn.
    let error = start_error(DoublePendulum { m2: 0.0, ..DOUBLE }, Evi::midpoint(0.01), HANGING, [0.0; 4]);
    check_equal(error, StartError::Projection(ProjectionError::Singular(singular)));
}

#[test]
fn a_constraint_without_gradient_is_singular() {
    let point = SphericalPendulum { l: 0.0, ..SPHERICAL };
    let error = start_error(point, Evi::midpoint(0.01), [0.0; 3], [0.0; 3]);
    let singular = SingularMatrix { pivot_ratio: 0.0 };
    check_equal(error, StartError::Projection(ProjectionError::Singular(singular)));
    // It does not follow from the other one.
    let folded = DoublePendulum { l1: 0.0, ..DOUBLE };
    let error = start_error(folded, Evi::midpoint(0.01), [0.0, 0.0, 0.0, -1.0], [0.0; 4]);
    check_equal(error, StartError::Projection(ProjectionError::Singular(singular)));
}

/// The motion is determined, the multipliers are not: `tests/redundant/` integrates such scenes, where that is stated.
#[test]
fn a_constraint_that_is_written_twice_is_refused_by_name() {
    for error in [
        start_error(HeldTwice { m: 1.0 }, Evi::midpoint(0.01), [1.0, 0.0], [0.0; 2]),
        start_error(HeldTwice { m: 1.0 }, Rk4::new(0.01), [1.0, 0.0], [0.0; 2]),
    ] {
        assert_error!(
            error,
            StartError::DependentConstraints { rank: 1, constraints: 2, largest_dropped, .. } if largest_dropped < 1e-15
        );
        check_text(&error, &["of 2 constraints 1", "`again`", "constraints_of_rank::<1>()"]);
    }
}

#[test]
fn a_projection_on_an_empty_manifold_does_not_converge() {
    let simulation = Simulation::new(Bead { size: -1.0 }, Evi::midpoint(0.01));
    let error = simulation.start_projected(0.0, [1.0, 0.3], [0.0; 2]).err().expect("nothing to project on");
    assert_error!(
        error,
        StartError::Projection(ProjectionError::NotConverged { corrections: 30, last_correction })
            if last_correction > 1e-3
    );
    check_text(&error, &["start", "projection did not converge", "after 30"]);
}

#[test]
fn a_projection_from_the_centre_has_no_direction() {
    let simulation = Simulation::new(Bead { size: 1.0 }, Evi::midpoint(0.01));
    let error = simulation.start_projected(0.0, [0.0; 2], [0.0; 2]).err().expect("every direction is alike");
    let singular = SingularMatrix { pivot_ratio: 0.0 };
    check_equal(error, StartError::Projection(ProjectionError::Singular(singular)));
}

#[test]
fn errors_name_their_cause() {
    let error = start_error(OSCILLATOR, Evi::midpoint(0.0), [1.0], [0.0]);
    // Transparent: the scheme's own words, not a second sentence around them.
    assert_eq!(error.to_string(), SchemeError::StepSize { h: 0.0 }.to_string());
    let error = start_error(HarmonicOscillator { m: 0.0, ..OSCILLATOR }, Evi::midpoint(0.01), [1.0], [0.0]);
    assert!(error.source().is_some_and(|source| source.is::<ProjectionError>()));
}

/// A mass and a stiffness whose velocity overflows at the start.
#[test]
fn a_start_that_overflows_is_refused() {
    let tiny = HarmonicOscillator { m: 5e-324, k: 1.0 };
    let error =
        Simulation::new(tiny, Evi::midpoint(0.1)).start([1.0], [-2.0]).map(|_| ()).expect_err("overflows");
    check_text(&error, &["velocity 0", "not finite"]);
}
