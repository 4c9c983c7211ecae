//! Plane pendulum in its angle: the simplest nonlinear scene, without constraints. Energy is conserved.

use evi_core::prelude::*;

use crate::{GRAVITY, Reference, ReferenceOrigin, Scene, Start};

/// A point mass on a massless rod; SI units.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(theta),
    kinetic = 0.5 * m * l.powi(2) * der(theta).powi(2),
    potential = -m * g * l * theta.cos(),
)]
pub struct Pendulum {
    /// Mass.
    pub m: f64,
    /// Length of the rod.
    pub l: f64,
    /// Gravitational acceleration.
    pub g: f64,
}

impl Pendulum {
    /// Unit mass and length.
    pub const UNIT: Self = Self { m: 1.0, l: 1.0, g: GRAVITY };

    /// At rest at an angle from the downward vertical.
    pub const fn at_rest(&self, angle: f64) -> Start<1> {
        Start { q: [angle], v: [0.0] }
    }
}

impl Scene for Pendulum {
    const NAME: &'static str = "pendulum";
    const SUMMARY: &'static str = "A plane pendulum in its angle, released above the pivot.";
    const ORIGIN: &'static str = "Landau & Lifshitz, Mechanics (1976), sec. 11, problem 1";
    const HORIZON: f64 = 10.0;
    const CONSERVES_ENERGY: bool = true;

    fn standard() -> Self {
        Self::UNIT
    }

    fn standard_motion(&self) -> ([f64; 1], [f64; 1]) {
        let Start { q, v } = self.at_rest(2.0);
        (q, v)
    }

    /// `sin ½θ = k cd(√(g/l) t, k)` with Jacobi's elliptic function `cd` and `k = sin 1`, evaluated with 45 digits.
    fn reference() -> Reference<Self> {
        Reference { origin: ReferenceOrigin::ClosedForm, q: [0.015728632141429454], v: [5.270898793229828] }
    }

    fn equilibrium(&self) -> Option<[f64; 1]> {
        Some([0.0])
    }
}
