//! Steps without solution, taken in parts where that is asked for.

use evi_core::baseline::Rattle;
use evi_core::integrator::Statistics;
use evi_core::prelude::*;
use evi_examples::{DoublePendulum, GRAVITY, HarmonicOscillator};

const DOUBLE: DoublePendulum = DoublePendulum::UNIT;

/// A run of the double pendulum from the horizontal.
fn run<F: Scheme<DoublePendulum>>(scheme: F) -> Run<DoublePendulum, F::Step> {
    let horizontal = DOUBLE.horizontal();
    Simulation::new(DOUBLE, scheme).start(horizontal.q, horizontal.v).expect("consistent")
}

/// Ten seconds of steps that fail unless they are rescued: how many were, and the largest energy error.
#[track_caller]
fn check<F, const K: usize>(scheme: F, fails_at: u64)
where
    F: Symmetric + Scheme<DoublePendulum>,
    evi_core::integrator::Rescued<F, K>:
        Scheme<DoublePendulum, Step = evi_core::integrator::RescuedStep<F::Step, K>>,
{
    let target = 100.0 * scheme.step_size();
    let mut plain = run(scheme.clone());
    assert!(matches!(plain.advance_to(target), Err(StepError::NoSolution { .. })));
    assert_eq!(plain.steps() + 1, fails_at);

    let mut rescued = run(scheme.rescued::<K>()).with_tally(Statistics::default());
    let energy = rescued.energy();
    for step in 1..=100 {
        let before = rescued.map().rescues().steps;
        rescued.advance().expect("rescued");
        // The grid of times stays.
        assert_eq!(rescued.state().t(), f64::from(step) * rescued.map().h());
        let residuals = rescued.mechanics().constraint_residual(rescued.state());
        assert!(residuals.iter().all(|residual| residual.abs() < 1e-14), "{residuals:?}");
        if step < fails_at as i32 {
            assert_eq!(rescued.map().rescues().steps, 0);
        } else if step == fails_at as i32 {
            // Up to there the same bits.
            assert_eq!(rescued.map().rescues().steps, before + 1);
        }
    }
    let rescues = rescued.map().rescues();
    println!("{rescues:?}, energy off by {:.2e}", rescued.energy() - energy);
    assert_eq!(rescued.tally().rescued_steps, rescues.steps);
    assert!(rescues.steps > 0 && rescues.parts >= 2 * rescues.steps);
    assert!(rescued.energy().is_finite());
}

#[test]
fn steps_of_every_sign_and_kind_are_taken_in_parts_and_counted() {
    check::<_, 6>(Evi::midpoint(0.1).frequency(GRAVITY.sqrt()), 66);
    check::<_, 6>(Evi::midpoint(-0.1).frequency(GRAVITY.sqrt()), 66);
    check::<_, 6>(Evi::simpson(0.1).frequency(GRAVITY.sqrt()), 22);
    check::<_, 8>(Rattle::new(0.3), 3);
}

/// The parts are steps of the same scheme from the state before.
#[test]
fn a_rescued_step_is_two_steps_of_half_the_size() {
    let scheme = Evi::midpoint(0.1).frequency(GRAVITY.sqrt());
    let mut rescued = run(scheme.rescued::<6>());
    while rescued.map().rescues().steps == 0 {
        rescued.advance().expect("rescued");
    }
    let mut whole = run(scheme);
    let error = whole.advance_to(10.0).map(drop).expect_err("no solution");
    assert!(matches!(error, StepError::NoSolution { .. }));
    let parts = rescued.map().rescues().parts;
    let (t, q, v) = (whole.state().t(), *whole.state().q(), *whole.state().v());
    let part = Simulation::new(DOUBLE, scheme.with_step_size(0.1 / parts as f64));
    let mut by_hand = part.start_at(t, q, v).expect("consistent");
    for _ in 0..parts {
        by_hand.advance().expect("solvable");
    }
    for (x, y) in rescued.state().q().iter().zip(by_hand.state().q()) {
        // The start projects once more.
        assert!((x - y).abs() < 1e-13, "{x} {y}");
    }
}

/// `(m + h² k / 4) = 0` at this step, and at half of it with another stiffness: nothing helps where every part is singular.
#[test]
fn where_no_part_helps_the_error_is_that_of_the_whole_step_and_the_state_stands() {
    let inverted = HarmonicOscillator { m: 1.0, k: -16.0 };
    let mut run = Simulation::new(inverted, Evi::midpoint(0.5).rescued::<1>()).start([1.0], [0.0]).unwrap();
    run.advance().expect("halves are regular");
    assert_eq!(run.map().rescues().steps, 1);

    let scheme = Evi::simpson(0.5).frequency(GRAVITY.sqrt());
    let mut plain = self::run(scheme);
    let error = plain.advance_to(50.0).map(drop).expect_err("far too large");
    let mut rescued = self::run(scheme.rescued::<1>());
    let last = loop {
        let before = rescued.state().clone();
        if let Err(last) = rescued.advance() {
            assert_eq!(rescued.state(), &before);
            break last;
        }
        assert!(rescued.steps() < 100, "two parts are always enough");
    };
    println!("{error}\n{last}\n{:?}", rescued.map().rescues());
    assert!(matches!(last, StepError::NoSolution { t, .. } if t == rescued.state().t()));
    let again = rescued.advance().map(drop).expect_err("the same again");
    assert_eq!(again, last);
    assert_eq!(rescued.tally().fallbacks, 0);
}

#[test]
fn with_compensated_summation_and_compositions() {
    let compensated = Evi::midpoint(0.1).frequency(GRAVITY.sqrt()).rescued::<6>().compensated();
    let mut run_compensated = run(compensated).with_tally(Statistics::default());
    run_compensated.advance_to(10.0).expect("rescued");
    assert!(run_compensated.tally().rescued_steps > 0);
    let composed = Evi::midpoint(0.3).composed(Composition::suzuki_4()).rescued::<6>();
    let mut run_composed = run(composed).with_tally(Statistics::default());
    run_composed.advance_to(10.0).expect("rescued");
    println!("{:?}", run_composed.tally());
}
