//! Spherical pendulum in Cartesian coordinates: one constraint in space. Energy and the angular momentum about the
//! vertical, `m (x ẏ − y ẋ)`, are conserved; the motion is regular.

use evi_core::prelude::*;

use crate::{GRAVITY, Momentum, Reference, ReferenceOrigin, Scene, Start};

/// A point mass on a massless rod that swings in space, pivot at the origin, z upwards; SI units.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x, y, z),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2) + der(z).powi(2)),
    potential = m * g * z,
    constraint(rod: x.powi(2) + y.powi(2) + z.powi(2) == l.powi(2)),
)]
pub struct SphericalPendulum {
    /// Mass.
    pub m: f64,
    /// Length of the rod.
    pub l: f64,
    /// Gravitational acceleration.
    pub g: f64,
}

impl SphericalPendulum {
    /// Unit mass and length.
    pub const UNIT: Self = Self { m: 1.0, l: 1.0, g: GRAVITY };

    /// One radian from the downward vertical with horizontal velocity 1.2 (of the unit pendulum).
    pub fn one_radian(&self) -> Start<3> {
        let (sine, cosine) = 1.0_f64.sin_cos();
        Start { q: [self.l * sine, 0.0, -self.l * cosine], v: [0.0, 1.2, 0.0] }
    }
}

impl Scene for SphericalPendulum {
    const NAME: &'static str = "spherical_pendulum";
    const SUMMARY: &'static str = "A point mass on a massless rod that swings in space.";
    const ORIGIN: &'static str = "Landau & Lifshitz, Mechanics (1976), sec. 14, problem 1";
    const HORIZON: f64 = 10.0;
    const CONSERVES_ENERGY: bool = true;
    const MOMENTA: &'static [Momentum<Self>] = &[Momentum {
        name: "angular momentum about the vertical",
        value: |_, q, p| q[0] * p[1] - q[1] * p[0],
    }];

    fn standard() -> Self {
        Self::UNIT
    }

    fn standard_motion(&self) -> ([f64; 3], [f64; 3]) {
        let Start { q, v } = self.one_radian();
        (q, v)
    }

    fn reference() -> Reference<Self> {
        Reference {
            origin: ReferenceOrigin::Certified,
            q: [-0.010769679157201456, 0.560901690603541, -0.8278123624885899],
            v: [-1.768443913127701, -1.6566882725263228, -1.0995168960450608],
        }
    }

    fn equilibrium(&self) -> Option<[f64; 3]> {
        Some([0.0, 0.0, -self.l])
    }
}
