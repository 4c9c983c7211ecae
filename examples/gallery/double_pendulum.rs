//! Planar double pendulum in Cartesian coordinates: two point masses on massless rods.
//!
//! Regular near its hanging rest, chaotic from the horizontal. Energy is conserved. The test problem of
//! Hairer, Lubich, Wanner, Geometric Numerical Integration, and of the literature on exponential variational integrators.

use evi_core::prelude::*;

use crate::{GRAVITY, Reference, ReferenceOrigin, Scene, Start};

/// Planar double pendulum, pivot at the origin, y upwards; SI units.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x1, y1, x2, y2),
    kinetic   = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2))
              + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2)),
    potential = g * (m1 * y1 + m2 * y2),
    constraint(rod1: x1.powi(2) + y1.powi(2) == l1.powi(2)),
    constraint(rod2: (x2 - x1).powi(2) + (y2 - y1).powi(2) == l2.powi(2)),
)]
pub struct DoublePendulum {
    /// Mass of the inner bob.
    pub m1: f64,
    /// Mass of the outer bob.
    pub m2: f64,
    /// Length of the inner rod.
    pub l1: f64,
    /// Length of the outer rod.
    pub l2: f64,
    /// Gravitational acceleration.
    pub g: f64,
}

impl DoublePendulum {
    /// Equal masses 1 kg and lengths 1 m.
    pub const UNIT: Self = Self { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g: GRAVITY };

    /// At rest with the rods at angles `angle1`, `angle2` from the downward vertical.
    pub fn at_angles(&self, angle1: f64, angle2: f64) -> Start<4> {
        let inner = [self.l1 * angle1.sin(), -self.l1 * angle1.cos()];
        let outer = [inner[0] + self.l2 * angle2.sin(), inner[1] - self.l2 * angle2.cos()];
        Start { q: [inner[0], inner[1], outer[0], outer[1]], v: [0.0; 4] }
    }

    /// At rest, both rods stretched out horizontally: the start of chaotic motion.
    pub const fn horizontal(&self) -> Start<4> {
        Start { q: [self.l1, 0.0, self.l1 + self.l2, 0.0], v: [0.0; 4] }
    }
}

impl Scene for DoublePendulum {
    const NAME: &'static str = "double_pendulum";
    const SUMMARY: &'static str = "Two point masses on massless rods, chaotic from the horizontal.";
    const ORIGIN: &'static str =
        "Hairer, Lubich, Wanner, Geometric Numerical Integration (2006), sec. VII.1.4, for two masses";
    const HORIZON: f64 = 10.0;
    const CONSERVES_ENERGY: bool = true;

    fn standard() -> Self {
        Self::UNIT
    }

    fn standard_motion(&self) -> ([f64; 4], [f64; 4]) {
        let Start { q, v } = self.horizontal();
        (q, v)
    }

    fn reference() -> Reference<Self> {
        Reference {
            origin: ReferenceOrigin::Certified,
            q: [-0.5383472396122264, -0.8427231156209589, -1.0407657832461705, -1.7073476624693273],
            v: [5.12239544887267, -3.272281724550632, -3.248346643425482, 1.5918134095484713],
        }
    }
}
