//! Constraints at a small angle.

use super::*;

fn wedge(angle: f64) -> Simulation<Wedge, Evi<1>> {
    Simulation::new(Wedge { m: 2.0, g: G, angle }, Evi::midpoint(0.01))
}

#[test]
fn constraints_are_refused_or_solved_without_squaring_their_angle() {
    let angle = 1e-8_f64;
    let rank = Mechanics::new(&Wedge { m: 2.0, g: G, angle }).constraint_rank(0.0, &[0.0; 3]);
    println!("{rank}");
    assert_eq!(rank.rank(), 2);
    let error = wedge(angle).start([0.0, 0.0, 0.3], [0.0; 3]).err().expect("squares are round-off");
    println!("{error}");
    let StartError::NearlyDependentConstraints { constraint, rank: 2, smallest } = error else {
        panic!("{error:?}");
    };
    assert_eq!(constraint, ConstraintLabel::Name("tilted"));
    assert!((smallest / (0.5 * angle) - 1.0).abs() < 1e-6, "{smallest:e}");

    let mut run = wedge(angle).constraints_of_rank::<2>().start([0.0, 0.0, 0.3], [0.0; 3]).unwrap();
    run.advance_to(1.0).expect("solvable");
    let mut right = wedge(0.5 * std::f64::consts::PI).start([0.0, 0.0, 0.3], [0.0; 3]).unwrap();
    right.advance_to(1.0).unwrap();
    let ([x, y, z], expected) = (*run.state().q(), right.state().q()[2]);
    println!("x = {x:e}, y = {y:e}, z off by {:e}", z - expected);
    // Along the planes nothing is lost, across them what round-off over the angle leaves.
    assert!((z - expected).abs() < 1e-14 && x.abs() < 1e-15 && y.abs() < 1e-8);
    let state = run.state().clone();
    let [plane, tilted] = run.mechanics().acceleration(state.t(), state.q(), state.v()).unwrap().multipliers;
    // m g (1, 1) + (plane + cos tilted, sin tilted) = 0.
    let force = 2.0 * G;
    println!("{plane:e} {tilted:e}");
    assert!((tilted * angle.sin() / force + 1.0).abs() < 1e-7 && (plane / tilted + 1.0).abs() < 1e-7);
}

#[test]
fn an_angle_within_the_tolerance_of_a_start_is_none() {
    let rank = Mechanics::new(&Wedge { m: 2.0, g: G, angle: 1e-12 }).constraint_rank(0.0, &[0.0; 3]);
    assert_eq!(rank.rank(), 1);
    let error = wedge(1e-12).start([0.0; 3], [0.0; 3]).err().unwrap();
    assert!(matches!(error, StartError::DependentConstraints { rank: 1, .. }), "{error:?}");
}
