//! Next to a frequency that is refused, errors grow without bound: the refusal is no formality.

use core::f64::consts::PI;

use evi_core::prelude::*;

/// A body in uniform gravity.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(coordinates(y), kinetic = 0.5 * m * der(y).powi(2), potential = m * g * y)]
struct FallingBody {
    m: f64,
    g: f64,
}

const H: f64 = 0.5;

/// Error of the position after one step, `distance` before the phase `u` of a step.
fn error<const K: usize>(rule: Quadrature<K>, g: f64, u: f64, distance: f64) -> f64 {
    let scheme = Evi::new(rule, H).frequency((u - distance) / H).allow_soft_modes();
    let mut run =
        Simulation::new(FallingBody { m: 1.3, g }, scheme).start([0.7], [0.6]).expect("is not refused yet");
    let y = run.advance().expect("a step").q()[0];
    (y - (0.7 + 0.6 * H - 0.5 * g * H * H)).abs()
}

/// The error goes with the inverse of the distance; the ratio over the last decade is 10.1 to 10.5.
#[track_caller]
fn check<const K: usize>(rule: Quadrature<K>, g: f64, u: f64) {
    let errors = [1.0, 0.3, 0.03, 0.003].map(|distance| error(rule, g, u, distance));
    println!("{}: {errors:.3?}", core::panic::Location::caller());
    assert!(errors.is_sorted(), "{errors:?}");
    let ratio = errors[3] / errors[2];
    assert!((ratio - 10.0).abs() < 1.0, "{ratio}");
}

#[test]
fn without_inertia_between_the_nodes() {
    check(Quadrature::<2>::uniform(), 0.0, PI / 2.0);
    check(Quadrature::<3>::uniform(), 0.0, 2.0 * PI / 3.0);
}

#[test]
fn half_a_period_per_step() {
    check(Quadrature::midpoint(), 9.81, PI);
}
