//! Damping rates, reversal, and forces that are stiffer than the step.

use super::check_slope;
use evi_core::prelude::*;
use evi_tests::largest_difference;
use evi_tests::scenes::{DampedOscillator, MotorisedDoublePendulum};

const SYSTEM: DampedOscillator = DampedOscillator::STANDARD;

/// Damping rate and frequency of a scheme: of the eigenvalues `exp((−decay ± i rate) h)` of one step, which is linear.
fn rates<F: Scheme<DampedOscillator>>(scheme: F, h: f64) -> (f64, f64) {
    let simulation = Simulation::new(SYSTEM, scheme);
    let column = |x: f64, v: f64| {
        let mut run = simulation.start([x], [v]).expect("a start");
        let state = run.advance().expect("a step");
        [state.q()[0], state.v()[0]]
    };
    let (first, second) = (column(1.0, 0.0), column(0.0, 1.0));
    let determinant = first[0] * second[1] - first[1] * second[0];
    let cosine = 0.5 * (first[0] + second[1]) / determinant.sqrt();
    (-0.5 * determinant.ln() / h, cosine.acos() / h.abs())
}

#[track_caller]
fn check<F: Scheme<DampedOscillator>>(scheme: impl Fn(f64) -> F) {
    let decay = 0.5 * SYSTEM.c / SYSTEM.m;
    let frequency = (SYSTEM.k / SYSTEM.m - decay * decay).sqrt();
    for sign in [1.0, -1.0] {
        let (mut h, mut decays, mut ratios) = (vec![], vec![], vec![]);
        for k in 0..4 {
            let size = sign * 0.2 / f64::from(1 << k);
            let (found, rate) = rates(scheme(size), size);
            assert!(found > 0.0, "the oscillator gains energy: {found}");
            h.push(size.abs());
            decays.push((found - decay).abs());
            ratios.push((found / found.hypot(rate) - decay / decay.hypot(frequency)).abs());
        }
        check_slope("decay", &h, &decays, 2.0);
        check_slope("damping ratio", &h, &ratios, 2.0);
    }
}

#[test]
fn has_order_2_and_the_right_sign_forwards_and_backwards() {
    check(Evi::midpoint);
    check(Evi::simpson);
    check(|h| Evi::new(Quadrature::<2>::lobatto(), h));
    check(|h| Evi::midpoint(h).frequency(1.3));
    check(|h| Evi::simpson(h).frequency(1.3));
}

/// A symmetric member is its own adjoint, with forces as without: a step back undoes a step.
#[test]
fn is_undone_by_a_step_back() {
    fn check<F: Scheme<MotorisedDoublePendulum>>(scheme: impl Fn(f64) -> F) {
        let h = 0.02;
        let system = MotorisedDoublePendulum::STANDARD;
        let mut run =
            Simulation::new(system, scheme(h)).start_at(0.4, [0.8, -0.3], [0.5, 1.1]).expect("a start");
        let start = run.state().clone();
        let state = run.advance().expect("a step").clone();
        let back = Simulation::new(system, scheme(-h));
        let mut back = back.start_at(state.t(), *state.q(), *state.v()).expect("a start");
        let returned = back.advance().expect("a step");
        let difference =
            largest_difference(returned.q(), start.q()).max(largest_difference(returned.v(), start.v()));
        println!("{difference:e}");
        // A few roundings of the angles and rates: 2.3e-16 measured.
        assert!(difference <= 1e-15, "{difference:e}");
        assert!(largest_difference(state.q(), start.q()) > 1e-3);
    }
    check(Evi::midpoint);
    check(|h| Evi::simpson(h).frequency(2.0));
}

/// Newton's matrix holds the derivatives of the forces: without them its corrections would grow from one to the next.
#[test]
fn far_stiffer_than_the_step_is_solved() {
    let stiff = DampedOscillator { m: 1.0, k: 4.0, c: 2e4 };
    for step in [0.01, 0.1] {
        let mut run = Simulation::new(stiff, Evi::midpoint(step)).start([1.0], [0.0]).expect("a start");
        for _ in 0..100 {
            run.advance().expect("a step");
        }
        // Creeps at the rate k / c.
        let creep = (-4.0 / 2e4 * run.state().t()).exp();
        assert!((run.state().q()[0] - creep).abs() <= 1e-4, "{}", run.state().q()[0]);
    }
}
