//! Order of accuracy against certified digits and references by hand.

use super::{End, check_order};
use evi_core::baseline::Rk4;
use evi_core::prelude::*;
use evi_examples::{DrivenPendulum, KapitzaPendulum, Start};
use evi_tests::integrate_by_hand;
use evi_tests::references;
use evi_tests::scenes::{KapitzaPendulumInAngle, MotorisedDoublePendulum};

const OMEGA: f64 = 3.1;

/// Every kind of member.
#[track_caller]
fn check<S, const N: usize>(system: S, start: Start<N>, end: &End, coarsest: u32)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Copy,
{
    check_order(system, start, end, coarsest, 2.0, Evi::midpoint);
    check_order(system, start, end, coarsest, 2.0, Evi::simpson);
    check_order(system, start, end, coarsest, 2.0, |h| Evi::midpoint(h).frequency(OMEGA));
    check_order(system, start, end, coarsest, 2.0, |h| Evi::simpson(h).frequency(OMEGA));
    check_order(system, start, end, coarsest, 2.0, |h| Evi::new(Quadrature::<2>::lobatto(), h));
    check_order(system, start, end, coarsest, 4.0, Rk4::new);
}

#[test]
fn driven_pendulum_towards_certified_digits() {
    let system = DrivenPendulum::STANDARD;
    let end = End::certified(references::DRIVEN_PENDULUM, references::DRIVEN_PENDULUM_ENERGY);
    check(system, system.horizontal(), &end, 100);
}

#[test]
fn forces_on_a_mass_matrix_that_depends_on_the_configuration() {
    let system = MotorisedDoublePendulum::STANDARD;
    let start = Start { q: [0.8, -0.3], v: [0.5, 1.1] };
    let acceleration = |t: f64, q: &[f64; 2], v: &[f64; 2]| system.acceleration(t, q, v);
    let t = 1.0;
    let (q, v) = integrate_by_hand(acceleration, (start.q, start.v), t, 20_000);
    let energy = evi_core::mechanics::Mechanics::new(&system).energy_at(t, &q, &v);
    let end = End { t, q: q.to_vec(), v: v.to_vec(), multipliers: vec![], energy };
    check(system, start, &end, 70);
}

/// A pivot that moves up and down, as a constraint.
#[test]
fn kapitza_pendulum_towards_certified_digits() {
    for (system, certified) in [
        (KapitzaPendulum::STANDARD, references::RHEONOMIC_PENDULUM),
        (KapitzaPendulum::LONG, references::RHEONOMIC_PENDULUM_LONG),
    ] {
        let energy = evi_core::mechanics::Mechanics::new(&system).energy_at(
            certified.t,
            &[certified.q[0], certified.q[1]],
            &[certified.v[0], certified.v[1]],
        );
        let end = End::certified(certified, energy);
        let start = system.near_inverted();
        check_order(system, start, &end, 400, 2.0, Evi::midpoint);
        check_order(system, start, &end, 400, 2.0, |h| Evi::simpson(h).frequency(OMEGA));
    }
}

/// The same pendulum in its angle, where time stands in the Lagrangian.
#[test]
fn a_lagrangian_of_time_towards_certified_digits() {
    for (system, certified) in [
        (KapitzaPendulum::STANDARD, references::RHEONOMIC_PENDULUM),
        (KapitzaPendulum::LONG, references::RHEONOMIC_PENDULUM_LONG),
    ] {
        let KapitzaPendulum { l, a, w, .. } = system;
        let (t, [x, y], [vx, vy]) =
            (certified.t, [certified.q[0], certified.q[1]], [certified.v[0], certified.v[1]]);
        let (pivot, pivot_rate) = (a * (w * t).cos(), -a * w * (w * t).sin());
        // From the inverted position at θ = π, on this side of it.
        let angle = x.atan2(pivot - y);
        let angle = if angle < 0.0 { angle + std::f64::consts::TAU } else { angle };
        let rate = (x * (vy - pivot_rate) - (y - pivot) * vx) / (l * l);
        let system = KapitzaPendulumInAngle::of(system);
        let energy = evi_core::mechanics::Mechanics::new(&system).energy_at(t, &[angle], &[rate]);
        let end = End { t, q: vec![angle], v: vec![rate], multipliers: vec![], energy };
        let start = Start { q: [std::f64::consts::PI - 0.1], v: [0.0] };
        check_order(system, start, &end, 400, 2.0, Evi::midpoint);
        check_order(system, start, &end, 400, 2.0, Evi::simpson);
    }
}
