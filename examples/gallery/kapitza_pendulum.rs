//! Pendulum on a pivot that is shaken up and down, `y_p = a cos(w t)`.
//!
//! Shaken fast enough, `(a w)² > 2 g l`, it stands upside down: averaged over the shaking, the inverted position lies in a
//! potential well (Kapitza, *Dynamic stability of a pendulum when its point of suspension vibrates*, Sov. Phys. JETP 21
//! (1951) 588; Landau, Lifshitz, *Mechanics*, sec. 30). The pivot is a constraint that depends on time: the rod does
//! work, and the energy is not conserved.

use evi_core::prelude::*;

use crate::{GRAVITY, Reference, ReferenceOrigin, Scene, Start};

/// Pendulum on a shaken pivot in Cartesian coordinates, y upwards; SI units.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = m * g * y,
    constraint(rod: x.powi(2) + (y - a * (w * t).cos()).powi(2) == l.powi(2)),
    observe(tilt: x.atan2(y - a * (w * t).cos())),
)]
pub struct KapitzaPendulum {
    /// Mass.
    pub m: f64,
    /// Length of the rod.
    pub l: f64,
    /// Gravitational acceleration.
    pub g: f64,
    /// Amplitude of the pivot.
    pub a: f64,
    /// Angular frequency of the pivot.
    pub w: f64,
}

impl KapitzaPendulum {
    /// `(a w)² > 2 g l`: stays near its inverted position.
    pub const STANDARD: Self = Self { m: 1.0, l: 0.3, g: GRAVITY, a: 0.1, w: 30.0 };

    /// `(a w)² < 2 g l`: falls.
    pub const LONG: Self = Self { l: 1.0, ..Self::STANDARD };

    /// At rest, 0.1 rad from the inverted position.
    pub fn near_inverted(&self) -> Start<2> {
        let (sine, cosine) = 0.1_f64.sin_cos();
        Start { q: [self.l * sine, self.a + self.l * cosine], v: [0.0; 2] }
    }
}

impl Scene for KapitzaPendulum {
    const NAME: &'static str = "kapitza_pendulum";
    const SUMMARY: &'static str = "A pendulum that stands upside down on a pivot that is shaken up and down.";
    const ORIGIN: &'static str =
        "Kapitza, Sov. Phys. JETP 21 (1951) 588; Landau & Lifshitz, Mechanics (1976), sec. 30";
    const HORIZON: f64 = 1.0;
    const CONSERVES_ENERGY: bool = false;

    fn standard() -> Self {
        Self::STANDARD
    }

    fn standard_motion(&self) -> ([f64; 2], [f64; 2]) {
        let Start { q, v } = self.near_inverted();
        (q, v)
    }

    fn reference() -> Reference<Self> {
        Reference {
            origin: ReferenceOrigin::Certified,
            q: [-0.006748973597739527, 0.31534922097362666],
            v: [0.006171865492860287, 2.964233753284131],
        }
    }
}
