//! What observers see, where they stop a run, and the drift of the energy while it runs.

use std::convert::Infallible;
use std::ops::ControlFlow;

use evi_core::baseline::Rk4;
use evi_core::prelude::*;
use evi_core::report::Drift;
use evi_core::watch::{Either, Ended, EnergyDrift, Limits, Stopped, every};
use evi_examples::Pendulum;

const PENDULUM: Pendulum = Pendulum { m: 1.3, l: 0.7, g: 9.81 };

fn started<F: Scheme<Pendulum>>(scheme: F) -> Run<Pendulum, F::Step> {
    Simulation::new(PENDULUM, scheme).start([1.0], [0.3]).expect("no constraints")
}

#[test]
fn an_observer_sees_every_step_and_changes_none() {
    let mut alone = started(Evi::midpoint(0.01));
    alone.advance_to(1.0).unwrap();
    let mut seen = Vec::new();
    let mut watched = started(Evi::midpoint(0.01));
    let mut see = |run: &Run<Pendulum, _>| -> ControlFlow<Infallible> {
        seen.push((run.steps(), run.state().t()));
        ControlFlow::Continue(())
    };
    watched.advance_observed(1.0, &mut see).unwrap();
    assert_eq!(watched.checkpoint(), alone.checkpoint());
    assert_eq!(seen.iter().map(|(steps, _)| *steps).collect::<Vec<_>>(), (1..=100).collect::<Vec<_>>());
    assert_eq!(seen.last().unwrap().1.to_bits(), watched.state().t().to_bits());
}

#[test]
fn a_run_that_was_stopped_goes_on_from_the_state_that_was_seen() {
    let mut run = started(Evi::midpoint(0.01));
    // Stops at a turning point, and tells where.
    let mut turning = |run: &Run<Pendulum, _>| {
        let [v] = *run.state().v();
        if v < 0.0 { ControlFlow::Break(run.state().q()[0]) } else { ControlFlow::Continue(()) }
    };
    let Err(Ended::Stopped(angle)) = run.advance_observed(10.0, &mut turning) else { panic!("it turns") };
    assert!(angle > 1.0 && angle == run.state().q()[0] && run.state().t() < 1.0);
    let steps = run.steps();
    run.advance_to(10.0).unwrap();
    assert_eq!(run.steps(), 1000);
    let mut alone = started(Evi::midpoint(0.01));
    alone.advance_to(10.0).unwrap();
    assert!(steps < 100 && alone.checkpoint() == run.checkpoint());
}

#[test]
fn the_second_of_a_pair_sees_what_the_first_lets_pass() {
    let mut seen = 0;
    let count = |_: &Run<Pendulum, _>| -> ControlFlow<&'static str> {
        seen += 1;
        if seen == 7 { ControlFlow::Break("seven") } else { ControlFlow::Continue(()) }
    };
    let mut run = started(Evi::midpoint(0.01));
    let mut pair = (Limits::of(&run).steps(50), every(5, count));
    let ended = run.advance_observed(10.0, &mut pair).unwrap_err();
    assert_eq!(ended, Ended::Stopped(Either::Second("seven")));
    assert_eq!((run.steps(), ended.to_string().as_str()), (35, "stopped: seven"));
    let ended = run.advance_observed(10.0, &mut pair).unwrap_err();
    assert_eq!(ended, Ended::Stopped(Either::First(Stopped::Steps { steps: 50 })));
    // 40 and 45, but not 50.
    assert_eq!(seen, 9);
}

#[test]
fn a_step_that_fails_ends_the_run_as_it_does_unwatched() {
    let mut run = started(Evi::midpoint(0.01));
    let ended =
        run.advance_observed(-1.0, &mut every(1, Limits::of(&started(Evi::midpoint(0.01))))).unwrap_err();
    let error = run.advance_to(-1.0).unwrap_err();
    assert_eq!((ended, run.steps()), (Ended::Failed(error), 0));
    assert_eq!(ended.to_string(), error.to_string());
}

/// The drift over 40,000 steps, while they are taken and afterwards.
fn drifts<F: Scheme<Pendulum>>(scheme: F) -> [Drift; 2] {
    let mut run = started(scheme);
    let (start, mut changes) = (run.energy(), Vec::new());
    let keep = |run: &Run<Pendulum, F::Step>| -> ControlFlow<Infallible> {
        changes.push(run.energy() - start);
        ControlFlow::Continue(())
    };
    let mut watch = (EnergyDrift::of(&run), keep);
    run.advance_observed(2_000.0, &mut watch).unwrap();
    let meanwhile = watch.0.drift().unwrap();
    // In blocks of 512 steps: with 256 there would be more than 128 of them.
    let blocks = changes.len() / 512;
    [meanwhile, Drift::of(&changes[..512 * blocks], blocks).unwrap()]
}

#[test]
fn the_drift_of_the_energy_is_known_while_a_run_takes_its_steps() {
    let [variational, afterwards] = drifts(Evi::midpoint(0.05));
    println!("midpoint: {:+.1e} ± {:.1e} J per step", variational.slope, variational.half_width);
    assert!(variational.is_indistinguishable_from_zero());
    assert!((variational.slope - afterwards.slope).abs() <= 1e-9 * afterwards.half_width);
    let [rk4, afterwards] = drifts(Rk4::new(0.05));
    println!("RK4: {:+.1e} ± {:.1e} J per step", rk4.slope, rk4.half_width);
    assert!(!rk4.is_indistinguishable_from_zero() && rk4.slope < 0.0);
    assert!((rk4.slope - afterwards.slope).abs() <= 1e-9 * afterwards.slope.abs());
}
