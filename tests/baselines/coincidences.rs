//! Methods that are the same map, written in different ways.

use super::*;

#[test]
fn shake_has_the_positions_of_rattle_and_velocities_beside_the_constraints() {
    let (system, start) = swing();
    check_same(system, (Shake::new(0.01), Rattle::new(0.01)), start, 256.0, f64::INFINITY);
    // ½(v₋ + v₊) differs from the projected velocity by a multiple of M⁻¹Gᵀ alone, of second order.
    let differences = [0.02, 0.01, 0.005, 0.0025].map(|h| {
        let mut shake = Simulation::new(system, Shake::new(h)).start(start.q, start.v).unwrap();
        let mut rattle = Simulation::new(system, Rattle::new(h)).start(start.q, start.v).unwrap();
        shake.advance_to(0.4).unwrap();
        rattle.advance_to(0.4).unwrap();
        let hidden = shake.mechanics().hidden_constraint_residual(shake.state());
        assert!(hidden.iter().any(|residual| *residual > 1e-7), "{hidden:?}");
        largest_difference(shake.state().v(), rattle.state().v())
    });
    let order = observed_order(&[0.02, 0.01, 0.005, 0.0025], &differences);
    println!("{order:.3}: {differences:?}");
    assert!((order - 2.0).abs() <= 0.1, "{order}");
}

#[test]
fn shake_from_any_state_starts_afresh() {
    let (system, start) = swing();
    let mut one = Simulation::new(system, Shake::new(0.01)).start(start.q, start.v).unwrap();
    one.advance_to(0.3).unwrap();
    let state = one.state().clone();
    let mut map = Shake::new(0.01).prepare(Mechanics::new(&system)).unwrap();
    let mut restarted = state.clone();
    map.advance(&mut restarted, &mut ()).unwrap();
    one.advance().unwrap();
    // The half kick brings back v₊, but for round-off.
    let difference = largest_difference(one.state().q(), restarted.q()) / f64::EPSILON;
    println!("{difference:.0} ε");
    assert!(difference <= 8.0, "{difference:.0} ε");
}

#[test]
fn implicit_midpoint_is_the_variational_one_where_the_momentum_is_a_constant_mass_times_velocity() {
    let pendulum = Pendulum { m: 1.3, l: 0.9, g: 9.81 };
    let mut midpoint = Simulation::new(pendulum, ImplicitMidpoint::new(0.02)).start([1.0], [0.4]).unwrap();
    let mut variational = Simulation::new(pendulum, Evi::midpoint(0.02)).start([1.0], [0.4]).unwrap();
    let (a, b) = (midpoint.advance_to(2.0).unwrap(), variational.advance_to(2.0).unwrap());
    let difference = largest_difference(a.q(), b.q()).max(largest_difference(a.v(), b.v())) / f64::EPSILON;
    println!("{difference:.0} ε");
    assert!(difference <= 64.0, "{difference:.0} ε");
}

#[test]
fn implicit_midpoint_differs_where_the_mass_depends_on_the_configuration() {
    let Start { q, v } = DoublePendulumInAngles::MODERATE;
    let system = DoublePendulumInAngles::UNEQUAL;
    let mut midpoint = Simulation::new(system, ImplicitMidpoint::new(0.01)).start(q, v).unwrap();
    let mut variational = Simulation::new(system, Evi::midpoint(0.01)).start(q, v).unwrap();
    let (a, b) = (midpoint.advance_to(1.0).unwrap(), variational.advance_to(1.0).unwrap());
    assert!(largest_difference(a.q(), b.q()) > 1e-6);
}

#[test]
fn the_scenes_elimination_solves_what_the_dense_one_solves() {
    let (system, start) = swing();
    let mut own = Simulation::new(system, GeneralizedAlpha::new(0.01)).start(start.q, start.v).unwrap();
    let dense = Simulation::new(Dense(system), GeneralizedAlpha::new(0.01));
    let mut dense = dense.start(start.q, start.v).unwrap();
    let (a, b) = (own.advance_to(1.0).unwrap(), dense.advance_to(1.0).unwrap());
    let difference = largest_difference(a.q(), b.q()) / f64::EPSILON;
    println!("{difference:.0} ε");
    assert!(difference <= 1024.0, "{difference:.0} ε");
}
