//! Every error of a run, provoked: its numbers, its text, and that nothing has changed when it comes.

use std::error::Error;
use std::fmt::Debug;

use evi_core::baseline::{Rattle, Rk4};
use evi_core::integrator::{ConstraintLabel, Interrupted};
use evi_core::linear::{DenseLu, Factorization, SingularMatrix};
use evi_core::mechanics::ProjectionError;
use evi_core::prelude::*;
use evi_core::scheme::{LinearisationError, QuadratureError};
use evi_examples::{DoublePendulum, GRAVITY, HarmonicOscillator, SphericalPendulum};
use evi_tests::scenes::{ChargedSphericalPendulum, DoublePendulumInAngles};

const DOUBLE: DoublePendulum = DoublePendulum::UNIT;
const SPHERICAL: SphericalPendulum = SphericalPendulum::UNIT;
const OSCILLATOR: HarmonicOscillator = HarmonicOscillator { m: 1.0, k: 1.0 };
const HANGING: [f64; 4] = [0.0, -1.0, 0.0, -2.0];

/// A bead on an ellipse; without a solution for a negative size, a point for size 0.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * (der(x).powi(2) + der(y).powi(2)),
    potential = y,
    constraint(ellipse: 0.25 * x.powi(2) + y.powi(2) == size),
)]
struct Bead {
    size: f64,
}

/// One rod, written down twice.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = m * y,
    constraint(rod: x.powi(2) + y.powi(2) == 1.0),
    constraint(again: x.powi(2) + y.powi(2) == 1.0),
)]
struct HeldTwice {
    m: f64,
}

/// A block whose mass is gone at time `end`.
#[derive(MechanicalSystem)]
#[evi(coordinates(x), lagrangian = 0.5 * (end - t) * der(x).powi(2))]
struct Melting {
    end: f64,
}

/// Momentum `p = v²`: no velocity has a negative one.
#[derive(MechanicalSystem)]
#[evi(coordinates(x), lagrangian = der(x).powi(3) / 3.0 - force * x)]
struct OneWay {
    force: f64,
}

/// The text of an error holds what a user needs.
#[track_caller]
fn check_text(error: &dyn Error, words: &[&str]) {
    let text = error.to_string();
    for word in words {
        assert!(text.contains(word), "`{word}` is missing in: {text}");
    }
}

/// The error of a start that must fail.
#[track_caller]
fn start_error<S, F, const N: usize>(system: S, scheme: F, q: [f64; N], v: [f64; N]) -> StartError
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S>,
{
    match Simulation::new(system, scheme).start(q, v) {
        Ok(run) => panic!("started at {:?}", run.state()),
        Err(error) => error,
    }
}

/// The error of a scheme that must be refused.
#[track_caller]
fn scheme_error<S, F, const N: usize>(system: S, scheme: F) -> SchemeError
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S>,
{
    // The scheme is refused before the start is looked at.
    match start_error(system, scheme, [f64::NAN; N], [0.0; N]) {
        StartError::Scheme(error) => error,
        error => panic!("not the scheme is refused: {error:?}"),
    }
}

/// A run at its first step that fails, at most `steps` steps from the start, and the error.
///
/// The step fails twice alike and leaves the run as it was.
#[track_caller]
fn failed_run<S, F, const N: usize>(
    system: S,
    scheme: F,
    q: [f64; N],
    v: [f64; N],
    steps: u64,
) -> (Run<S, F::Step>, StepError)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S>,
{
    let mut run = Simulation::new(system, scheme).start(q, v).expect("the start is consistent");
    loop {
        assert!(run.steps() < steps, "no step failed");
        let (before, steps_before) = (run.state().clone(), run.steps());
        if let Err(error) = run.advance() {
            check_unchanged(&mut run, &before, steps_before, error);
            return (run, error);
        }
    }
}

#[track_caller]
fn check_unchanged<S: MechanicalSystem, M: OneStep<S>>(
    run: &mut Run<S, M>,
    before: &State<S>,
    steps: u64,
    error: StepError,
) {
    // Equality of every bit.
    assert_eq!(run.state(), before);
    assert_eq!(run.steps(), steps);
    assert!(before.q().as_ref().iter().chain(before.v().as_ref()).all(|number| number.is_finite()));
    let again = run.advance().expect_err("the same step fails again");
    assert_eq!(format!("{again:?}"), format!("{error:?}"));
    assert_eq!(run.state(), before);
}

/// Asserts the variant and a condition on its numbers.
macro_rules! assert_error {
    ($error:expr, $pattern:pat $(if $condition:expr)?) => {{
        let error = $error;
        assert!(matches!(error, $pattern $(if $condition)?), "{error:?}");
    }};
}

#[track_caller]
fn check_equal<E: PartialEq + Debug>(error: E, expected: E) -> E {
    assert_eq!(error, expected);
    error
}

// Starts.

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

/// The motion is determined, the multipliers are not: `tests/redundant.rs` integrates such scenes, where that is stated.
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

// Schemes.

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

// Quadrature.

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

// Steps.

/// The double pendulum from the horizontal at a step that is too large: the equations of the step lose their
/// solution (two quadratics in two multipliers without a common root), after a number of steps that is the
/// motion's own.
#[track_caller]
fn check_no_solution(scheme: impl Scheme<DoublePendulum>, steps: u64) {
    let horizontal = DOUBLE.horizontal();
    let (run, error) = failed_run(DOUBLE, scheme, horizontal.q, horizontal.v, steps + 1);
    assert_eq!(run.steps(), steps);
    let StepError::NoSolution { t, corrections, last_correction, constraint_residual, smallest_pivot_ratio } =
        error
    else {
        panic!("{error:?}");
    };
    assert_eq!(t, run.state().t());
    assert_eq!(corrections, 30);
    // Far from any solution, and finite: the iteration wandered, it neither converged nor escaped.
    assert!(last_correction.is_finite() && last_correction > 1e-4, "{error:?}");
    assert!(constraint_residual.is_finite() && constraint_residual > 1e-4, "{error:?}");
    assert!(smallest_pivot_ratio > 0.0 && smallest_pivot_ratio <= 1.0, "{error:?}");
    check_text(&error, &["no solution", "30 corrections", "constraints", "pivot", "smaller step size"]);

    // The state before it is a good start for smaller steps.
    let (t, q, v) = (run.state().t(), *run.state().q(), *run.state().v());
    let smaller = Simulation::new(DOUBLE, Evi::midpoint(0.001));
    let mut run = smaller.start_at(t, q, v).expect("the state satisfies the constraints");
    run.advance_to(t + 1.0).expect("small steps have a solution");
    assert_eq!(run.steps(), 1_000);
}

#[test]
fn a_step_without_solution_is_reported_with_the_numbers_of_the_iteration() {
    check_no_solution(Evi::midpoint(0.1).frequency(GRAVITY.sqrt()), 65);
    check_no_solution(Evi::midpoint(0.1).frequency(2.397), 65);
    check_no_solution(Evi::simpson(0.1).frequency(GRAVITY.sqrt()), 21);
    check_no_solution(Evi::simpson(0.1).frequency(2.397), 65);
    check_no_solution(Evi::midpoint(0.3), 2);
    check_no_solution(Rattle::new(0.3), 2);
}

#[test]
fn with_linear_interpolation_the_same_motion_has_every_step() {
    let horizontal = DOUBLE.horizontal();
    for scheme in [Evi::midpoint(0.1), Evi::midpoint(0.01)] {
        let mut run = Simulation::new(DOUBLE, scheme).start(horizontal.q, horizontal.v).unwrap();
        assert!(run.advance_to(10.0).is_ok());
    }
}

#[test]
fn a_recording_that_is_interrupted_keeps_what_it_has() {
    let scheme = Evi::simpson(0.1).frequency(GRAVITY.sqrt());
    let horizontal = DOUBLE.horizontal();
    let mut run = Simulation::new(DOUBLE, scheme).start(horizontal.q, horizontal.v).unwrap();
    let interrupted = run.integrate(10.0).expect_err("no solution after 2.1");
    check_text(&interrupted, &["stopped after 21 steps", "no solution"]);
    assert_eq!(format!("{interrupted:?}"), interrupted.to_string());
    assert!(interrupted.source().is_some_and(|source| source.is::<StepError>()));
    let Interrupted { error, trajectory } = interrupted;
    assert_error!(error, StepError::NoSolution { corrections: 30, .. });
    assert_eq!(trajectory.states().len(), 22);
    assert_eq!(trajectory.last(), run.state());
    for (k, state) in trajectory.states().iter().enumerate() {
        assert_eq!(state.t(), k as f64 * 0.1);
    }
}

/// The step equation of the midpoint for an oscillator is `(m + h² k / 4) d = ...`.
#[test]
fn a_step_whose_matrix_vanishes_is_singular() {
    let inverted = HarmonicOscillator { m: 1.0, k: -16.0 };
    let (_, error) = failed_run(inverted, Evi::midpoint(0.5), [1.0], [0.0], 1);
    let matrix = SingularMatrix { pivot_ratio: 0.0 };
    check_equal(error, StepError::Singular { t: 0.0, correction: 1, matrix });
    check_text(&error, &["singular step equations", "t = 0", "correction 1", "pivot"]);
    // Half the step is regular.
    let mut run = Simulation::new(inverted, Evi::midpoint(0.25)).start([1.0], [0.0]).unwrap();
    assert!(run.advance().is_ok());
}

#[test]
fn rattle_reports_a_guess_without_constraint_gradient_as_singular() {
    // Free fall from the top, for the time in which it covers the length of the rod.
    let system = SphericalPendulum { g: 2.0, ..SPHERICAL };
    let (_, error) = failed_run(system, Rattle::new(1.0), [0.0, 0.0, 1.0], [0.0; 3], 1);
    let matrix = SingularMatrix { pivot_ratio: 0.0 };
    check_equal(error, StepError::Singular { t: 0.0, correction: 1, matrix });
}

#[test]
fn an_end_without_mass_cannot_be_projected() {
    // Binary fractions: the step ends at time 1 exactly.
    let (run, error) = failed_run(Melting { end: 1.0 }, Evi::midpoint(0.125), [0.0], [1.0], 8);
    assert_eq!(run.state().t(), 0.875);
    let cause = ProjectionError::Singular(SingularMatrix { pivot_ratio: 0.0 });
    check_equal(error, StepError::Projection { t: 1.0, cause });
    check_text(&error, &["velocity at t = 1", "projected on the constraints", "mass matrix"]);
    // An explicit method meets the same mass in a stage.
    let (_, error) = failed_run(Melting { end: 1.0 }, Rk4::new(0.125), [0.0], [1.0], 8);
    let matrix = SingularMatrix { pivot_ratio: 0.0 };
    check_equal(error, StepError::Singular { t: 1.0, correction: 0, matrix });
}

#[test]
fn an_end_momentum_without_velocity_is_reported() {
    // Half the impulse leaves a velocity at the midpoint, the whole impulse none at the end.
    let (_, error) = failed_run(OneWay { force: 1.5 }, Evi::midpoint(1.0), [0.0], [1.0], 1);
    let StepError::Projection { t, cause: ProjectionError::NotConverged { corrections, last_correction } } =
        error
    else {
        panic!("{error:?}");
    };
    assert_eq!((t, corrections), (1.0, 30));
    assert!(last_correction.is_finite() && last_correction > 1e-4, "{error:?}");
    check_text(&error, &["t = 1", "did not converge", "after 30"]);
}

#[test]
fn growth_beyond_the_largest_number_is_reported() {
    // Far outside its region of stability, Kutta's method multiplies the oscillation by 376 at every step.
    let (run, error) = failed_run(OSCILLATOR, Rk4::new(10.0), [1.0], [0.0], 200);
    check_equal(error, StepError::NotFinite { t: run.state().t() + 10.0 });
    check_text(&error, &["state at t =", "not finite"]);
    assert!(run.steps() > 100, "{}", run.steps());
}

/// A velocity that leaves the rod a million times behind in one step: no solution, or a matrix that is lost
/// in round-off, but never a state.
#[test]
fn velocities_beyond_any_step_are_refused() {
    for speed in [1e5, 1e50, 1e76, 1e100, 1e150] {
        let q = [1.0, 0.0, 0.0];
        let (_, implicit) = failed_run(SPHERICAL, Evi::midpoint(0.01), q, [0.0, speed, 0.0], 1);
        let (_, rattle) = failed_run(SPHERICAL, Rattle::new(0.01), q, [0.0, speed, 0.0], 1);
        for error in [implicit, rattle] {
            assert_error!(error, StepError::NoSolution { .. } | StepError::Singular { .. });
        }
    }
}

/// Momenta are sums of terms that are `|h| ω` times as large: beyond, an oscillator gained 28 orders of magnitude of energy in a step.
#[test]
fn steps_that_leave_momenta_round_off_are_refused_with_their_phase() {
    for h in [1e13, -1e16, 1e44, 1e100] {
        let error = start_error(OSCILLATOR, Evi::midpoint(h), [1.0], [0.5]);
        check_equal(error, StartError::Phase { h, phase: h.abs(), limit: 1e12 });
        check_text(&error, &["a step of", "times 1/ω", "momenta are round-off"]);
    }
    let stiff = HarmonicOscillator { m: 1e-4, k: 1e26 };
    assert_error!(start_error(stiff, Evi::midpoint(0.01), [1.0], [0.5]), StartError::Phase { .. });
    // Of a thousand million periods per step four digits are left, as they should be.
    let mut run = Simulation::new(OSCILLATOR, Evi::midpoint(1e10)).start([1.0], [0.5]).unwrap();
    let energy = run.energy();
    run.advance().expect("solvable");
    assert!((run.energy() / energy - 1.0).abs() < 1e-3, "{}", run.energy());
    // Without a potential that bends, nothing cancels.
    assert!(Simulation::new(SPHERICAL, Evi::midpoint(1e44)).start([0.0, 0.0, -1.0], [0.0; 3]).is_ok());
}

/// A mass that is nothing beside the magnetic force: the elimination loses all digits, and no step ends beside the rod.
#[test]
fn steps_whose_matrix_has_lost_its_digits_are_refused() {
    let mut bits = 1_u64;
    let mut random = || {
        bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (bits >> 11) as f64 / (1_u64 << 51) as f64 - 2.0
    };
    let (mut accepted, mut refused) = (0, 0);
    for m in [1e-40, 1e-80] {
        let system = ChargedSphericalPendulum { m, l: 0.2, g: 0.2, b: 0.2 };
        for _ in 0..100 {
            let (q, v) = ([random(), random(), random()], [random(), random(), random()]);
            let simulation = Simulation::new(system, Evi::trapezoid(0.00785));
            let Ok(mut run) = simulation.start_projected(0.0, q, v) else { continue };
            match run.advance().cloned() {
                Ok(state) => {
                    let [rod] = run.mechanics().constraint_residual(&state);
                    assert!(rod.abs() < 1e-16, "{rod:e}");
                    accepted += 1;
                }
                Err(error) => {
                    assert_error!(error, StepError::NoSolution { .. } | StepError::Singular { .. });
                    refused += 1;
                }
            }
        }
    }
    println!("{accepted} accepted, {refused} refused");
    assert!(accepted > 10 && refused > 10, "{accepted} {refused}");
}

// Matrices.

#[test]
fn a_singular_matrix_is_reported_with_its_pivots() {
    let error = DenseLu::factor(&[[1.0, 1.0], [1.0, 1.0]]).err().expect("dependent rows");
    check_equal(error, SingularMatrix { pivot_ratio: 0.0 });
    check_text(&error, &["matrix is singular", "pivot"]);
    let error = DenseLu::factor(&[[1.0, f64::NAN], [1.0, 1.0]]).err().expect("not a number");
    assert!(error.pivot_ratio.is_nan());
}

/// Steps back do not lead ahead: that takes the other sign, and nothing happens until then.
#[test]
fn a_time_on_the_other_side_is_refused_with_the_sign_that_leads_there() {
    for (h, target) in [(-0.01, 1.0), (0.01, -1.0)] {
        let mut run = Simulation::new(OSCILLATOR, Evi::midpoint(h)).start([1.0], [0.0]).expect("consistent");
        let error = run.advance_to(target).map(|_| ()).expect_err("the other side");
        check_text(&error, &["is not ahead", &format!("h = {h}: with h = {}", -h)]);
        assert!(matches!(error, StepError::OppositeTime { t: 0.0, .. }), "{error:?}");
        assert_eq!(run.integrate(target).expect_err("the other side").error, error);
        assert_eq!(run.steps(), 0);
        // Where it is, within a step, is near enough.
        assert!(run.advance_to(-0.9 * h).is_ok());
        assert!(run.advance_to(-target).is_ok());
        assert_eq!(run.steps(), 100);
    }
}

#[test]
fn a_time_that_no_number_of_steps_reaches_is_refused() {
    let mut run = Simulation::new(OSCILLATOR, Evi::midpoint(0.01)).start([1.0], [0.0]).expect("consistent");
    let before = run.state().clone();
    for target in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e300] {
        let error = run.advance_to(target).map(|_| ()).expect_err("out of reach");
        check_text(&error, &["cannot be reached", "h = 0.01"]);
        assert!(matches!(error, StepError::UnreachableTime { h: 0.01, .. }));
        let interrupted = run.integrate(target).expect_err("out of reach");
        assert_eq!(interrupted.trajectory.states(), std::slice::from_ref(&before));
    }
    assert_eq!((run.state(), run.steps()), (&before, 0));
}

/// A mass and a stiffness whose velocity overflows at the start.
#[test]
fn a_start_that_overflows_is_refused() {
    let tiny = HarmonicOscillator { m: 5e-324, k: 1.0 };
    let error =
        Simulation::new(tiny, Evi::midpoint(0.1)).start([1.0], [-2.0]).map(|_| ()).expect_err("overflows");
    check_text(&error, &["velocity 0", "not finite"]);
}
