//! Every member on scenes of every structure: runs that were resumed, against runs that went on.

use evi_core::baseline::{GeneralizedAlpha, ImplicitMidpoint, Rattle, Rk4, Shake};
use evi_core::integrator::Statistics;
use evi_core::mechanics::Mechanics;
use evi_core::prelude::*;
use evi_examples::{CarAxis, DoublePendulum, Kepler, SphericalPendulum, Start, StiffSpringPendulum};
use evi_tests::scenes::{DoublePendulumInAngles, PushedDumbbell};

/// Steps before the checkpoint and after it.
const STEPS: [u64; 2] = [37, 41];

const DOUBLE: DoublePendulum = DoublePendulum { m1: 1.3, m2: 0.7, l1: 0.9, l2: 1.1, g: 9.81 };
const SPHERICAL: SphericalPendulum = SphericalPendulum::UNIT;
const SPRING: StiffSpringPendulum = StiffSpringPendulum::with_stiffness(1e3);
const ANGLES: DoublePendulumInAngles = DoublePendulumInAngles::UNEQUAL;
const HANGING: [f64; 4] = [0.0, -0.9, 0.0, -2.0];

/// Whether steps depend on those before through more than the state: in their last bits, or in what they take to be found.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Past {
    Remembered,
    Forgotten,
}
use Past::{Forgotten, Remembered};

/// Takes steps, a checkpoint, and steps again, on two ways: by the run that the checkpoint was taken of, and by the one that was resumed from it. On a
/// third one by a map that has not seen the steps before, which shows whether there is something to remember.
#[track_caller]
fn check<S, F, const N: usize>(system: S, scheme: F, start: Start<N>, past: Past)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Clone,
    F: Scheme<S>,
{
    assert_eq!(resumed(system, scheme, start).0, past);
}

/// The same for steps of which only some may remember; returns what the run has counted, too.
#[track_caller]
fn resumed<S, F, const N: usize>(system: S, scheme: F, start: Start<N>) -> (Past, Statistics)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Clone,
    F: Scheme<S>,
{
    let simulation = Simulation::new(system.clone(), scheme);
    let start = simulation.start_projected(0.5, start.q, start.v).expect("near the constraints");
    let mut run = start.with_tally(Statistics::default());
    run.inputs_mut().as_mut().iter_mut().zip([0.3, -0.2]).for_each(|(input, push)| *input = push);
    let advance = |run: &mut Run<S, F::Step, Statistics>, steps: u64| {
        for _ in 0..steps {
            run.advance().expect("the step exists");
        }
    };
    advance(&mut run, STEPS[0]);
    let checkpoint = run.checkpoint();
    assert_eq!((checkpoint.t().to_bits(), checkpoint.steps()), (run.state().t().to_bits(), STEPS[0]));

    let mut resumed = simulation.resume_with(&checkpoint, Statistics::default()).expect("its own checkpoint");
    assert_eq!(resumed.checkpoint(), checkpoint, "not all of it was resumed");
    let (mut state, counted) = (run.state().clone(), *run.tally());
    advance(&mut run, STEPS[1]);
    advance(&mut resumed, STEPS[1]);
    // State, memory and tally, all bits of them.
    assert_eq!(resumed.checkpoint(), run.checkpoint());

    let mut forgetful = simulation.scheme().prepare(Mechanics::new(&system)).expect("prepared before");
    let mut counts = counted;
    for _ in 0..STEPS[1] {
        forgetful.advance(&mut state, &mut counts).expect("the step exists");
    }
    let is_same = state.q() == run.state().q() && state.p() == run.state().p() && counts == *run.tally();
    (if is_same { Forgotten } else { Remembered }, *run.tally())
}

fn swing() -> Start<4> {
    DOUBLE.at_angles(0.3, -0.2)
}

#[test]
fn steps_with_positions_eliminated() {
    check(DOUBLE, Evi::midpoint(0.01), swing(), Remembered);
    check(DOUBLE, Evi::simpson(0.01).frequency(2.4).about(HANGING), swing(), Remembered);
    check(SPHERICAL, Evi::trapezoid(0.02), SPHERICAL.one_radian(), Remembered);
    check(DOUBLE, Rattle::new(0.01), swing(), Remembered);
}

#[test]
fn steps_for_positions_and_multipliers() {
    check(SPRING, Evi::simpson(0.01), SPRING.horizontal(), Remembered);
    check(ANGLES, Evi::simpson(0.01), DoublePendulumInAngles::MODERATE, Remembered);
    // Forces that are not linear: explicit at the ends of a step, implicit elsewhere; a constraint that moves.
    check(SPRING, Evi::trapezoid(0.01), SPRING.horizontal(), Forgotten);
    check(CarAxis::STANDARD, Evi::simpson(0.005), CarAxis::STANDARD.standard_start(), Remembered);
    check(PushedDumbbell::STANDARD, Evi::midpoint(0.02), PushedDumbbell::STANDARD.turning(), Remembered);
}

#[test]
fn steps_found_by_a_distance() {
    // From the free flight, which the state determines.
    check(SPRING, Evi::midpoint(0.01), SPRING.horizontal(), Forgotten);
    check(Kepler::UNIT, Evi::midpoint(0.01), Kepler::UNIT.near_end(0.6), Forgotten);
    check(SPRING, Evi::midpoint(0.01).compensated(), SPRING.horizontal(), Remembered);
}

#[test]
fn steps_with_a_matrix_frequency() {
    check(DOUBLE, Evi::trapezoid(0.01).linearised_at(HANGING), swing(), Remembered);
    // Newton's iteration begins from the state.
    check(DOUBLE, Evi::midpoint(0.01).linearised_at(HANGING), swing(), Forgotten);
}

#[test]
fn compositions_and_lost_digits() {
    let composed = Evi::midpoint(0.02).composed(Composition::suzuki_4());
    check(DOUBLE, composed, swing(), Remembered);
    check(DOUBLE, composed.compensated(), swing(), Remembered);
    check(SPRING, Evi::trapezoid(0.01).compensated(), SPRING.horizontal(), Remembered);
}

#[test]
fn inner_points() {
    check(DOUBLE, Galerkin::<3>::new(0.02), swing(), Remembered);
    check(DOUBLE, Galerkin::<3>::new(0.02).by_newton(), swing(), Remembered);
    check(DOUBLE, Galerkin::<2>::new(0.02).frequency(2.4).compensated(), swing(), Remembered);
    check(PushedDumbbell::STANDARD, Galerkin::<4>::new(0.05), PushedDumbbell::STANDARD.turning(), Remembered);
    // So stiff a spring that passes begin again, or Newton's iteration takes their place.
    let (_, counts) = resumed(SPRING, Galerkin::<2>::new(0.1), SPRING.horizontal());
    assert!(counts.restarts > 0 && (1..STEPS[0] + STEPS[1]).contains(&counts.newton_steps), "{counts:?}");
}

#[test]
fn steps_in_parts() {
    // From the horizontal so long that some have no solution as a whole.
    let (system, scheme) =
        (DoublePendulum::UNIT, Evi::simpson(0.1).frequency(9.81_f64.sqrt()).rescued::<6>());
    // Steps as long as these trust no prediction: the past is in the last bits of a momentum, or by chance in none.
    let (_, counts) = resumed(system, scheme, system.horizontal());
    assert!(counts.rescued_steps > 0, "{counts:?}");
}

#[test]
fn gauss_nodes() {
    check(ANGLES, Gauss::<4>::new(0.1), DoublePendulumInAngles::MODERATE, Remembered);
    check(ANGLES, Gauss::<4>::new(0.1).compensated(), DoublePendulumInAngles::MODERATE, Remembered);
    // Newton's iteration begins from the state.
    check(ANGLES, Gauss::<2>::new(0.05).by_newton(), DoublePendulumInAngles::MODERATE, Forgotten);
}

#[test]
fn methods_to_compare_with() {
    check(DOUBLE, Shake::new(0.01), swing(), Remembered);
    check(DOUBLE, ImplicitMidpoint::new(0.01), swing(), Remembered);
    check(DOUBLE, GeneralizedAlpha::new(0.01), swing(), Remembered);
    check(DOUBLE, Rk4::new(0.01), swing(), Forgotten);
}
