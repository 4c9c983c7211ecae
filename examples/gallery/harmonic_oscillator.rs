//! Harmonic oscillator: the linear test equation of exponential integrators. Energy is conserved; the motion is
//! `q = q₀ cos μt + (v₀/μ) sin μt` with `μ = √(k/m)`.

use evi_core::prelude::*;

use crate::{Reference, ReferenceOrigin, Scene, Start};

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
    /// Unit mass with the frequency 2.
    pub const STANDARD: Self = Self { m: 1.0, k: 4.0 };

    /// Displaced and moving outwards.
    pub const fn moving_outwards(&self) -> Start<1> {
        Start { q: [1.0], v: [1.0] }
    }

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

impl Scene for HarmonicOscillator {
    const NAME: &'static str = "harmonic_oscillator";
    const SUMMARY: &'static str = "A mass on a linear spring: the linear test equation.";
    const ORIGIN: &'static str = "Hairer, Lubich, Wanner, Geometric Numerical Integration (2006), sec. I.1";
    const HORIZON: f64 = 10.0;
    const CONSERVES_ENERGY: bool = true;

    fn standard() -> Self {
        Self::STANDARD
    }

    fn standard_motion(&self) -> ([f64; 1], [f64; 1]) {
        let Start { q, v } = self.moving_outwards();
        (q, v)
    }

    /// `q = cos μt + ½ sin μt`.
    fn reference() -> Reference<Self> {
        Reference { origin: ReferenceOrigin::ClosedForm, q: [0.8645546871772058], v: [-1.4178084396418633] }
    }

    fn equilibrium(&self) -> Option<[f64; 1]> {
        Some([0.0])
    }
}
