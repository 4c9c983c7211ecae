//! Case 2: frequencies of the curves, past every resonance; hyperbolic ones; modes that are softer than the frequency.

use std::f64::consts::PI;

use evi_core::scheme::Frequency;
use evi_examples::HarmonicOscillator;

use crate::action::{MIDPOINT, SIMPSON, TRAPEZOID};
use crate::methods::on_curves;
use crate::observation::Observation;
use crate::rows::{Effort, Planned, Trial};
use crate::scenes::FreeParticle;
use crate::specimen::Experiment;
use crate::theory::{Figure, Mode, Theory, hyperbolic_inertia};
use crate::verdict::Kind;

pub(crate) const SUMMARY: &str =
    "the phase u = ω h from 0 past π/2, 2π/3, π and 2π; hyperbolic curves up to u = 700; modes softer than ω";

const CASE: &str = "frequencies";
const H: f64 = 0.1;
const STEPS: u64 = 2000;
const M: f64 = 1.3;
/// Where an interpolant or its inertia vanishes to this part, the scheme is refused.
const RESONANT: f64 = 1e-3;

pub(crate) fn rows(effort: Effort) -> Vec<Planned> {
    let mut rows = Vec::new();
    let phases = [
        ("0.1", 0.1),
        ("1", 1.0),
        ("π/2 − 0.01", PI / 2.0 - 0.01),
        ("π/2", PI / 2.0),
        ("π/2 + 0.01", PI / 2.0 + 0.01),
        ("1.8", 1.8),
        ("2π/3 − 0.01", 2.0 * PI / 3.0 - 0.01),
        ("2π/3", 2.0 * PI / 3.0),
        ("2π/3 + 0.01", 2.0 * PI / 3.0 + 0.01),
        ("2.6", 2.6),
        ("π − 0.01", PI - 0.01),
        ("π", PI),
        ("π + 0.01", PI + 0.01),
        ("4", 4.0),
        ("3π/2", 1.5 * PI),
        ("5.3", 5.3),
        ("2π − 0.01", 2.0 * PI - 0.01),
        ("2π", 2.0 * PI),
    ];
    for (name, u) in effort.of(&phases) {
        rows.extend(own(effort, name, u));
    }
    for u in effort.of(&[0.1, 1.0, 10.0, 100.0, 350.0, 700.0, 711.0]) {
        rows.extend(hyperbolic(effort, u));
    }
    for ratio in effort.of(&[0.0, 0.01, 0.05, 0.1, 0.5, 1.0, 2.0]) {
        rows.extend(soft(effort, ratio));
    }
    rows.extend(free(effort));
    rows
}

fn nodes(method: &str) -> Option<&'static [(f64, f64)]> {
    match method {
        "midpoint_trig" => Some(MIDPOINT),
        "trapezoid_trig" => Some(TRAPEZOID),
        "simpson_trig" => Some(SIMPSON),
        _ => None,
    }
}

/// An oscillator on curves of its own frequency: its phase is exact, its momentum is off by a factor, whatever the nodes.
fn own(effort: Effort, name: &str, u: f64) -> Vec<Planned> {
    let omega = u / H;
    let mode = move |nodes| Mode { nodes, omega, mu: omega, h: H };
    let system = HarmonicOscillator { m: M, k: M * omega * omega };
    let experiment = Experiment::new(system, [1.0], [0.0], 0.5 * system.k, on_curves)
        .about([0.0])
        .with_frequency(omega)
        .reaching(1.0);
    Trial::new(
        CASE,
        format!("own frequency, u = {name}"),
        experiment,
        effort.course(H, STEPS, 2.0 * PI / omega),
    )
    .saying(move |method| {
        let nodes = nodes(method).unwrap_or(MIDPOINT);
        let is_blind = mode(nodes).inertia().abs() < RESONANT;
        Some(if u.sin().abs() < RESONANT {
            Theory::new("sin u = 0: two points do not determine the curve", &[Kind::Refused])
        } else if is_blind {
            Theory::new("the nodes do not see the inertia", &[Kind::Refused])
        } else {
            Theory::new("phase θ = u for every rule", Kind::KEPT)
        })
    })
    .measuring(move |method, seen| {
        let factor = nodes(method).map_or(1.0, |nodes| mode(nodes).momentum_factor());
        let error = seen.largest(|sample| sample.energy).unwrap_or(f64::NAN);
        // H = ½ k (cos² θ + κ² sin² θ), seen where sin² θ comes near 1.
        let expected = (factor.powi(2) - 1.0).abs();
        let covers = 1.0 - nearest_to_one(u, seen.steps);
        let name = "energy error against κ² − 1";
        vec![if expected < 1e-9 {
            Figure::at_most(name, error, 1e-9)
        } else {
            Figure::about(name, error, expected, covers + 1e-6)
        }]
    })
    .rows()
}

/// Largest `sin² ku` of the steps.
fn nearest_to_one(u: f64, steps: u64) -> f64 {
    (1..=steps).map(|k| (k as f64 * u).sin().powi(2)).fold(0.0, f64::max)
}

/// An unstable equilibrium, left on curves of its own rate: one step goes as far as `cosh u`.
fn hyperbolic(effort: Effort, u: f64) -> Vec<Planned> {
    let rate = u / H;
    let system = HarmonicOscillator { m: M, k: -M * rate * rate };
    // ½ k sinh² u of either sign: what is exchanged in the step.
    let exchanged = 0.5 * system.k.abs() * u.sinh().powi(2);
    let experiment = Experiment::new(system, [1.0], [0.0], exchanged.min(f64::MAX), on_curves)
        .about([0.0])
        .with_frequency(Frequency::Hyperbolic(rate))
        .reaching(f64::INFINITY);
    let course = effort.course(H, 1, f64::INFINITY);
    Trial::new(CASE, format!("hyperbolic, u = {u}"), experiment, course)
        .saying(move |method| {
            /// Momenta are off by a factor that grows with u, and with it the energy.
            const TAKEN: &[Kind] = &[Kind::Stable, Kind::Bounded, Kind::Diverged];
            let is_blind = nodes(method).is_some_and(|nodes| hyperbolic_inertia(nodes, u) < RESONANT);
            Some(if is_blind {
                Theory::new("the nodes do not see the inertia: u² e^(−u)", &[Kind::Refused])
            } else if u < 700.5 {
                Theory::new("q₁ = cosh u q₀", TAKEN)
            } else {
                Theory::new("cosh u is no number", &[Kind::Diverged, Kind::Refused, Kind::NoSolution])
            })
        })
        .measuring(move |_, seen| match &seen.end {
            Some(end) => vec![Figure::about("q₁ / cosh u", end.q[0] / u.cosh(), 1.0, 1e-12)],
            None => Vec::new(),
        })
        .rows()
}

/// A mode of frequency `μ = ratio ω` on curves of frequency `ω`.
fn soft(effort: Effort, ratio: f64) -> Vec<Planned> {
    const OMEGA: f64 = 3.132;
    let mu = ratio * OMEGA;
    let system = HarmonicOscillator { m: M, k: M * mu * mu };
    let exchanged = 0.5 * M * OMEGA * OMEGA;
    let experiment =
        Experiment::new(system, [1.0], [0.0], exchanged, on_curves).about([0.0]).with_frequency(OMEGA);
    let period = if mu > 0.0 { 2.0 * PI / mu } else { f64::INFINITY };
    let growth =
        move |method| nodes(method).map(|nodes| Mode { nodes, omega: OMEGA, mu, h: H }.growth_rate());
    Trial::new(CASE, format!("soft mode, μ = {ratio} ω"), experiment, effort.course(H, 400, period))
        .saying(move |method| {
            let rate = growth(method)?;
            Some(if rate > 0.0 {
                Theory::new(
                    format!("grows at the rate {rate:.3e}"),
                    &[Kind::Bounded, Kind::Drifting, Kind::Diverged],
                )
            } else {
                Theory::new("bounded", Kind::KEPT)
            })
        })
        .measuring(move |method, seen| growth(method).map(|rate| grown(rate, seen)).into_iter().collect())
        .rows()
}

/// How far the mode has gone beside where it began, against `cosh rt`.
fn grown(rate: f64, seen: &Observation) -> Figure {
    let Some(last) = seen.samples.last() else {
        return Figure::seen("q / q₀", f64::NAN);
    };
    let largest = seen.largest(|sample| sample.size).unwrap_or(f64::NAN);
    if rate > 0.0 {
        Figure::about("q / q₀", last.size, (rate * H * last.step as f64).cosh(), 1e-9)
    } else {
        Figure::at_most("largest q / q₀", largest, 1.0 + 1e-9)
    }
}

/// A coordinate that nothing holds: refused where it would grow.
fn free(effort: Effort) -> Vec<Planned> {
    let experiment = Experiment::new(FreeParticle { m: M }, [1.0], [0.5], 0.5 * M, || {
        let mut methods = on_curves();
        methods.pop();
        methods
    })
    .with_frequency(3.0)
    .reaching(25.0);
    Trial::new(CASE, "free particle, ω = 3", experiment, effort.course(H, 400, f64::INFINITY))
        .saying(|method| {
            Some(if method == "midpoint_trig" {
                Theory::new("one node: bounded momentum", &[Kind::Stable, Kind::Bounded])
            } else {
                Theory::new("several nodes: the coordinate would grow", &[Kind::Refused])
            })
        })
        .rows()
}
