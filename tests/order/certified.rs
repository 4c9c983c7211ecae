//! Positions, velocities and index-1 multipliers of order 2 towards certified digits.

use super::*;

fn unit(sample: usize) -> Motion<DoublePendulum> {
    let system = DoublePendulum::UNIT;
    let end = references::DOUBLE_PENDULUM[sample];
    Motion::certified(system, system.horizontal(), end, (end.t * 80.0) as u32)
}

fn mild(sample: usize) -> Motion<DoublePendulum> {
    let system = DoublePendulum::UNIT;
    let end = references::DOUBLE_PENDULUM_MILD[sample];
    Motion::certified(system, system.at_angles(0.1, 0.1), end, (end.t * 100.0) as u32)
}

fn spherical(sample: usize) -> Motion<SphericalPendulum> {
    let system = SphericalPendulum::UNIT;
    let end = references::SPHERICAL_PENDULUM[sample];
    Motion::certified(system, system.one_radian(), end, (end.t * 60.0) as u32)
}

/// `coarsest` steps resolve the radial oscillation of frequency `√k`: `h √k = 0.1`.
fn stiff(k: f64, end: Certified, coarsest: u32) -> Motion<StiffSpringPendulum> {
    let system = StiffSpringPendulum::with_stiffness(k);
    Motion::certified(system, system.horizontal(), end, coarsest)
}

#[test]
fn horizontal_double_pendulum_after_a_quarter() {
    check_certified(&unit(0), Evi::midpoint, 0.4);
    check_certified(&unit(0), |h| Evi::simpson(h).frequency(3.13), 0.7);
}

#[test]
fn horizontal_double_pendulum_after_a_half() {
    check_certified(&unit(1), Evi::midpoint, 2.0);
    check_certified(&unit(1), |h| Evi::simpson(h).frequency(3.13), 3.0);
}

#[test]
fn horizontal_double_pendulum_after_one() {
    check_certified(&unit(2), Evi::midpoint, 10.0);
    check_certified(&unit(2), |h| Evi::simpson(h).frequency(3.13), 13.0);
}

#[test]
fn mild_double_pendulum_after_one() {
    check_certified(&mild(0), Evi::midpoint, 0.2);
    check_certified(&mild(0), |h| Evi::simpson(h).frequency(3.13), 0.3);
}

#[test]
fn mild_double_pendulum_after_ten() {
    check_certified(&mild(1), Evi::midpoint, 2.0);
    check_certified(&mild(1), |h| Evi::simpson(h).frequency(3.13), 4.0);
}

#[test]
fn spherical_pendulum_after_one() {
    check_certified(&spherical(0), Evi::midpoint, 1.0);
    check_certified(&spherical(0), |h| Evi::simpson(h).frequency(3.13), 1.5);
}

#[test]
fn spherical_pendulum_after_ten() {
    check_certified(&spherical(1), Evi::midpoint, 25.0);
    check_certified(&spherical(1), |h| Evi::simpson(h).frequency(3.13), 35.0);
}

#[test]
fn stiff_spring_pendulum_1e2() {
    let motion = stiff(1e2, references::STIFF_SPRING_PENDULUM_1E2, 100);
    check_certified(&motion, Evi::midpoint, 6.0);
    check_certified(&motion, Evi::simpson, 3.0);
}

#[test]
fn stiff_spring_pendulum_1e4() {
    let motion = stiff(1e4, references::STIFF_SPRING_PENDULUM_1E4, 1000);
    check_certified(&motion, Evi::midpoint, 6.0);
    check_certified(&motion, Evi::simpson, 3.0);
}
