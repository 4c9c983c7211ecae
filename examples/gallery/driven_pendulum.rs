//! Pendulum with viscous drag, pushed sideways by a periodic force: the bob moves through a fluid and is driven.
//!
//! In the angle `θ` from hanging, `m l² θ'' = −m g l sin θ − c l² θ' + l A cos(w t) cos θ`. Small drives make it swing with the
//! drive, large ones chaotically (Baker, Gollub, *Chaotic Dynamics*, Cambridge University Press 1990, whose drive is a torque).
//! The energy changes by the power of drag and drive.

use evi_core::prelude::*;

use crate::{GRAVITY, Reference, ReferenceOrigin, Scene, Start};

/// Driven and damped pendulum in Cartesian coordinates, pivot at the origin, y upwards; SI units.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x, y),
    let drag = c * (der(x).powi(2) + der(y).powi(2)),
    let drive = a * (w * t).cos(),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = m * g * y,
    constraint(rod: x.powi(2) + y.powi(2) == l.powi(2)),
    dissipation = 0.5 * drag,
    force(x: drive),
    observe(angle: x.atan2(-y)),
    observe(power: drive * der(x) - drag),
)]
pub struct DrivenPendulum {
    /// Mass.
    pub m: f64,
    /// Length of the rod.
    pub l: f64,
    /// Gravitational acceleration.
    pub g: f64,
    /// Drag coefficient, force per velocity.
    pub c: f64,
    /// Amplitude of the drive, a force.
    pub a: f64,
    /// Angular frequency of the drive.
    pub w: f64,
}

impl DrivenPendulum {
    /// Light drag; the drive is slower than small swings, `√(g/l) = 3.13`.
    pub const STANDARD: Self = Self { m: 1.0, l: 1.0, g: GRAVITY, c: 0.1, a: 0.5, w: 2.0 };

    /// At rest, the rod horizontal.
    pub const fn horizontal(&self) -> Start<2> {
        Start { q: [self.l, 0.0], v: [0.0; 2] }
    }
}

impl Scene for DrivenPendulum {
    const NAME: &'static str = "driven_pendulum";
    const SUMMARY: &'static str = "A pendulum with viscous drag, pushed sideways by a periodic force.";
    const ORIGIN: &'static str = "Baker & Gollub, Chaotic Dynamics (1990), whose drive is a torque";
    const HORIZON: f64 = 1.0;
    const CONSERVES_ENERGY: bool = false;

    fn standard() -> Self {
        Self::STANDARD
    }

    fn standard_motion(&self) -> ([f64; 2], [f64; 2]) {
        let Start { q, v } = self.horizontal();
        (q, v)
    }

    fn reference() -> Reference<Self> {
        Reference {
            origin: ReferenceOrigin::Certified,
            q: [-0.9616585838860878, -0.2742494631502571],
            v: [-0.4570493297651815, 1.6026482100614385],
        }
    }
}
