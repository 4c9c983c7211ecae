//! Inputs from step to step: exact motions, orders, failures.

use super::{check_slope, steps};
use evi_core::baseline::Rk4;
use evi_core::prelude::*;
use evi_examples::Start;
use evi_tests::scenes::{DampedOscillator, PushedDumbbell};
use evi_tests::{distance, integrate_by_hand};

const SYSTEM: DampedOscillator = DampedOscillator::STANDARD;
const T: f64 = 2.4;

/// Five levels, in equal shares of the time.
const LEVELS: [f64; 5] = [3.0, -2.0, 0.5, 4.0, -1.0];

/// Errors of position and velocity under inputs that are constant over whole steps, and the step sizes.
fn errors<F: Scheme<DampedOscillator>>(scheme: impl Fn(f64) -> F) -> (Vec<f64>, Vec<f64>) {
    let exact =
        LEVELS.iter().fold((1.0, -0.5), |state, &level| SYSTEM.exact(T / LEVELS.len() as f64, state, level));
    let run = |(n, h): (u32, f64)| {
        let mut run = Simulation::new(SYSTEM, scheme(h)).start([1.0], [-0.5]).expect("a start");
        for level in LEVELS {
            run.set_inputs([level]);
            for _ in 0..n / LEVELS.len() as u32 {
                run.advance().expect("a step");
            }
        }
        let state = run.state();
        (h, distance(&[state.q()[0], state.v()[0]], &[exact.0, exact.1]))
    };
    steps(T, 50).map(run).unzip()
}

#[test]
fn that_are_piecewise_constant_keep_the_order_of_the_method() {
    let (h, midpoint) = errors(Evi::midpoint);
    check_slope("midpoint", &h, &midpoint, 2.0);
    let (h, simpson) = errors(|h| Evi::simpson(h).scene_frequencies());
    check_slope("Simpson", &h, &simpson, 2.0);
    let (h, kutta) = errors(Rk4::new);
    check_slope("RK4", &h, &kutta, 4.0);
    let (h, galerkin) = errors(Galerkin::<2>::new);
    check_slope("Galerkin", &h, &galerkin, 4.0);
}

#[test]
fn that_are_no_numbers_are_refused_by_name() {
    for value in [f64::NAN, f64::INFINITY] {
        let mut run = Simulation::new(SYSTEM, Evi::midpoint(0.1)).start([1.0], [0.0]).expect("a start");
        run.set_inputs([value]);
        let before = run.state().clone();
        let error = run.advance().expect_err("not a number");
        let StepError::Input { name, value: reported } = error else { panic!("{error:?}") };
        assert_eq!((name, reported.to_bits()), (DampedOscillator::INPUTS[0], value.to_bits()));
        assert!(error.to_string().contains(name), "{error}");
        assert_eq!((run.steps(), run.state().q()), (0, before.q()));
    }
}

/// A free mass under constant pushes moves on parabolas, which straight curves meet at their ends.
#[test]
fn move_a_free_mass_exactly() {
    let mass = DampedOscillator { m: 2.0, k: 0.0, c: 0.0 };
    fn check<F: Scheme<DampedOscillator>>(mass: DampedOscillator, scheme: F, h: f64) {
        let mut run = Simulation::new(mass, scheme).start([0.3], [0.1]).expect("a start");
        let (mut x, mut v) = (0.3, 0.1);
        for level in LEVELS {
            run.inputs_mut()[0] = level;
            run.advance().expect("a step");
            (x, v) = (x + h * v + 0.5 * h * h * level / mass.m, v + h * level / mass.m);
            let state = run.state();
            assert_eq!(state.inputs(), &[level]);
            assert!((state.q()[0] - x).abs() <= 1e-15 && (state.v()[0] - v).abs() <= 1e-15, "{state:?}");
        }
    }
    for h in [0.1, -0.1] {
        check(mass, Evi::midpoint(h), h);
        check(mass, Evi::simpson(h), h);
    }
}

/// A smooth signal, sampled at the middle of each step or at its start.
#[test]
fn of_a_smooth_signal_are_sampled_in_the_middle() {
    let signal = |t: f64| 5.0 * (3.0 * t).sin();
    let acceleration =
        |t: f64, q: &[f64; 1], v: &[f64; 1]| [(signal(t) - SYSTEM.k * q[0] - SYSTEM.c * v[0]) / SYSTEM.m];
    let (q, v) = integrate_by_hand(acceleration, ([1.0], [-0.5]), T, 20_000);
    let errors = |at: f64| -> (Vec<f64>, Vec<f64>) {
        let run = |(n, h): (u32, f64)| {
            let mut run = Simulation::new(SYSTEM, Evi::midpoint(h)).start([1.0], [-0.5]).expect("a start");
            for _ in 0..n {
                run.set_inputs([signal(run.state().t() + at * h)]);
                run.advance().expect("a step");
            }
            (h, distance(run.state().q(), &q) + distance(run.state().v(), &v))
        };
        steps(T, 200).map(run).unzip()
    };
    let (h, middle) = errors(0.5);
    check_slope("sampled in the middle", &h, &middle, 2.0);
    let (h, start) = errors(0.0);
    check_slope("sampled at the start", &h, &start, 1.0);
}

/// A step that fails leaves the state, its inputs included.
#[test]
fn that_are_not_numbers_fail_the_step() {
    let system = PushedDumbbell::STANDARD;
    let Start { q, v } = system.turning();
    let mut run = Simulation::new(system, Evi::midpoint(0.1)).start(q, v).expect("a start");
    run.set_inputs([1.0, f64::NAN]);
    let before = run.state().clone();
    run.advance().expect_err("no force is NaN");
    assert_eq!(run.state().q(), before.q());
    run.set_inputs([1.0, 0.0]);
    run.advance().expect("a step");
}
