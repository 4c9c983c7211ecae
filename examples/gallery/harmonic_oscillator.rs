//! Harmonic oscillator: the linear test equation of exponential integrators. Energy is conserved; the motion is
//! `q = q₀ cos μt + (v₀/μ) sin μt` with `μ = √(k/m)`.

use evi_core::prelude::*;

/// A mass on a linear spring; SI units.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(coordinates(x), kinetic = 0.5 * m * der(x).powi(2), potential = 0.5 * k * x.powi(2))]
pub struct HarmonicOscillator {
    /// Mass.
    pub m: f64,
    /// Stiffness.
    pub k: f64,
}

impl HarmonicOscillator {
    /// Angular frequency `μ = √(k/m)`, rad/s.
    pub fn frequency(&self) -> f64 {
        (self.k / self.m).sqrt()
    }

    /// `(q, v)` at time `t` from `(q₀, v₀)` at time 0.
    pub fn exact(&self, t: f64, q0: f64, v0: f64) -> (f64, f64) {
        let mu = self.frequency();
        let (sine, cosine) = (mu * t).sin_cos();
        (cosine * q0 + sine * v0 / mu, cosine * v0 - mu * sine * q0)
    }
}
