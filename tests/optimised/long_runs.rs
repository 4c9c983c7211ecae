//! Runs of 100,000 and of a million steps: constraints and hidden constraints at round-off at every one of them,
//! whatever the step size; energy without drift.
//!
//! Drift is looked for on regular motion only. On chaotic motion a close passage kicks the energy error at
//! random, a slope means nothing, and a bound is asserted instead.

use evi_core::baseline::{Rattle, Rk4};
use evi_core::prelude::*;
use evi_core::report::Drift;
use evi_examples::{DoublePendulum, GRAVITY, SphericalPendulum, Start};
use evi_tests::conservation::largest_residuals;

const STEPS: usize = 100_000;
const MANY_STEPS: usize = 1_000_000;
/// Blocks of 1,562 steps: tens of periods of the slowest oscillation at the smallest step size below.
const BLOCKS: usize = 64;
/// Largest `|φ|` for unit rods. A square of a coordinate difference of size 1, made of coordinates of size 2
/// that are rounded to one ε, is off by a few of them: 7 measured.
const CONSTRAINT: f64 = 8.0 * f64::EPSILON;
/// Largest `|G v| / (‖G‖ ‖v‖)`: a scalar product of four terms, 1.7 ε measured.
const HIDDEN_CONSTRAINT: f64 = 4.0 * f64::EPSILON;
/// A drift that the interval excludes may sum up, over the run, to this part of the energy's oscillation:
/// 1/400 measured.
const RESOLUTION: f64 = 1.0 / 200.0;

/// What a run leaves behind.
struct Record {
    /// Energy after every step.
    energies: Vec<f64>,
    /// Largest distance of the energy from that of the start.
    energy_error: f64,
    constraint: f64,
    hidden_constraint: f64,
}

impl Record {
    fn drift(&self) -> Drift {
        Drift::of(&self.energies, BLOCKS).expect("there are more steps than blocks")
    }
}

/// The largest of `seen` and the magnitudes of `values`; NaN is larger than all.
fn largest(seen: f64, values: &[f64]) -> f64 {
    values.iter().fold(
        seen,
        |largest: f64, value| {
            if value.abs() <= largest || largest.is_nan() { largest } else { value.abs() }
        },
    )
}

#[track_caller]
fn record<S, F, const N: usize>(system: S, scheme: F, start: Start<N>, steps: usize) -> Record
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S>,
{
    let mut run = Simulation::new(system, scheme).start(start.q, start.v).expect("the start is consistent");
    let initial = run.energy();
    let (mut constraint, mut hidden_constraint) = (0.0, 0.0);
    let mut energies = Vec::with_capacity(steps);
    for _ in 0..steps {
        let state = run.advance().expect("every step has a solution").clone();
        constraint = largest(constraint, run.mechanics().constraint_residual(&state).as_ref());
        let hidden = run.mechanics().hidden_constraint_residual(&state);
        hidden_constraint = largest(hidden_constraint, hidden.as_ref());
        energies.push(run.energy());
    }
    let energy_error = energies.iter().fold(0.0, |error, energy| largest(error, &[energy - initial]));
    Record { energies, energy_error, constraint, hidden_constraint }
}

#[track_caller]
fn check_constraints(record: &Record, hidden_constraint: f64) {
    let in_ulps = |residual: f64| residual / f64::EPSILON;
    println!(
        "{}: φ {:.2} ε, G v {:.2} ε, energy {:.3e}, {:?}",
        core::panic::Location::caller(),
        in_ulps(record.constraint),
        in_ulps(record.hidden_constraint),
        record.energy_error,
        record.drift()
    );
    assert!(record.constraint <= CONSTRAINT, "φ: {:.2} ε", in_ulps(record.constraint));
    assert!(record.hidden_constraint <= hidden_constraint, "G v: {:.2} ε", in_ulps(record.hidden_constraint));
    // Exact zeros would mean that nothing moved.
    assert!(record.constraint > 0.0 && record.hidden_constraint > 0.0);
}

/// Constraints at round-off; no drift that could be seen beside the oscillation of the energy, which is not
/// zero.
#[track_caller]
fn check_regular<S, F, const N: usize>(system: S, scheme: F, start: Start<N>, energy_error: f64)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S>,
{
    let record = record(system, scheme, start, STEPS);
    check_constraints(&record, HIDDEN_CONSTRAINT);
    check_energy(&record, energy_error);
}

#[track_caller]
fn check_energy(record: &Record, energy_error: f64) {
    assert!(record.energy_error <= energy_error, "energy error {:e}", record.energy_error);
    assert!(record.energy_error >= 0.1 * energy_error, "the bound {energy_error:e} says nothing");
    let drift = record.drift();
    assert!(drift.is_indistinguishable_from_zero(), "{drift:?}");
    let resolution = drift.half_width * record.energies.len() as f64 / record.energy_error;
    assert!(resolution <= RESOLUTION, "the interval is {resolution:.1e} of the oscillation");
}

/// Constraints at round-off, energy within a bound.
#[track_caller]
fn check_chaotic(scheme: impl Scheme<DoublePendulum>) {
    /// The potential energy of the motion spans 59 J; the error peaks in rare close passages, at 0.125 J.
    const ENERGY_ERROR: f64 = 0.25;
    let record = record(DoublePendulum::UNIT, scheme, DoublePendulum::UNIT.horizontal(), STEPS);
    check_constraints(&record, HIDDEN_CONSTRAINT);
    assert!(record.energy_error <= ENERGY_ERROR, "energy error {:e}", record.energy_error);
}

/// A baseline that is not symplectic, on the same motion with the same number of steps.
#[track_caller]
fn check_drifts<S, const N: usize>(system: S, h: f64, start: Start<N>)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
{
    let record = record(system, Rk4::new(h), start, STEPS);
    let drift = record.drift();
    println!("{}: {drift:?}", core::panic::Location::caller());
    assert!(!drift.is_indistinguishable_from_zero(), "{drift:?}");
    assert!(drift.slope.abs() > 3.0 * drift.half_width, "{drift:?}");
    assert!(record.constraint > 1e6 * CONSTRAINT, "the differentiated constraints do not drift");
}

const DOUBLE: DoublePendulum = DoublePendulum::UNIT;
const SPHERICAL: SphericalPendulum = SphericalPendulum::UNIT;
/// The slow normal mode of the double pendulum, `√(g (2 − √2))`.
const SLOW_MODE: f64 = 2.397;

/// Both rods 0.1 rad from their hanging rest: regular motion, two incommensurable frequencies.
fn mild() -> Start<4> {
    DOUBLE.at_angles(0.1, 0.1)
}

#[test]
fn the_mild_double_pendulum_keeps_its_energy() {
    check_regular(DOUBLE, Evi::midpoint(0.05), mild(), 1e-3);
    check_regular(DOUBLE, Evi::simpson(0.05), mild(), 1e-3);
}

#[test]
fn the_mild_double_pendulum_keeps_its_energy_with_an_exponential_scheme() {
    check_regular(DOUBLE, Evi::simpson(0.05).frequency(SLOW_MODE), mild(), 1e-3);
    check_regular(DOUBLE, Evi::midpoint(0.05).frequency(SLOW_MODE), mild(), 1e-3);
}

#[test]
fn the_spherical_pendulum_keeps_its_energy() {
    check_regular(SPHERICAL, Evi::midpoint(0.01), SPHERICAL.one_radian(), 2e-3);
    check_regular(SPHERICAL, Evi::simpson(0.01), SPHERICAL.one_radian(), 2e-3);
}

#[test]
fn the_spherical_pendulum_keeps_its_energy_with_an_exponential_scheme() {
    check_regular(SPHERICAL, Evi::simpson(0.01).frequency(3.132), SPHERICAL.one_radian(), 2e-3);
    check_regular(SPHERICAL, Evi::midpoint(0.01).frequency(3.132), SPHERICAL.one_radian(), 2e-3);
}

#[test]
fn rattle_keeps_the_energy_too() {
    /// Its last kick carries the weight `½ h g`, which the projection cancels: near the turning points that
    /// is a thousand times the velocity, and so is its round-off: 157 ε measured, more or less with the
    /// last bits of the motion.
    const HIDDEN_CONSTRAINT_AT_TURNING_POINTS: f64 = 1e3 * f64::EPSILON;
    let record = record(DOUBLE, Rattle::new(0.05), mild(), STEPS);
    check_constraints(&record, HIDDEN_CONSTRAINT_AT_TURNING_POINTS);
    check_energy(&record, 1e-3);
    // Without turning points.
    check_regular(SPHERICAL, Rattle::new(0.01), SPHERICAL.one_radian(), 2e-3);
}

/// The control of the tests above: here the same statistics see a drift.
#[test]
fn runge_kutta_drifts() {
    check_drifts(DOUBLE, 0.02, mild());
    check_drifts(SPHERICAL, 0.01, SPHERICAL.one_radian());
}

#[test]
fn chaotic_motion_stays_on_the_constraints_with_bounded_energy() {
    check_chaotic(Evi::midpoint(0.01));
    check_chaotic(Evi::simpson(0.01));
}

#[test]
fn chaotic_motion_stays_on_the_constraints_with_an_exponential_scheme() {
    check_chaotic(Evi::midpoint(0.01).frequency(3.132));
    check_chaotic(Evi::simpson(0.01).frequency(3.132));
}

#[test]
fn chaotic_motion_stays_on_the_constraints_with_rattle() {
    check_chaotic(Rattle::new(0.01));
}

/// A million steps of any size, over a factor of 16.
#[track_caller]
fn check_many_steps<S, F, const N: usize>(system: S, scheme: impl Fn(f64) -> F, start: Start<N>)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Clone,
    F: Scheme<S>,
{
    /// Largest `|φ|` of lengths 0.9 to 1.1: 5 ε measured, 10 ε at the largest step size.
    const CONSTRAINT: f64 = 16.0 * f64::EPSILON;
    for h in [0.005, 0.02, 0.08] {
        let start = Start { q: start.q, v: start.v };
        let [constraint, hidden] = largest_residuals(system.clone(), scheme(h), start, MANY_STEPS);
        let [in_ulps, hidden_in_ulps] = [constraint, hidden].map(|residual| residual / f64::EPSILON);
        println!("h = {h}: φ {in_ulps:.1} ε, G v {hidden_in_ulps:.2} ε");
        assert!(constraint <= CONSTRAINT, "φ: {in_ulps:.1} ε at h = {h}");
        assert!(hidden <= HIDDEN_CONSTRAINT, "G v: {hidden_in_ulps:.2} ε at h = {h}");
    }
}

#[test]
fn a_million_steps_of_any_size_stay_on_the_constraints() {
    let system = DoublePendulum { m1: 1.3, m2: 0.7, l1: 0.9, l2: 1.1, g: GRAVITY };
    let start = || system.at_angles(0.1, -0.05);
    check_many_steps(system, Evi::midpoint, start());
    check_many_steps(system, |h| Evi::simpson(h).frequency(SLOW_MODE), start());
    check_many_steps(SPHERICAL, Evi::midpoint, SPHERICAL.one_radian());
    check_many_steps(SPHERICAL, |h| Evi::simpson(h).frequency(3.132), SPHERICAL.one_radian());
}

#[test]
fn a_million_steps_keep_the_energy() {
    let check = |record: Record, energy_error: f64| {
        check_constraints(&record, HIDDEN_CONSTRAINT);
        check_energy(&record, energy_error);
    };
    check(record(SPHERICAL, Evi::midpoint(0.01), SPHERICAL.one_radian(), MANY_STEPS), 2e-3);
    check(record(DOUBLE, Evi::midpoint(0.05), mild(), MANY_STEPS), 1e-3);
}
