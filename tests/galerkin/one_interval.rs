//! The members that have other names.

use super::*;

#[track_caller]
fn check_same<F: Scheme<DoublePendulum>, G: Scheme<DoublePendulum>>(one: F, other: G) {
    let (system, start) = swing();
    let end = |state: &State<DoublePendulum>| [*state.q(), *state.v()].concat();
    let mut run = Simulation::new(system, one).start(start.q, start.v).expect("a start");
    let one = end(run.advance_to(1.0).expect("every step"));
    let mut run = Simulation::new(system, other).start(start.q, start.v).expect("a start");
    let difference = largest_difference(&one, &end(run.advance_to(1.0).expect("every step")));
    println!("{}: difference {difference:e}", core::panic::Location::caller());
    // 32 roundings of velocities of size 4, as for the coincidences of order 2.
    assert!(difference <= 32.0 * 4.0 * f64::EPSILON, "differ by {difference:e}");
}

#[test]
fn is_rattle() {
    check_same(Galerkin::<1>::new(0.01), Rattle::new(0.01));
}

#[test]
fn is_the_exponential_integrator_on_the_trapezoidal_rule() {
    let trapezoid = Evi::new(Quadrature::<2>::lobatto(), 0.01);
    check_same(Galerkin::<1>::new(0.01).frequency(3.13), trapezoid.frequency(3.13));
    let hyperbolic = Frequency::Hyperbolic(2.5);
    check_same(Galerkin::<1>::new(0.01).frequency(hyperbolic), trapezoid.frequency(hyperbolic));
    let each = [3.13.into(), hyperbolic, Frequency::ZERO, 5.0.into()];
    check_same(Galerkin::<1>::new(0.01).frequencies(each), trapezoid.frequencies(each));
}
