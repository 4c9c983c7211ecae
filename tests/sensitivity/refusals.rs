//! What has no derivative says so.

use evi_core::prelude::*;
use evi_core::sensitivity::{
    Course, DerivativeError, Differentiate, Direction, LyapunovRun, ParameterChoice, StateGradient,
};
use evi_examples::DoublePendulum;
use evi_tests::scenes::DampedOscillator;

const SYSTEM: DoublePendulum = DoublePendulum::UNIT;

fn nothing<S: MechanicalSystem>(_: u64, _: &State<S>, _: &mut StateGradient<S>) -> f64 {
    0.0
}

#[test]
fn an_unknown_parameter() {
    let error = ParameterChoice::of::<DoublePendulum>(&["m1", "m3"]).expect_err("no such field");
    assert_eq!(error.to_string(), r#"no parameter is called `m3`; there are ["m1", "m2", "l1", "l2", "g"]"#);
    assert!(Direction::<DoublePendulum>::of_parameter("mass").is_err());
}

#[test]
fn parameters_that_the_tables_of_a_scheme_follow() {
    let oscillator = DampedOscillator::STANDARD;
    let simulation = Simulation::new(oscillator, Evi::simpson(0.1).scene_frequencies());
    let direction = Direction::of_parameter("k").expect("a field");
    let error = simulation.start_with_tangents([1.0], [0.0], &[direction]).err();
    assert!(matches!(error, Some(DerivativeError::Parameters { .. })), "{error:?}");
    let course = Course::new([1.0], [0.0], 3).by_parameters(ParameterChoice::all::<DampedOscillator>());
    let error = simulation.gradient_of(&course, &nothing).err();
    assert!(matches!(error, Some(DerivativeError::Parameters { .. })), "{error:?}");
    // By the start there is no doubt.
    let direction = Direction::of_start([1.0], [0.0]);
    assert!(simulation.start_with_tangents([1.0], [0.0], &[direction]).is_ok());
}

/// A bead on a wire that is no parabola: its constraint has a third derivative.
#[derive(Clone, Copy, MechanicalSystem)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = m * g * y,
    constraint(wire: y == 0.5 * x.powi(2) + 0.1 * x.powi(4)),
)]
struct BeadOnWire {
    m: f64,
    g: f64,
}

/// On the ends alone, the same linearisation has one.
#[test]
fn a_linearisation_between_the_ends_of_a_constraint_that_is_not_quadratic() {
    let bead = BeadOnWire { m: 0.7, g: 9.81 };
    let start = [0.3, 0.5 * 0.3_f64.powi(2) + 0.1 * 0.3_f64.powi(4)];
    let direction = || [Direction::of_start([0.0; 2], [1.0, 0.0])];
    let between = Simulation::new(bead, Evi::midpoint(0.01).linearised_at([0.0; 2]));
    let mut run = between.start_with_tangents(start, [0.0; 2], &direction()).expect("a start");
    let error = run.advance().expect_err("no derivative").to_string();
    assert!(error.contains("constraints that are quadratic, or the trapezoidal rule"), "{error}");
    let at_ends = Simulation::new(bead, Evi::trapezoid(0.01).linearised_at([0.0; 2]));
    let mut run = at_ends.start_with_tangents(start, [0.0; 2], &direction()).expect("a start");
    run.advance().expect("a derivative");
}

#[test]
fn inputs_that_are_not_one_list_per_step() {
    let simulation = Simulation::new(DampedOscillator::STANDARD, Evi::midpoint(0.1));
    let course = Course::new([1.0], [0.0], 3).with_inputs(vec![[0.0]; 4]);
    let error = simulation.gradient_of(&course, &nothing).err();
    assert_eq!(error, Some(DerivativeError::InputCount { steps: 3, found: 4 }));
    assert_eq!(
        simulation.cost_of(&course, &nothing),
        Err(DerivativeError::InputCount { steps: 3, found: 4 })
    );
}

#[test]
fn more_exponents_than_the_motion_has_directions() {
    let start = SYSTEM.at_angles(2.0, 2.5);
    let simulation = Simulation::new(SYSTEM, Evi::midpoint(0.05));
    for (count, every) in [(5, 1), (0, 1), (1, 0)] {
        let error = LyapunovRun::new(&simulation, start.q, start.v, count, every).err();
        assert_eq!(error, Some(DerivativeError::Dimension { asked: count, dimension: 4 }));
    }
}

#[test]
fn directions_that_are_no_numbers() {
    let start = SYSTEM.at_angles(2.0, 2.5);
    let simulation = Simulation::new(SYSTEM, Evi::midpoint(0.05));
    let direction = Direction::of_start([f64::NAN; 4], [0.0; 4]);
    let error = simulation.start_with_tangents(start.q, start.v, &[direction]).err();
    assert_eq!(error, Some(DerivativeError::NotFinite { t: 0.0 }));
}

#[test]
fn a_start_beside_the_constraints() {
    let simulation = Simulation::new(SYSTEM, Evi::midpoint(0.05));
    let error = simulation.gradient_of(&Course::new([0.5, 0.0, 2.0, 0.0], [0.0; 4], 3), &nothing).err();
    assert!(
        matches!(error, Some(DerivativeError::Start(StartError::InconsistentPosition { .. }))),
        "{error:?}"
    );
}

/// A particle on a hilltop.
#[derive(Clone, Copy, MechanicalSystem)]
#[evi(
    coordinates(x),
    kinetic = 0.5 * m * der(x).powi(2),
    potential = -0.5 * k * (x - 1.0).powi(2),
)]
struct Hilltop {
    m: f64,
    k: f64,
}

/// At rest on a hilltop the step stays there, whatever its size is. Of size `h² k/m = 24` the matrix of a step with two intervals is singular,
/// `256 − 2 (32 + 4 h² k/m) = 0`: any end follows from a start beside the top.
#[test]
fn a_step_whose_end_does_not_follow_from_its_start() {
    let simulation = Simulation::new(Hilltop { m: 1.0, k: 96.0 }, Galerkin::<2>::new(0.5));
    let of_state = |_: u64, state: &State<Hilltop>, gradient: &mut StateGradient<Hilltop>| {
        gradient.q[0] += 1.0;
        state.q()[0]
    };
    let course = Course::new([1.0], [0.0], 3);
    assert_eq!(simulation.cost_of(&course, &of_state), Ok(4.0));
    let error = simulation.gradient_of(&course, &of_state).err();
    // The last step is the first one on the way back.
    assert!(matches!(error, Some(DerivativeError::Singular { t: 1.0, .. })), "{error:?}");
    let direction = Direction::of_start([1.0], [0.0]);
    let mut run = simulation.start_with_tangents([1.0], [0.0], &[direction]).expect("a start");
    let error = run.advance().err();
    assert!(matches!(error, Some(DerivativeError::Singular { t: 0.0, .. })), "{error:?}");
    assert_eq!((run.state().t(), *run.tangents()[0].q()), (0.0, [1.0]));
}

/// A step without solution: state and vectors stand where they stood.
#[test]
fn a_step_that_fails() {
    let start = SYSTEM.horizontal();
    let simulation = Simulation::new(SYSTEM, Evi::midpoint(1.5));
    let direction = Direction::of_start([0.0; 4], [0.0, 1.0, 0.0, 1.0]);
    let mut run = simulation.start_with_tangents(start.q, start.v, &[direction]).expect("a start");
    let mut before = (run.state().clone(), *run.tangents()[0].q());
    let error = loop {
        match run.advance() {
            Ok(_) => before = (run.state().clone(), *run.tangents()[0].q()),
            Err(error) => break error,
        }
        assert!(run.run().steps() < 1_000, "vacuous: no step fails");
    };
    assert!(matches!(error, DerivativeError::Step(StepError::NoSolution { .. })), "{error:?}");
    assert!(run.state() == &before.0 && *run.tangents()[0].q() == before.1);
}
