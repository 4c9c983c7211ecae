//! The steps written by hand take the specialised path's steps: same trajectories but for round-off, constraints at round-off, so that
//! the costs of both are costs of the same.

use evi_benches::hand_written::{
    ClosedFormSpringPendulum, HandWritten, HandWrittenDoublePendulum, HandWrittenLanes,
    HandWrittenSphericalPendulum, HandWrittenSpringPendulum, advance_all,
};
use evi_core::prelude::*;
use evi_examples::{DoublePendulum, SphericalPendulum, Start, StiffSpringPendulum};

const H: f64 = 0.01;

/// Both runs stay together over one unit of time, to `bound` times the round-off of the largest position and velocity on the way; and the
/// run written by hand stays on the constraints over 20 units.
#[track_caller]
fn check<const N: usize, S>(system: S, start: Start<N>, mut by_hand: impl HandWritten<N>, bound: f64)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
{
    let mut run = Simulation::new(system, Evi::midpoint(H)).start(start.q, start.v).expect("consistent");
    let (mut positions, mut velocities, mut travelled) = (0.0, 0.0, 0.0);
    let (mut reach, mut speed) = (0.0, 0.0);
    for _ in 0..100 {
        let state = run.advance().expect("solvable");
        by_hand.advance().expect("solvable");
        positions = larger(positions, largest_difference(state.q(), &by_hand.q()));
        velocities = larger(velocities, largest_difference(state.v(), &by_hand.v()));
        (reach, speed) = (larger(reach, largest(state.q())), larger(speed, largest(state.v())));
        travelled = larger(travelled, largest_difference(state.q(), &start.q));
    }
    let (positions, velocities) = (positions / reach / f64::EPSILON, velocities / speed / f64::EPSILON);
    let (mut constraints, mut hidden) = (0.0, 0.0);
    for _ in 100..2_000 {
        by_hand.advance().expect("solvable");
        let residual = run.mechanics().constraint_residual_at(0.0, &by_hand.q());
        constraints = larger(constraints, largest(residual.as_ref()));
        let residual = run.mechanics().hidden_constraint_residual_at(0.0, &by_hand.q(), &by_hand.v());
        hidden = larger(hidden, largest(residual.as_ref()));
    }
    let (constraints, hidden) = (constraints / f64::EPSILON, hidden / f64::EPSILON);
    println!(
        "{}: positions {positions:.0} ε, velocities {velocities:.0} ε, constraints {constraints:.0} ε, hidden {hidden:.1} ε",
        core::panic::Location::caller()
    );
    assert!(travelled > 0.05, "the motion is not vacuous: {travelled}");
    assert!(positions <= bound && velocities <= bound, "{positions} ε, {velocities} ε");
    // Squares of coordinates up to 2.
    assert!(constraints <= 16.0, "{constraints} ε");
    // Relative to the velocities, at turning points too: as of the specialised steps (tests/optimised/long_runs.rs).
    assert!(hidden <= 4.0, "{hidden} ε");
}

/// The larger of two magnitudes; NaN if one is.
fn larger(a: f64, b: f64) -> f64 {
    if a <= b || b.is_nan() { b } else { a }
}

fn largest(x: &[f64]) -> f64 {
    x.iter().map(|x| x.abs()).fold(0.0, larger)
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, larger)
}

const UNEQUAL: DoublePendulum = DoublePendulum { m1: 1.3, m2: 0.4, l1: 0.7, l2: 1.1, g: 9.81 };

#[track_caller]
fn check_double_pendulum(system: DoublePendulum, start: Start<4>, bound: f64) {
    check(system, start, HandWrittenDoublePendulum::new(&system, start, H), bound);
}

#[test]
fn double_pendulum() {
    // Round-off of 100 steps: 4 ε, 8 ε from horizontal, 13 ε measured.
    check_double_pendulum(DoublePendulum::UNIT, DoublePendulum::UNIT.at_angles(0.1, 0.1), 16.0);
    check_double_pendulum(DoublePendulum::UNIT, DoublePendulum::UNIT.horizontal(), 32.0);
    check_double_pendulum(UNEQUAL, UNEQUAL.at_angles(1.0, -2.0), 32.0);
}

#[test]
fn spherical_pendulum() {
    // Round-off of 100 steps: 7 ε and 23 ε measured.
    let unit = SphericalPendulum::UNIT;
    check(unit, unit.one_radian(), HandWrittenSphericalPendulum::new(&unit, unit.one_radian(), H), 32.0);
    let other = SphericalPendulum { m: 2.3, l: 0.6, g: 9.81 };
    let start = Start { q: [0.6, 0.0, 0.0], v: [0.0, 1.2, -3.0] };
    check(other, start, HandWrittenSphericalPendulum::new(&other, start, H), 64.0);
}

#[track_caller]
fn check_spring(system: StiffSpringPendulum, start: Start<2>, bound: f64) {
    check(system, start, HandWrittenSpringPendulum::new(&system, start, H), bound);
    check(system, start, ClosedFormSpringPendulum::new(&system, start, H), bound);
}

#[test]
fn stiff_spring_pendulum() {
    let stiff = StiffSpringPendulum::with_stiffness(1e4);
    // A rounding of the position is one of the force k, and one of the velocity over h: 138 ε and 30 ε measured.
    check_spring(stiff, stiff.horizontal(), 256.0);
    let other = StiffSpringPendulum { m: 0.7, l: 1.4, k: 300.0, g: 9.81 };
    check_spring(other, Start { q: [1.0, -1.2], v: [2.0, 1.0] }, 64.0);
}

#[test]
fn a_step_that_fails_is_reported_and_leaves_the_run_where_it_was() {
    let start = Start { q: [1.0, 0.0, 2.0, 0.0], v: [0.0, 1e200, 0.0, 0.0] };
    let mut run = HandWrittenDoublePendulum::new(&DoublePendulum::UNIT, start, H);
    assert_eq!(run.advance(), None);
    assert_eq!(run.q(), start.q);
    let start = Start { q: [1.0, 0.0, 0.0], v: [0.0, 1e200, 0.0] };
    let mut run = HandWrittenSphericalPendulum::new(&SphericalPendulum::UNIT, start, H);
    assert_eq!(run.advance(), None);
    assert_eq!(run.q(), start.q);
    let start = Start { q: [0.0, 0.0], v: [0.0, f64::NAN] };
    let mut run = HandWrittenSpringPendulum::new(&StiffSpringPendulum::with_stiffness(1e4), start, H);
    assert_eq!(run.advance(), None);
    assert_eq!(run.q(), start.q);
}

/// Eight double pendulums of unequal masses and lengths side by side, each as by itself; at the start and at the end the lanes need corrections of their own.
#[test]
fn double_pendulums_in_lanes() {
    let system = |lane: usize| {
        let share = 0.1 * lane as f64;
        DoublePendulum { m1: 1.0 + share, m2: 1.5 - share, l1: 0.8 + share, l2: 1.2, g: 9.81 }
    };
    let start = |lane: usize| system(lane).at_angles(0.2 * lane as f64, 0.5);
    let mut lanes = [HandWrittenLanes::new(core::array::from_fn(system), core::array::from_fn(start), H)];
    assert!(advance_all(&mut lanes, 200), "solvable");
    let mut largest_seen = 0.0;
    for lane in 0..8 {
        let mut alone = HandWrittenDoublePendulum::new(&system(lane), start(lane), H);
        for _ in 0..200 {
            alone.advance().expect("solvable");
        }
        largest_seen = larger(largest_seen, largest_difference(&lanes[0].q(lane), &alone.q()));
        largest_seen = larger(largest_seen, largest_difference(&lanes[0].v(lane), &alone.v()));
    }
    println!("{largest_seen:e}");
    // Round-off of 200 steps, which swings of up to 1.4 rad amplify.
    assert!(largest_seen <= 1e-12, "{largest_seen:e}");
}
