//! The motion is that of the scene without the constraints that follow.

use super::*;

/// 0.1 rad from hanging, where the motion is regular.
const MILD: [f64; 4] = [0.28, -0.96, 0.504, -1.728];

/// Round-off of 1,000 steps, which takes another way through another elimination: 4e-15 measured.
const SAME: f64 = 1e-13;

#[test]
fn of_a_double_pendulum_held_twice_is_that_of_one_held_once() {
    for unit in [1.0, 1e6] {
        let twice =
            Simulation::new(HeldTwice { unit, ..TWICE }, Evi::midpoint(0.01)).constraints_of_rank::<2>();
        assert!(difference(twice, Simulation::new(ONCE, Evi::midpoint(0.01)), MILD, 1_000) <= SAME);
    }
}

#[test]
fn on_other_nodes_and_curves_composed_and_back_in_time() {
    let twice = |scheme| Simulation::new(TWICE, scheme).constraints_of_rank::<2>();
    let simpson = Evi::simpson(0.01).frequency(3.13);
    assert!(difference(twice(simpson), Simulation::new(ONCE, simpson), MILD, 1_000) <= SAME);
    let order_4 = Evi::midpoint(-0.02).composed(Composition::suzuki_4());
    let twice = Simulation::new(TWICE, order_4).constraints_of_rank::<2>();
    assert!(difference(twice, Simulation::new(ONCE, order_4), MILD, 200) <= SAME);
}

#[test]
fn of_a_platform_on_three_cranks_is_that_on_two() {
    let three = Simulation::new(OVERCONSTRAINED, Evi::midpoint(0.01)).constraints_of_rank::<3>();
    let two = Simulation::new(TWO_CRANKS, Evi::midpoint(0.01));
    assert!(difference(three, two, CRANKED, 1_000) <= SAME);
}

#[test]
fn of_independent_constraints_is_what_it_was() {
    let stated = Simulation::new(ONCE, Evi::midpoint(0.01)).constraints_of_rank::<2>();
    assert!(difference(stated, Simulation::new(ONCE, Evi::midpoint(0.01)), MILD, 1_000) <= SAME);
}

/// Index-1 methods know the constraint forces alone.
#[test]
fn by_other_methods() {
    let twice = Simulation::new(TWICE, Rk4::new(0.01)).constraints_of_rank::<2>();
    assert!(difference(twice, Simulation::new(ONCE, Rk4::new(0.01)), MILD, 200) <= SAME);
    let twice = Simulation::new(TWICE, ImplicitMidpoint::new(0.01)).constraints_of_rank::<2>();
    assert!(difference(twice, Simulation::new(ONCE, ImplicitMidpoint::new(0.01)), MILD, 200) <= SAME);
}

#[test]
fn keeps_every_constraint() {
    let simulation = Simulation::new(OVERCONSTRAINED, Evi::midpoint(0.01)).constraints_of_rank::<3>();
    let mut run = start(&simulation, CRANKED).unwrap();
    let (mut positions, mut velocities) = (0.0_f64, 0.0_f64);
    for _ in 0..1_000 {
        let state = run.advance().expect("solvable").clone();
        let residuals = run.mechanics().constraint_residual(&state);
        positions = residuals.iter().fold(positions, |x, y| x.max(y.abs()));
        let residuals = run.mechanics().hidden_constraint_residual(&state);
        velocities = residuals.iter().fold(velocities, |x, y| x.max(y.abs()));
    }
    println!("constraints {positions:.1e}, hidden constraints {velocities:.1e}");
    // A few roundings of squares of size 4; the third crank's follow from three others.
    assert!(positions <= 1e-14 && velocities <= 1e-13, "{positions:e} {velocities:e}");
}
