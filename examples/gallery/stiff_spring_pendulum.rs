//! Stiff spring pendulum: a plane pendulum whose rod is a stiff linear spring, without constraints. The fast radial
//! oscillation has the frequency `√(k/m)`; energy is conserved. A classical stiff test (e.g. Hairer, Lubich, Wanner,
//! Geometric Numerical Integration, ch. XIV).

use evi_core::prelude::*;

use crate::{GRAVITY, Reference, ReferenceOrigin, Scene, Start};

/// A point mass on a spring fixed at the origin, y upwards; SI units.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x, y),
    let stretch = (x.powi(2) + y.powi(2)).sqrt() - l,
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = 0.5 * k * stretch.powi(2) + m * g * y,
)]
pub struct StiffSpringPendulum {
    /// Mass.
    pub m: f64,
    /// Rest length of the spring.
    pub l: f64,
    /// Stiffness of the spring.
    pub k: f64,
    /// Gravitational acceleration.
    pub g: f64,
}

impl StiffSpringPendulum {
    /// Unit mass and length with the given stiffness.
    pub const fn with_stiffness(k: f64) -> Self {
        Self { m: 1.0, l: 1.0, k, g: GRAVITY }
    }

    /// Unstretched and horizontal with a downward velocity of 0.5.
    pub const fn horizontal(&self) -> Start<2> {
        Start { q: [self.l, 0.0], v: [0.0, -0.5] }
    }
}

impl Scene for StiffSpringPendulum {
    const NAME: &'static str = "stiff_spring_pendulum";
    const SUMMARY: &'static str = "A point mass on a stiff linear spring that swings in a plane.";
    const ORIGIN: &'static str = "Hairer, Lubich, Wanner, Geometric Numerical Integration (2006), ch. XIV";
    const HORIZON: f64 = 1.0;
    const CONSERVES_ENERGY: bool = true;

    fn standard() -> Self {
        Self::with_stiffness(1e4)
    }

    fn standard_motion(&self) -> ([f64; 2], [f64; 2]) {
        let Start { q, v } = self.horizontal();
        (q, v)
    }

    fn reference() -> Reference<Self> {
        Reference {
            origin: ReferenceOrigin::Certified,
            q: [-0.9969486702681352, -0.0811454255935466],
            v: [-0.10395435853697933, 1.3530201843563137],
        }
    }

    fn equilibrium(&self) -> Option<[f64; 2]> {
        Some([0.0, -self.l - self.m * self.g / self.k])
    }
}
