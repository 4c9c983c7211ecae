//! Starts that are refused by name, and steps that fail where they stand.

use evi_core::assembled::{AssembledSimulation, AssemblyError};
use evi_core::integrator::Statistics;
use evi_core::prelude::*;

use evi_tests::trusses::{Placed, Truss, chain, ring};

/// What is said of a start, which is refused.
#[track_caller]
fn refused(truss: Truss, q: Vec<f64>, v: Vec<f64>) -> AssemblyError {
    let simulation = AssembledSimulation::new(truss, Evi::midpoint(0.01));
    let error = simulation.start(q, v).err().expect("refused");
    println!("{error}");
    error
}

#[test]
fn elements_that_do_not_fit_are_refused() {
    let changed = |change: fn(&mut Truss)| {
        let Placed { mut truss, q } = chain(3);
        change(&mut truss);
        let n = q.len();
        refused(truss, q, vec![0.0; n])
    };
    let error = changed(|truss| truss.rods[1].0 = [1, 7]);
    assert_eq!(
        error,
        AssemblyError::Place { family: 2, element: 1, coordinate: 2, place: 14, n_coordinates: 6 }
    );
    let error = changed(|truss| truss.rods[1].0 = [2, 2]);
    assert_eq!(error, AssemblyError::RepeatedPlace { family: 2, element: 1, name: "p[2, 0]".into() });
    let error = changed(|truss| truss.masses[1] = f64::NAN);
    assert!(matches!(error, AssemblyError::Parameter { family: 0, element: 1, name: "m", .. }));
}

#[test]
fn starts_that_are_none_are_refused_by_name() {
    let Placed { truss, q } = chain(3);
    let rest = vec![0.0; 6];
    let with = |index: usize, value: f64, of: &[f64]| {
        let mut of = of.to_vec();
        of[index] = value;
        of
    };
    let error = refused(truss.clone(), vec![0.0; 4], rest.clone());
    assert_eq!(error, AssemblyError::Length { quantity: "position", expected: 6, found: 4 });
    let error = refused(truss.clone(), q.clone(), with(3, f64::NAN, &rest));
    assert!(
        matches!(error, AssemblyError::NotFinite { quantity: "velocity", name, .. } if name == "p[1, 1]")
    );
    let error = refused(truss.clone(), with(5, 0.1, &q), rest.clone());
    assert!(
        matches!(error, AssemblyError::InconsistentPosition { constraint, .. } if constraint == "rod[1]")
    );
    let error = refused(truss.clone(), q.clone(), with(0, 0.1, &rest));
    assert!(
        matches!(error, AssemblyError::InconsistentVelocity { constraint, .. } if constraint == "hanger[0]")
    );
    let curved = AssembledSimulation::new(truss.clone(), Evi::midpoint(0.01).scene_frequencies());
    assert_eq!(curved.start(q.clone(), rest.clone()).err(), Some(AssemblyError::NoFrequencies));
    let mut twice = truss;
    twice.rods.push(twice.rods[1]);
    let error = refused(twice, q, rest);
    let AssemblyError::DependentConstraint { constraint, pivot_ratio } = error else { panic!("{error}") };
    assert!(["rod[1]", "rod[2]"].contains(&&*constraint) && pivot_ratio < 1e-12);
}

#[test]
fn a_step_without_solution_leaves_the_run_where_it_stands() {
    for composed in [false, true] {
        let Placed { truss, q } = ring(6);
        let n = q.len();
        // A step in which every rod would have to turn by many times its length.
        let (fall, order_4) = (Evi::midpoint(40.0), Evi::midpoint(40.0).composed(Composition::suzuki_4()));
        if composed {
            let mut run = AssembledSimulation::new(truss, order_4).start(q, vec![0.0; n]).expect("a start");
            let before = run.state().clone();
            let error = run.advance().expect_err("no solution");
            assert!(matches!(error, StepError::NoSolution { .. } | StepError::Singular { .. }), "{error}");
            assert_eq!((run.state(), run.steps()), (&before, 0));
        } else {
            let mut run = AssembledSimulation::new(truss, fall).start(q, vec![0.0; n]).expect("a start");
            let before = run.state().clone();
            let error = run.advance().expect_err("no solution");
            assert!(matches!(error, StepError::NoSolution { .. } | StepError::Singular { .. }), "{error}");
            assert_eq!((run.state(), run.steps()), (&before, 0));
        }
    }
}

#[test]
fn nets_that_fill_in_too_much_are_refused_with_the_feature_that_takes_them() {
    let n = 120;
    let every_pair = (0..n).flat_map(|a| (0..a).map(move |b| ([b, a], 1.0))).collect();
    let truss = Truss { masses: vec![1.0; n], rods: every_pair, ..Truss::default() };
    let error = refused(truss, vec![0.0; 2 * n], vec![0.0; 2 * n]);
    assert!(matches!(error, AssemblyError::TooMuchFill { unknowns: 7380, .. }), "{error}");
    assert!(error.to_string().contains("feature `sparse`"), "{error}");
}

#[test]
fn steps_that_fail_are_taken_in_parts_where_that_is_asked_for() {
    // Links whip around faster than steps of this size resolve.
    let Placed { truss, q } = chain(10);
    let rest = vec![0.0; q.len()];
    let plain = AssembledSimulation::new(truss.clone(), Evi::midpoint(0.02));
    let error = plain.start(q.clone(), rest.clone()).expect("a start").advance_to(4.0).err();
    assert!(matches!(error, Some(StepError::NoSolution { .. } | StepError::Singular { .. })), "{error:?}");
    let rescued = AssembledSimulation::new(truss, Evi::midpoint(0.02).rescued::<6>());
    let mut run = rescued.start(q, rest).expect("a start").with_tally(Statistics::default());
    run.advance_to(4.0).expect("every step");
    let rescues = run.map().rescues();
    println!("{rescues:?}, of {} steps", run.steps());
    assert_eq!(run.steps(), 200);
    assert!(rescues.steps > 0 && rescues.parts >= 2 * rescues.steps);
    assert_eq!(run.tally().rescued_steps, rescues.steps);
    assert!(run.constraint_error() < 1e-15 && (run.state().t() - 4.0).abs() < 1e-12);
}
