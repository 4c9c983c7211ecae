//! Exact facts about the linear test equation, and about the nodes and curves that a scheme is made of.
//!
//! For `L = ½ v² − ½ μ² q²`, the method frequency `ω`, `u = ω h` and mirror-symmetric nodes `σⱼ = cⱼ − ½`,
//! put `S₂ = Σ wⱼ sin² uσⱼ`, `C₂ = 1 − S₂`, `κ = C₂ − S₂`. The discrete Lagrangian is the quadratic form
//!
//! ```text
//! L_d = (h/8) { (ω² C₂ − μ² S₂) d² / sin² ½u + 4 (ω² S₂ − μ² C₂) s² / cos² ½u }
//! ```
//!
//! in `d = q₁ − q₀` and `s = ½ (q₀ + q₁)`, and from it follow phase, momentum factor and limits of stability.
//! Steps are measured as the 2 × 2 matrix of the map `(q, p) → (q, p)` of a unit mass.

mod curves;
mod order;
mod phase;
mod refusals;
mod rules;
mod stability;

use core::f64::consts::PI;

use evi_core::prelude::*;
use evi_core::scheme::{Interpolant, NodeCoefficients};
use evi_examples::HarmonicOscillator;
use evi_tests::observed_order;

/// A few roundings of numbers of order one.
const ROUND_OFF: f64 = 1e-14;

/// The matrix of one step, columns from `(q, p) = (1, 0)` and `(0, 1)`.
#[track_caller]
fn step_matrix<const K: usize, F>(mu: f64, scheme: Evi<K, F>) -> [[f64; 2]; 2]
where
    F: Interpolant<HarmonicOscillator> + Copy,
{
    let column = |q: f64, v: f64| {
        let simulation = Simulation::new(HarmonicOscillator { m: 1.0, k: mu * mu }, scheme);
        let mut run = simulation.start([q], [v]).expect("a start");
        let state = run.advance().expect("a step");
        [state.q()[0], state.p()[0]]
    };
    let (left, right) = (column(1.0, 0.0), column(0.0, 1.0));
    [[left[0], right[0]], [left[1], right[1]]]
}

/// `Σ wⱼ f(σⱼ)`.
fn sum<const K: usize>(rule: &Quadrature<K>, f: impl Fn(f64) -> f64) -> f64 {
    rule.weights().iter().zip(rule.offsets()).map(|(weight, offset)| weight * f(*offset)).sum()
}

fn user_rule() -> Quadrature<2> {
    Quadrature::interpolatory([0.125, 0.875]).expect("a rule")
}

fn left_rectangle() -> Quadrature<1> {
    Quadrature::interpolatory([0.0]).expect("a rule")
}

/// A body in uniform gravity.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(coordinates(y), kinetic = 0.5 * m * der(y).powi(2), potential = m * g * y)]
struct FallingBody {
    m: f64,
    g: f64,
}

#[test]
fn a_body_falls_on_the_midpoint_with_the_gravity_of_the_formula() {
    let (g, h) = (9.81, 0.1);
    for u in [1e-3, 0.1, 0.5, 1.0, 1.5] {
        let scheme = Evi::midpoint(h).frequency(u / h);
        let mut run =
            Simulation::new(FallingBody { m: 1.0, g }, scheme).start([0.0], [0.0]).expect("a start");
        let mut y = vec![0.0];
        for _ in 0..10 {
            y.push(run.advance().expect("a step").q()[0]);
        }
        let half: f64 = 0.5 * u;
        let expected = -g * h * h * (half.sin() / half).powi(2) / half.cos();
        for window in y.windows(3) {
            let measured = window[2] - 2.0 * window[1] + window[0];
            // Second differences of positions of size 5.
            assert!(
                (measured - expected).abs() <= 4.0 * 5.0 * f64::EPSILON,
                "{measured}, expected {expected}"
            );
        }
        // 1 + u²/24 + O(u⁴)
        let excess = -expected / (g * h * h) - 1.0;
        assert!((excess - u * u / 24.0).abs() <= 0.1 * u.powi(4) + 4.0 * f64::EPSILON, "{excess} at u = {u}");
    }
}
