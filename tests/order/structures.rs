//! One scene for every structure of `L` and `φ`: what a missing term of the step equations would break.

use super::*;

#[test]
fn configuration_dependent_mass_midpoint() {
    check(&double_pendulum_in_angles(), Evi::midpoint, 2.0);
}

#[test]
fn configuration_dependent_mass_simpson_trigonometric() {
    check(&double_pendulum_in_angles(), |h| Evi::simpson(h).frequencies([3.13.into(), 1.7.into()]), 2.0);
}

#[test]
fn gyroscopic_coupling_midpoint() {
    check(&charged_particle(), Evi::midpoint, 2.0);
}

#[test]
fn gyroscopic_coupling_simpson_trigonometric() {
    check(&charged_particle(), |h| Evi::simpson(h).frequencies([2.0.into(), 3.0.into()]), 2.0);
}

#[test]
fn gyroscopic_coupling_rk4() {
    check_state(&charged_particle(), Rk4::new, 4.0);
}

#[test]
fn gyroscopic_coupling_with_a_constraint_midpoint() {
    check(&charged_spherical_pendulum(), Evi::midpoint, 2.0);
}

#[test]
fn gyroscopic_coupling_with_a_constraint_simpson_trigonometric() {
    check(&charged_spherical_pendulum(), |h| Evi::simpson(h).frequency(2.0), 2.0);
}

#[test]
fn gyroscopic_coupling_with_a_constraint_rk4() {
    check_state(&charged_spherical_pendulum(), Rk4::new, 4.0);
}

#[test]
fn time_dependent_potential_midpoint() {
    check(&modulated_pendulum(), Evi::midpoint, 2.0);
}

#[test]
fn time_dependent_potential_simpson_trigonometric() {
    check(&modulated_pendulum(), |h| Evi::simpson(h).frequency(3.0), 2.0);
}

#[test]
fn time_dependent_potential_rattle() {
    check(&modulated_pendulum(), Rattle::new, 2.0);
}

#[test]
fn time_dependent_potential_rk4() {
    check_state(&modulated_pendulum(), Rk4::new, 4.0);
}

#[test]
fn time_dependent_mass_midpoint() {
    check(&damped_pendulum(), Evi::midpoint, 2.0);
}

#[test]
fn time_dependent_mass_simpson_trigonometric() {
    check(&damped_pendulum(), |h| Evi::simpson(h).frequency(3.0), 2.0);
}

#[test]
fn time_dependent_mass_rk4() {
    check_state(&damped_pendulum(), Rk4::new, 4.0);
}

#[test]
fn not_quadratic_in_velocity_with_a_constraint_midpoint() {
    check(&relativistic_bead(), Evi::midpoint, 2.0);
}

#[test]
fn not_quadratic_in_velocity_with_a_constraint_simpson_trigonometric() {
    check(&relativistic_bead(), |h| Evi::simpson(h).frequency(2.0), 2.0);
}

#[test]
fn not_quadratic_in_velocity_with_a_constraint_rk4() {
    check_state(&relativistic_bead(), Rk4::new, 4.0);
}

#[test]
fn moving_constraint_midpoint() {
    check(&kapitza_pendulum(), Evi::midpoint, 2.0);
}

#[test]
fn moving_constraint_simpson_trigonometric() {
    check(&kapitza_pendulum(), |h| Evi::simpson(h).frequency(3.0), 2.0);
}

#[test]
fn moving_constraint_rattle() {
    check(&kapitza_pendulum(), Rattle::new, 2.0);
}

#[test]
fn moving_constraint_rk4() {
    let motion = Motion { steps: [125, 250, 500, 1000, 2000], ..kapitza_pendulum() };
    check_state(&motion, Rk4::new, 4.0);
}
