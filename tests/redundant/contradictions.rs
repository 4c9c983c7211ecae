//! Constraints that contradict each other.

use super::*;

#[test]
fn of_lengths_are_refused_with_the_residual() {
    let twice = HeldTwice { again: 1.1, ..TWICE };
    let simulation = Simulation::new(twice, Evi::midpoint(0.01)).constraints_of_rank::<2>();
    for error in [
        start(&simulation, BENT).err().unwrap(),
        simulation.start_projected(0.0, BENT, [0.0; 4]).err().unwrap(),
    ] {
        let StartError::ContradictoryConstraints { constraint, residual, allowed } = error else {
            panic!("{error:?}");
        };
        println!("{error}");
        assert_eq!(constraint, ConstraintLabel::Name("again1"));
        assert!((residual + 0.21).abs() < 1e-14 && allowed < 1e-11, "{error}");
    }
    // Beside agreeing constraints, a start is beside the constraints and nothing else.
    let agreeing = Simulation::new(TWICE, Evi::midpoint(0.01)).constraints_of_rank::<2>();
    let error = start(&agreeing, [0.6, -0.8, 1.08, -1.45]).err().unwrap();
    assert!(matches!(error, StartError::InconsistentPosition { .. }), "{error:?}");
    assert!(agreeing.start_projected(0.0, [0.6, -0.8, 1.08, -1.45], [0.0; 4]).is_ok());
}

#[test]
fn that_begin_at_the_start_are_refused_by_its_velocity() {
    let growing = HeldTwice { growth: 0.1, again: 0.9, ..TWICE };
    let simulation = Simulation::new(growing, Evi::midpoint(0.01)).constraints_of_rank::<2>();
    let error = simulation.start_at(1.0, BENT, [0.0; 4]).err().unwrap();
    assert!(matches!(error, StartError::InconsistentVelocity { .. }), "{error:?}");
}

#[test]
fn on_the_way_end_the_run_where_it_stands() {
    // Of position and velocity at the start nothing tells.
    let growing = HeldTwice { growth: 1e-10, ..TWICE };
    let simulation = Simulation::new(growing, Evi::midpoint(0.01)).constraints_of_rank::<2>();
    let mut run = start(&simulation, BENT).expect("consistent within its digits");
    let error = loop {
        let before = run.state().clone();
        match run.advance() {
            Ok(_) => assert!(run.state().t() < 1.0, "no contradiction found"),
            Err(error) => {
                assert_eq!(run.state(), &before);
                break error;
            }
        }
    };
    println!("{error}");
    let StepError::ContradictoryConstraints { constraint, residual, allowed, .. } = error else {
        panic!("{error:?}");
    };
    assert_eq!(constraint, ConstraintLabel::Name("again1"));
    assert!(residual.abs() > allowed && allowed > 0.0 && run.steps() > 1);
}
