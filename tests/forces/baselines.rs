//! RATTLE with forces.

use evi_core::baseline::Rattle;
use evi_core::prelude::*;
use evi_examples::{DrivenPendulum, Start};
use evi_tests::largest_difference;

/// A pendulum pushed by a force of place and time.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = m * g * y,
    constraint(rod: x.powi(2) + y.powi(2) == l.powi(2)),
    input(push),
    force(x: push * (3.0 * t).cos() * y),
    force(y: 0.5 * push * x),
)]
struct PushedPendulum {
    m: f64,
    g: f64,
    l: f64,
}

/// RATTLE with forces is the member on the trapezoid rule, step by step.
#[test]
fn rattle_is_the_trapezoid_member() {
    let system = PushedPendulum { m: 0.8, g: 9.81, l: 1.2 };
    let (q, v) = ([1.2, 0.0], [0.0, 0.5]);
    let mut rattle = Simulation::new(system, Rattle::new(0.01)).start(q, v).expect("a start");
    let member = Evi::new(Quadrature::<2>::lobatto(), 0.01);
    let mut member = Simulation::new(system, member).start(q, v).expect("a start");
    for step in 0..100 {
        let push = [0.02 * f64::from(step)];
        rattle.set_inputs(push);
        member.set_inputs(push);
        let (a, b) = (rattle.advance().expect("a step"), member.advance().expect("a step"));
        let difference = largest_difference(a.q(), b.q()).max(largest_difference(a.v(), b.v()));
        println!("{difference:e}");
        // Roundings of 100 steps, grown by the motion: 3.6e-15 measured.
        assert!(difference <= 1e-14, "{difference:e}");
    }
}

#[test]
fn rattle_refuses_forces_that_depend_on_velocities() {
    let system = DrivenPendulum::STANDARD;
    let Start { q, v } = system.horizontal();
    let error = Simulation::new(system, Rattle::new(0.01)).start(q, v).map(|_| ()).expect_err("drag");
    assert_eq!(error.to_string(), "RATTLE needs forces that do not depend on velocities");
}
