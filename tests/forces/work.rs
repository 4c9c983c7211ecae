//! The energy changes by the work, to the order of the method.

use super::{check_slope, steps};
use evi_core::prelude::*;
use evi_examples::{DrivenPendulum, KapitzaPendulum, Start};
use evi_tests::scenes::{KapitzaPendulumInAngle, MotorisedDoublePendulum};

/// The change of the energy, less the integral of `power` along the states, is of second order.
#[track_caller]
fn check<S, F, const N: usize>(
    system: S,
    Start { q, v }: Start<N>,
    (t, coarsest): (f64, u32),
    scheme: impl Fn(f64) -> F,
    power: impl Fn(&Run<S, F::Step>) -> f64,
) where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Copy,
    F: Scheme<S>,
{
    let (mut h, mut defects) = (vec![], vec![]);
    for (n, size) in steps(t, coarsest) {
        let mut run = Simulation::new(system, scheme(size)).start(q, v).expect("a consistent start");
        let start = run.energy();
        let mut work = 0.5 * size * power(&run);
        for step in 1..=n {
            run.advance().expect("a step");
            work += if step < n { size } else { 0.5 * size } * power(&run);
        }
        assert!((run.energy() - start).abs() > 0.1, "no work is done");
        h.push(size);
        defects.push((run.energy() - start - work).abs());
    }
    check_slope("work", &h, &defects, 2.0);
}

#[test]
fn of_drag_and_drive() {
    let system = DrivenPendulum::STANDARD;
    let start = system.horizontal();
    check(system, start, (1.0, 50), Evi::midpoint, |run| run.observe()[1]);
    check(system, start, (1.0, 50), |h| Evi::simpson(h).frequency(3.1), |run| run.observe()[1]);
}

/// `f·v` of the forces that the mechanics gives, on a system of two coordinates.
#[test]
fn of_friction_and_a_motor() {
    let system = MotorisedDoublePendulum::STANDARD;
    let start = Start { q: [0.8, -0.3], v: [0.5, 1.1] };
    let power = |run: &Run<MotorisedDoublePendulum, _>| {
        let state = run.state();
        let forces = run.mechanics().forces(state);
        forces[0] * state.v()[0] + forces[1] * state.v()[1]
    };
    check(system, start, (1.0, 50), Evi::simpson, power);
}

/// `dH/dt = λ·∂φ/∂t`: the rod of a pendulum works when its pivot moves.
#[test]
fn of_a_constraint_that_depends_on_time() {
    let system = KapitzaPendulum::STANDARD;
    check(system, system.near_inverted(), (0.97, 400), Evi::midpoint, |run| {
        let state = run.state();
        let found = run.mechanics().acceleration(state.t(), state.q(), state.v()).expect("regular");
        let KapitzaPendulum { a, w, .. } = system;
        let (sine, cosine) = (w * state.t()).sin_cos();
        found.multipliers[0] * 2.0 * (state.q()[1] - a * cosine) * a * w * sine
    });
}

/// `dH/dt = −∂L/∂t`, the derivative taken by dual numbers over the kernel.
#[test]
fn of_a_lagrangian_that_depends_on_time() {
    use num_dual::Dual64;
    let system = KapitzaPendulumInAngle::of(KapitzaPendulum::LONG);
    let parameters = system.parameters().map(Dual64::from);
    let constants = KapitzaPendulumInAngle::constants(&parameters);
    let start = Start { q: [2.0], v: [1.0] };
    check(system, start, (0.97, 400), Evi::simpson, |run| {
        let state = run.state();
        let time = Dual64::from(state.t()).derivative();
        let (q, v) = (state.q().map(Dual64::from), state.v().map(Dual64::from));
        -KapitzaPendulumInAngle::lagrangian(&constants, time, &q, &v).eps
    });
}
