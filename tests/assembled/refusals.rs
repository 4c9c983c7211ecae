//! Starts that are refused by name, and steps that fail where they stand.

use evi_core::assembled::{AssembledSimulation, AssemblyError};
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
