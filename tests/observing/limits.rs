//! Every limit, reached.

use std::time::Duration;

use evi_core::baseline::Rk4;
use evi_core::prelude::*;
use evi_core::watch::{Ended, Limits, Stopped};
use evi_examples::DoublePendulum;

const DOUBLE: DoublePendulum = DoublePendulum { m1: 1.3, m2: 0.7, l1: 0.9, l2: 1.1, g: 9.81 };

/// The classical method, whose energy and constraints drift.
fn drifting() -> Run<DoublePendulum, <Rk4 as Scheme<DoublePendulum>>::Step> {
    let start = DOUBLE.horizontal();
    Simulation::new(DOUBLE, Rk4::new(0.02)).start(start.q, start.v).expect("a consistent start")
}

/// Runs into the limits, and returns which; the run stands one step behind the last state within them.
#[track_caller]
fn check(
    limits: impl Fn(Limits) -> Limits,
    measure: impl Fn(&Run<DoublePendulum, <Rk4 as Scheme<DoublePendulum>>::Step>) -> f64,
) -> Stopped {
    let mut run = drifting();
    let mut limits = limits(Limits::of(&run));
    let Err(Ended::Stopped(stopped)) = run.advance_observed(20.0, &mut limits) else {
        panic!("nothing stopped it")
    };
    println!("{stopped}");
    let (beyond, steps) = (measure(&run), run.steps());
    assert!(steps > 1, "the first step was too long");
    let mut again = drifting();
    for _ in 1..steps {
        again.advance().unwrap();
    }
    let within = measure(&again);
    again.advance().unwrap();
    assert_eq!(again.state(), run.state());
    assert!(within < beyond, "{within:e}, then {beyond:e}");
    stopped
}

#[test]
fn energy() {
    let start = drifting().energy();
    let change = |run: &Run<DoublePendulum, _>| (run.energy() - start).abs();
    let stopped = check(|limits| limits.energy_change(1e-4), change);
    assert!(
        matches!(stopped, Stopped::Energy { change, budget: 1e-4, .. } if (1e-4..1e-2).contains(&change.abs()))
    );
    // From the horizontal the energy is that of two bobs at height 0: none.
    assert_eq!(start, 0.0);
    let mut run = drifting();
    run.advance().unwrap();
    let mut limits = Limits::of(&run).relative_energy_change(1e3);
    let budget = 1e3 * run.energy().abs();
    let ended = run.advance_observed(20.0, &mut limits).unwrap_err();
    assert!(
        matches!(ended, Ended::Stopped(Stopped::Energy { budget: b, change, .. }) if b == budget && change.abs() > b)
    );
}

#[test]
fn constraints() {
    let largest = |residuals: [f64; 2]| residuals.iter().fold(0.0, |largest: f64, r| largest.max(r.abs()));
    let stopped = check(
        |limits| limits.constraint(1e-5),
        |run| largest(run.mechanics().constraint_residual(run.state())),
    );
    assert!(
        matches!(stopped, Stopped::Constraint { constraint: "rod1" | "rod2", residual, budget: 1e-5, .. }
        if residual.abs() > 1e-5)
    );
    let stopped = check(
        |limits| limits.hidden_constraint(1e-6),
        |run| largest(run.mechanics().hidden_constraint_residual(run.state())),
    );
    assert!(
        matches!(stopped, Stopped::HiddenConstraint { constraint: "rod1" | "rod2", residual, budget: 1e-6, .. }
        if residual > 1e-6)
    );
    // The variational run never comes near.
    let start = DOUBLE.horizontal();
    let mut run = Simulation::new(DOUBLE, Evi::midpoint(0.02)).start(start.q, start.v).unwrap();
    let mut limits = Limits::of(&run).constraint(1e-14).hidden_constraint(1e-13);
    assert!(run.advance_observed(20.0, &mut limits).is_ok());
}

#[test]
fn steps_and_time() {
    let mut run = drifting();
    run.advance_to(1.0).unwrap();
    let mut limits = Limits::of(&run).steps(10).wall_time(Duration::from_secs(3600));
    let ended = run.advance_observed(20.0, &mut limits).unwrap_err();
    assert_eq!((ended, run.steps()), (Ended::Stopped(Stopped::Steps { steps: 10 }), 60));
    let mut limits = Limits::of(&run).wall_time(Duration::ZERO);
    let ended = run.advance_observed(20.0, &mut limits).unwrap_err();
    assert!(
        matches!(ended, Ended::Stopped(Stopped::WallTime { budget: Duration::ZERO, .. }))
            && run.steps() == 61
    );
}

#[test]
fn a_budget_that_is_no_number_lets_nothing_pass() {
    let mut run = drifting();
    let mut limits = Limits::of(&run).energy_change(f64::NAN);
    assert!(matches!(run.advance_observed(1.0, &mut limits), Err(Ended::Stopped(Stopped::Energy { .. }))));
    assert_eq!(run.steps(), 1);
}

#[test]
fn a_step_without_a_solution_is_no_limit() {
    // At this step size and frequency the step equations lose their solution after some 20 steps.
    let start = DoublePendulum::UNIT.horizontal();
    let scheme = Evi::simpson(0.1).frequency(9.81_f64.sqrt());
    let mut run = Simulation::new(DoublePendulum::UNIT, scheme).start(start.q, start.v).unwrap();
    let mut limits = Limits::of(&run).steps(100);
    let ended = run.advance_observed(10.0, &mut limits).unwrap_err();
    assert!(matches!(ended, Ended::Failed(StepError::NoSolution { .. })), "{ended}");
}
