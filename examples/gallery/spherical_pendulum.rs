//! Spherical pendulum in Cartesian coordinates: one constraint in space. Energy and the angular momentum about the
//! vertical, `m (x ẏ − y ẋ)`, are conserved; the motion is regular.

use evi_core::prelude::*;

use crate::{GRAVITY, Start};

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
