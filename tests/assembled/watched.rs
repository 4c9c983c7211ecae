//! Long runs: checkpoints that go on to the last bit, budgets, observers.

use std::convert::Infallible;
use std::ops::ControlFlow;

use evi_core::assembled::{
    AssembledRun, AssembledScheme, AssembledSimulation, AssembledSystem, AssemblyError,
};
use evi_core::integrator::{ResumeError, Statistics};
use evi_core::prelude::*;
use evi_core::watch::{Ended, EnergyDrift, Limits, Stopped, every};
use evi_examples::CarAxis;
use evi_tests::trusses::{Placed, chain, net};

use crate::agreement::Twice;
use crate::galerkin::Looped;

/// A run that was resumed takes the steps of the one that goes on, to the last bit; one that only starts from the state there does not.
#[track_caller]
fn check<S, F>(system: S, (q, v): (&[f64], &[f64]), scheme: F)
where
    S: AssembledSystem + Clone,
    F: AssembledScheme,
{
    let simulation = AssembledSimulation::new(system, scheme);
    let mut run = simulation.start_at(0.25, q, v).expect("a start").with_tally(Statistics::default());
    let advance = |run: &mut AssembledRun<S, F::Step, Statistics>| {
        for _ in 0..9 {
            run.advance().expect("a step");
        }
    };
    advance(&mut run);
    let checkpoint = run.checkpoint();
    assert_eq!((checkpoint.t(), checkpoint.steps()), (run.state().t(), 9));
    let mut resumed = simulation.resume_with(&checkpoint, Statistics::default()).expect("its own checkpoint");
    assert_eq!(resumed.checkpoint(), checkpoint, "not all of it was resumed");
    let forgetful = simulation.start_at(run.state().t(), run.state().q(), run.state().v()).expect("a start");
    let mut forgetful = forgetful.with_tally(*run.tally());
    advance(&mut run);
    advance(&mut resumed);
    advance(&mut forgetful);
    // State, memory and tally, all bits of them.
    assert_eq!(resumed.checkpoint(), run.checkpoint());
    let is_same = forgetful.state() == run.state() && forgetful.tally() == run.tally();
    assert!(!is_same, "there is nothing to remember");
}

#[test]
fn runs_that_are_resumed_go_on_to_the_last_bit() {
    let at_rest = |Placed { truss, q }: Placed| (truss, vec![0.0; q.len()], q);
    let (truss, rest, q) = at_rest(chain(8));
    check(truss.clone(), (&q, &rest), Evi::midpoint(0.002));
    check(truss.clone(), (&q, &rest), Evi::midpoint(0.01).composed(Composition::suzuki_4()));
    check(truss.clone(), (&q, &rest), Evi::midpoint(0.01).rescued::<3>());
    check(truss, (&q, &rest), Galerkin::<8>::new(0.02));
    let (truss, rest, q) = at_rest(chain(500));
    check(truss, (&q, &rest), Galerkin::<4>::new(0.002));
    let (truss, rest, q) = at_rest(net(3));
    check(truss.clone(), (&q, &rest), Evi::midpoint(0.01));
    check(truss, (&q, &rest), Evi::trapezoid(0.01));
    let (q, v) = Looped::start();
    check(Looped::UNEQUAL, (&q, &v), Galerkin::<3>::new(0.01));
    // Constraints that move: the time of a stage is rounded otherwise than that of the step before it.
    let start = CarAxis::STANDARD.standard_start();
    let doubled = |x: &[f64]| x.iter().flat_map(|x| [*x; 2]).collect::<Vec<_>>();
    let (q, v) = (doubled(&start.q), doubled(&start.v));
    let simulation = AssembledSimulation::new(Twice(CarAxis::STANDARD), Evi::simpson(0.01));
    let mut run = simulation.start(q, v).expect("a start");
    run.advance_to(0.25).expect("every step");
    let state = run.state();
    check(
        Twice(CarAxis::STANDARD),
        (state.q(), state.v()),
        Evi::simpson(0.01).composed(Composition::suzuki_4()),
    );
}

#[test]
fn checkpoints_of_other_runs_are_refused() {
    let Placed { truss, q } = chain(8);
    let rest = vec![0.0; q.len()];
    let simulation = AssembledSimulation::new(truss.clone(), Evi::midpoint(0.01));
    let checkpoint = simulation.start(q, rest).expect("a start").checkpoint();
    let refused = |error: Option<AssemblyError>| match error {
        Some(AssemblyError::Checkpoint(error)) => {
            println!("{error}");
            error
        }
        other => panic!("{other:?}"),
    };
    let shorter = AssembledSimulation::new(truss.clone(), Evi::midpoint(0.005));
    assert!(matches!(refused(shorter.resume(&checkpoint).err()), ResumeError::StepSize { .. }));
    let mut heavier = truss.clone();
    heavier.masses[3] *= 2.0;
    let heavier = AssembledSimulation::new(heavier, Evi::midpoint(0.01));
    let error = refused(heavier.resume(&checkpoint).err());
    assert!(matches!(error, ResumeError::OtherParameters { checkpoint: 0.125, simulation: 0.25 }));
    let longer = AssembledSimulation::new(chain(9).truss, Evi::midpoint(0.01));
    assert!(matches!(refused(longer.resume(&checkpoint).err()), ResumeError::OtherEquations { .. }));
    let simpson = AssembledSimulation::new(truss, Evi::simpson(0.01));
    assert!(matches!(refused(simpson.resume(&checkpoint).err()), ResumeError::OtherScheme));
}

#[test]
fn budgets_stop_a_run_where_it_leaves_them() {
    let Placed { truss, q } = chain(8);
    let rest = vec![0.0; q.len()];
    let simulation = AssembledSimulation::new(truss, Evi::midpoint(0.01));
    let start = || simulation.start(q.clone(), rest.clone()).expect("a start");
    let mut run = start();
    let mut limits = Limits::of(&run).energy_change(1e-4);
    let Err(Ended::Stopped(stopped)) = run.advance_observed(3.0, &mut limits) else { panic!("stopped") };
    println!("{stopped}");
    assert!(
        matches!(stopped, Stopped::Energy { t, change, budget: 1e-4 } if change.abs() > 1e-4 && t == run.state().t())
    );

    let mut run = start();
    let mut limits = Limits::of(&run).constraint(0.0);
    let Err(Ended::Stopped(stopped)) = run.advance_observed(1.0, &mut limits) else { panic!("stopped") };
    println!("{stopped}");
    let Stopped::Constraint { constraint, residual, .. } = stopped else { panic!("{stopped}") };
    assert!(constraint.starts_with("rod[") || constraint.starts_with("hanger["), "{constraint}");
    assert!(residual != 0.0 && residual.abs() < 1e-15);

    // An observer that only looks, of every third step, and one that measures the drift.
    let mut run = start();
    let mut times = Vec::new();
    let look = every(3, |run: &AssembledRun<_, _, _>| -> ControlFlow<Infallible> {
        times.push(run.state().t());
        ControlFlow::Continue(())
    });
    let drift = EnergyDrift::of(&run);
    let mut observers = (look, drift);
    assert_eq!(run.steps_to(0.1), Ok(10));
    run.advance_observed(0.1, &mut observers).expect("nothing stops it");
    let (_, drift) = observers;
    assert!(drift.largest_change() > 0.0 && drift.largest_change() < 1e-3);
    assert_eq!(times.len(), 3);
}
