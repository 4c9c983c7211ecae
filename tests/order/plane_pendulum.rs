//! Every rule and kind of curve, without constraints.

use super::*;

#[test]
fn midpoint_linear() {
    check(&pendulum(), Evi::midpoint, 2.0);
}

#[test]
fn simpson_linear() {
    check(&pendulum(), Evi::simpson, 2.0);
}

#[test]
fn midpoint_trigonometric() {
    check(&pendulum(), |h| Evi::midpoint(h).frequency(3.13), 2.0);
}

#[test]
fn simpson_trigonometric() {
    check(&pendulum(), |h| Evi::simpson(h).frequency(3.13), 2.0);
}

#[test]
fn midpoint_hyperbolic() {
    check(&pendulum(), |h| Evi::midpoint(h).frequency(HYPERBOLIC), 2.0);
}

#[test]
fn simpson_hyperbolic() {
    check(&pendulum(), |h| Evi::simpson(h).frequency(HYPERBOLIC), 2.0);
}

#[test]
fn gauss_2() {
    check(&pendulum(), |h| Evi::new(Quadrature::<2>::gauss(), h), 2.0);
}

#[test]
fn gauss_3() {
    check(&pendulum(), |h| Evi::new(Quadrature::<3>::gauss(), h), 2.0);
}

#[test]
fn lobatto_2() {
    check(&pendulum(), |h| Evi::new(Quadrature::<2>::lobatto(), h), 2.0);
}

#[test]
fn lobatto_4() {
    check(&pendulum(), |h| Evi::new(Quadrature::<4>::lobatto(), h), 2.0);
}

#[test]
fn uniform_4() {
    check(&pendulum(), |h| Evi::new(Quadrature::<4>::uniform(), h), 2.0);
}

#[test]
fn asymmetric_nodes_that_integrate_linear_functions() {
    check(&pendulum(), |h| on_nodes([0.0, 0.3, 1.0], h), 2.0);
}

#[test]
fn the_left_rectangle_has_order_1() {
    check(&pendulum(), |h| on_nodes([0.0], h), 1.0);
}

#[test]
fn any_single_node_off_the_middle_has_order_1() {
    let motion = Motion { steps: [400, 800, 1600, 3200, 6400], ..pendulum() };
    check(&motion, |h| on_nodes([0.8], h).frequency(3.13), 1.0);
}

#[test]
fn rattle() {
    check(&pendulum(), Rattle::new, 2.0);
}

#[test]
fn rk4() {
    check_state(&pendulum(), Rk4::new, 4.0);
}
