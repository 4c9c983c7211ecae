//! Orders, on certified references and on refinement.

use super::*;

#[test]
fn polynomials_on_the_constrained_double_pendulum() {
    check_orders(&gentle_double_pendulum(), 400, Galerkin::<1>::new, 2.0);
    check_orders(&gentle_double_pendulum(), 8, Galerkin::<2>::new, 4.0);
    check_orders(&gentle_double_pendulum(), 4, Galerkin::<3>::new, 6.0);
    check_orders(&gentle_double_pendulum(), 4, Galerkin::<4>::new, 8.0);
}

#[test]
fn mixed_curves_on_the_constrained_double_pendulum() {
    let motion = gentle_double_pendulum();
    check_orders(&motion, 400, |h| Galerkin::<1>::new(h).frequency(3.13), 2.0);
    check_orders(&motion, 8, |h| Galerkin::<2>::new(h).frequency(3.13), 4.0);
    check_orders(&motion, 4, |h| Galerkin::<3>::new(h).frequency(3.13), 6.0);
    check_orders(&motion, 4, |h| Galerkin::<3>::new(h).frequency(Frequency::Hyperbolic(2.5)), 6.0);
    check_orders(&motion, 4, |h| Galerkin::<3>::new(h).frequencies(PER_COORDINATE), 6.0);
}

/// All kinds of curves.
const PER_COORDINATE: [Frequency; 4] = [
    Frequency::Trigonometric(3.13),
    Frequency::Hyperbolic(2.0),
    Frequency::ZERO,
    Frequency::Trigonometric(5.0),
];

#[test]
fn configuration_dependent_mass() {
    check_orders(&long_double_pendulum_in_angles(), 8, Galerkin::<3>::new, 6.0);
    check_orders(&long_double_pendulum_in_angles(), 8, |h| Galerkin::<2>::new(h).frequency(2.0), 4.0);
}

#[test]
fn configuration_dependent_mass_with_constraints() {
    check_orders(&slider_crank(), 20, Galerkin::<2>::new, 4.0);
    check_orders(&slider_crank(), 20, Galerkin::<3>::new, 6.0);
    check_orders(&slider_crank(), 20, Galerkin::<4>::new, 8.0);
}

#[test]
fn gyroscopic_coupling_with_a_constraint() {
    check_orders(&charged_spherical_pendulum(), 4, Galerkin::<3>::new, 6.0);
    check_orders(&charged_spherical_pendulum(), 4, |h| Galerkin::<2>::new(h).frequency(2.0), 4.0);
}

/// On this motion the errors of ten powers of `h` settle above round-off; on the double pendulum they change sign until there.
#[test]
fn five_intervals() {
    check_orders(&long_charged_spherical_pendulum(), 8, Galerkin::<5>::new, 10.0);
}

#[test]
fn not_quadratic_in_velocity_with_a_constraint() {
    check_orders(&relativistic_bead(), 4, Galerkin::<2>::new, 4.0);
    check_orders(&relativistic_bead(), 4, |h| Galerkin::<2>::new(h).frequency(2.0), 4.0);
}

#[test]
fn moving_constraint() {
    check_orders(&kapitza_pendulum(), 20, Galerkin::<3>::new, 6.0);
    check_orders(&kapitza_pendulum(), 20, |h| Galerkin::<2>::new(h).frequency(3.0), 4.0);
}

#[test]
fn time_dependent_lagrangians() {
    check_orders(&modulated_pendulum(), 6, Galerkin::<3>::new, 6.0);
    check_orders(&damped_pendulum(), 6, |h| Galerkin::<3>::new(h).frequency(3.0), 6.0);
}

/// Drag and a drive that depends on time, with a constraint.
#[test]
fn forces() {
    let system = DrivenPendulum::STANDARD;
    let motion = Motion::certified(system, system.horizontal(), references::DRIVEN_PENDULUM, 50);
    let motion = Motion { multipliers: Vec::new(), ..motion.without_energy() };
    check_orders(&motion, 4, Galerkin::<2>::new, 4.0);
    check_orders(&motion, 4, Galerkin::<3>::new, 6.0);
    check_orders(&motion, 4, |h| Evi::midpoint(h).composed(Composition::kahan_li_6()), 6.0);
}

#[test]
fn a_composition_raises_the_order_of_one_interval() {
    let scheme = |h| Galerkin::<1>::new(h).frequency(3.13).composed(Composition::kahan_li_6());
    check_orders(&gentle_double_pendulum(), 10, scheme, 6.0);
}
