//! Every rule and kind of curve, with constraints.

use super::*;

#[test]
fn midpoint_linear() {
    check(&double_pendulum(), Evi::midpoint, 2.0);
}

#[test]
fn simpson_linear() {
    check(&double_pendulum(), Evi::simpson, 2.0);
}

#[test]
fn midpoint_trigonometric() {
    check(&double_pendulum(), |h| Evi::midpoint(h).frequency(3.13), 2.0);
}

#[test]
fn simpson_trigonometric() {
    check(&double_pendulum(), |h| Evi::simpson(h).frequency(3.13), 2.0);
}

#[test]
fn midpoint_with_a_frequency_per_bob() {
    check(&double_pendulum(), |h| Evi::midpoint(h).frequencies(PER_BOB), 2.0);
}

#[test]
fn simpson_with_a_frequency_per_bob() {
    check(&double_pendulum(), |h| Evi::simpson(h).frequencies(PER_BOB), 2.0);
}

#[test]
fn midpoint_with_unequal_kinds_per_coordinate() {
    check(&double_pendulum(), |h| Evi::midpoint(h).frequencies(PER_COORDINATE), 2.0);
}

#[test]
fn simpson_with_unequal_kinds_per_coordinate() {
    check(&double_pendulum(), |h| Evi::simpson(h).frequencies(PER_COORDINATE), 2.0);
}

#[test]
fn midpoint_hyperbolic() {
    check(&double_pendulum(), |h| Evi::midpoint(h).frequency(HYPERBOLIC), 2.0);
}

#[test]
fn simpson_hyperbolic() {
    check(&double_pendulum(), |h| Evi::simpson(h).frequency(HYPERBOLIC), 2.0);
}

#[test]
fn gauss_2() {
    check(&double_pendulum(), |h| Evi::new(Quadrature::<2>::gauss(), h).frequency(3.13), 2.0);
}

#[test]
fn gauss_3() {
    check(&double_pendulum(), |h| Evi::new(Quadrature::<3>::gauss(), h).frequency(3.13), 2.0);
}

#[test]
fn lobatto_2() {
    check(&double_pendulum(), |h| Evi::new(Quadrature::<2>::lobatto(), h).frequency(3.13), 2.0);
}

#[test]
fn lobatto_4() {
    check(&double_pendulum(), |h| Evi::new(Quadrature::<4>::lobatto(), h).frequency(3.13), 2.0);
}

#[test]
fn uniform_4() {
    check(&double_pendulum(), |h| Evi::new(Quadrature::<4>::uniform(), h).frequency(3.13), 2.0);
}

#[test]
fn asymmetric_nodes_that_integrate_linear_functions() {
    check(&double_pendulum(), |h| on_nodes([0.1, 0.6], h).frequency(3.13), 2.0);
}

#[test]
fn the_left_rectangle_has_order_1() {
    check(&double_pendulum(), |h| on_nodes([0.0], h), 1.0);
}

#[test]
fn rattle() {
    check(&double_pendulum(), Rattle::new, 2.0);
}

#[test]
fn rk4() {
    let motion = Motion { steps: [100, 200, 400, 800, 1600], ..double_pendulum() };
    check_state(&motion, Rk4::new, 4.0);
}
