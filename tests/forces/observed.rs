//! Quantities that a run records.

use evi_core::prelude::*;
use evi_examples::{DrivenPendulum, Start};
use evi_tests::scenes::PushedDumbbell;

#[test]
fn quantities_are_recorded_by_name() {
    let system = DrivenPendulum::STANDARD;
    let Start { q, v } = system.horizontal();
    let mut run = Simulation::new(system, Evi::midpoint(0.01)).start(q, v).expect("a start");
    let trajectory = run.integrate(1.0).expect("all steps");
    assert_eq!(DrivenPendulum::OBSERVABLES, ["angle", "power"]);
    assert!(trajectory.series("torque").is_none());
    let angles = trajectory.series("angle").expect("observed");
    assert_eq!(angles.len(), 101);
    for (state, angle) in trajectory.states().iter().zip(angles) {
        assert_eq!(angle, state.q()[0].atan2(-state.q()[1]));
    }
    let power = trajectory.series("power").expect("observed");
    for (state, power) in trajectory.states().iter().zip(power) {
        let DrivenPendulum { a, c, w, .. } = system;
        let [vx, vy] = *state.v();
        let expected = a * (w * state.t()).cos() * vx - c * (vx * vx + vy * vy);
        assert!((power - expected).abs() <= 1e-14, "{power} instead of {expected}");
    }
    assert_eq!(trajectory.observed().last(), Some(&run.observe()));
    let clone = trajectory.clone();
    assert_eq!(format!("{clone:?}"), format!("{trajectory:?}"));
}

#[test]
fn quantities_may_name_inputs() {
    let system = PushedDumbbell::STANDARD;
    let Start { q, v } = system.turning();
    let mut run = Simulation::new(system, Evi::simpson(0.01)).start(q, v).expect("a start");
    assert_eq!(run.observe(), [0.0, 0.0]);
    run.set_inputs([2.0, -3.0]);
    assert_eq!(run.observe()[1], 2.0 * v[0] - 3.0 * v[1]);
    assert!(format!("{:?}", run.state()).contains("inputs: [2.0, -3.0]"));
}
