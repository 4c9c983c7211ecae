//! Steps by passes beside the same steps by Newton's iteration.

use evi_core::integrator::{Iteration, Statistics};
use evi_core::prelude::*;
use evi_examples::Start;

use crate::largest_difference;

/// Takes 40 steps of size `h`, each of them by `passes` and by `newton` from the same state; their largest difference in units of round-off.
///
/// Multipliers are what keeps points on constraints, to round-off of the points: velocities feel it by the `h`-th part.
#[track_caller]
pub fn roundings_between<S, F, const N: usize>(
    system: &S,
    start: Start<N>,
    h: f64,
    [passes, newton]: [F; 2],
    iteration: impl Fn(&F::Step) -> Iteration,
) -> f64
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Clone,
    F: Scheme<S> + Clone,
{
    const STEPS: usize = 40;
    let run =
        Simulation::new(system.clone(), passes).start_projected(0.0, start.q, start.v).expect("a start");
    assert!(matches!(iteration(run.map()), Iteration::Passes(_)), "vacuous: {}", iteration(run.map()));
    let mut run = run.with_tally(Statistics::default());
    let mut roundings = 0.0_f64;
    for _ in 0..STEPS {
        let before = run.state().clone();
        let newton = Simulation::new(system.clone(), newton.clone());
        let mut newton =
            newton.start_projected(before.t(), *before.q(), *before.v()).expect("a state is a start");
        newton.set_inputs(before.inputs().clone());
        assert!(matches!(iteration(newton.map()), Iteration::Newton));
        let after = run.advance().expect("a step of passes");
        let exact = newton.advance().expect("a step of Newton");
        let largest = |x: &[f64]| x.iter().fold(1.0_f64, |largest, x| largest.max(x.abs()));
        let reach = largest(exact.q());
        let speed = largest(exact.v());
        let speed = if S::N_CONSTRAINTS > 0 { speed.max(0.1 * reach / h) } else { speed };
        for (ours, theirs, size) in [(after.q(), exact.q(), reach), (after.v(), exact.v(), speed)] {
            roundings = roundings.max(largest_difference(ours, theirs) / (size * f64::EPSILON));
        }
    }
    let tally = run.tally();
    println!(
        "{}: {roundings:.1} roundings, {:.2} passes, {tally:?}",
        core::panic::Location::caller(),
        tally.corrections as f64 / STEPS as f64
    );
    assert_eq!((tally.restarts, tally.newton_steps), (0, 0), "vacuous: not by passes");
    roundings
}
