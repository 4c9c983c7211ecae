//! Plane pendulum in Cartesian coordinates: the simplest scene with a constraint. Energy is conserved; the motion is that of
//! [`Pendulum`](crate::Pendulum), `x = l sin θ`, `y = −l cos θ`.
//!
//! The standard differential-algebraic equation of index 3 (Hairer & Wanner, *Solving Ordinary Differential Equations II*, Springer
//! 1996, sec. VII.1).

use evi_core::prelude::*;

use crate::{GRAVITY, Reference, ReferenceOrigin, Scene, Start};

/// A point mass on a massless rod, pivot at the origin, y upwards; SI units.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = m * g * y,
    constraint(rod: x.powi(2) + y.powi(2) == l.powi(2)),
)]
pub struct PendulumCartesian {
    /// Mass.
    pub m: f64,
    /// Length of the rod.
    pub l: f64,
    /// Gravitational acceleration.
    pub g: f64,
}

impl PendulumCartesian {
    /// Unit mass and length.
    pub const UNIT: Self = Self { m: 1.0, l: 1.0, g: GRAVITY };

    /// At rest with the rod at an angle from the downward vertical.
    pub fn at_rest(&self, angle: f64) -> Start<2> {
        let (sine, cosine) = angle.sin_cos();
        Start { q: [self.l * sine, -self.l * cosine], v: [0.0; 2] }
    }
}

impl Scene for PendulumCartesian {
    const NAME: &'static str = "pendulum_cartesian";
    const SUMMARY: &'static str = "A point mass on a massless rod in a plane, released above the pivot.";
    const ORIGIN: &'static str =
        "Hairer & Wanner, Solving Ordinary Differential Equations II (1996), sec. VII.1";
    const HORIZON: f64 = 10.0;
    const CONSERVES_ENERGY: bool = true;

    fn standard() -> Self {
        Self::UNIT
    }

    fn standard_motion(&self) -> ([f64; 2], [f64; 2]) {
        let Start { q, v } = self.at_rest(2.0);
        (q, v)
    }

    /// As for the pendulum in its angle.
    fn reference() -> Reference<Self> {
        Reference {
            origin: ReferenceOrigin::ClosedForm,
            q: [0.015727983632076965, -0.9998763076155316],
            v: [5.270246823189803, 0.08290060994625296],
        }
    }

    fn equilibrium(&self) -> Option<[f64; 2]> {
        Some([0.0, -self.l])
    }
}
