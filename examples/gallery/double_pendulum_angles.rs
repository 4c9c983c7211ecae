//! Plane double pendulum in the angles of its rods: the mass matrix depends on the configuration, and there are no constraints.
//! Energy is conserved; the motions are those of [`DoublePendulum`](crate::DoublePendulum). Landau & Lifshitz, *Mechanics*
//! (Butterworth-Heinemann 1976), sec. 5, problem 1.

use evi_core::prelude::*;

use crate::{GRAVITY, Reference, ReferenceOrigin, Scene, Start};

/// Two point masses on massless rods, angles from the downward vertical; SI units.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(theta1, theta2),
    kinetic   = 0.5 * (m1 + m2) * (l1 * der(theta1)).powi(2) + 0.5 * m2 * (l2 * der(theta2)).powi(2)
              + m2 * l1 * l2 * der(theta1) * der(theta2) * (theta1 - theta2).cos(),
    potential = -(m1 + m2) * g * l1 * theta1.cos() - m2 * g * l2 * theta2.cos(),
)]
pub struct DoublePendulumAngles {
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

impl DoublePendulumAngles {
    /// Equal masses 1 kg and lengths 1 m.
    pub const UNIT: Self = Self { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g: GRAVITY };

    /// At rest, both rods stretched out horizontally: the start of chaotic motion.
    pub const fn horizontal(&self) -> Start<2> {
        Start { q: [core::f64::consts::FRAC_PI_2; 2], v: [0.0; 2] }
    }
}

impl Scene for DoublePendulumAngles {
    const NAME: &'static str = "double_pendulum_angles";
    const SUMMARY: &'static str =
        "The double pendulum in the angles of its rods, chaotic from the horizontal.";
    const ORIGIN: &'static str = "Landau & Lifshitz, Mechanics (1976), sec. 5, problem 1";
    const HORIZON: f64 = 10.0;
    const CONSERVES_ENERGY: bool = true;

    fn standard() -> Self {
        Self::UNIT
    }

    fn standard_motion(&self) -> ([f64; 2], [f64; 2]) {
        let Start { q, v } = self.horizontal();
        (q, v)
    }

    /// From the certified end in Cartesian coordinates, `θ = atan2(x, −y)` and `l² θ' = x y' − y x'` of either rod, with all its digits;
    /// neither rod has turned over more often to one side than to the other.
    fn reference() -> Reference<Self> {
        Reference {
            origin: ReferenceOrigin::Certified,
            q: [-0.5684746640159501, -0.5263937279324047],
            v: [6.078384885761965, -9.68136068170888],
        }
    }
}
