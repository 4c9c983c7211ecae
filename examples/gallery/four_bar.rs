//! Four-bar linkage: crank, coupler and rocker close a loop with the ground. In natural coordinates, the places of the two moving
//! joints, the mass matrix is constant and three rods leave one degree of freedom.
//!
//! The bars are uniform: a bar with ends `a`, `b` has the kinetic energy `m (|ȧ|² + ȧ·ḃ + |ḃ|²)/6`. Energy is conserved. The standard
//! linkage satisfies Grashof's condition strictly, shortest and longest bar together shorter than the other two: its crank turns over and
//! over, and coupler and rocker are never in line, where the constraints would be dependent. García de Jalón & Bayo, *Kinematic and Dynamic
//! Simulation of Multibody Systems* (Springer 1994), ch. 2 and 4.

use evi_core::prelude::*;

use crate::{GRAVITY, Reference, ReferenceOrigin, Scene, Start};

/// Linkage in a vertical plane, the crank's pivot at the origin, the rocker's at `(ground, 0)`, y upwards; SI units.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x1, y1, x2, y2),
    let square1 = der(x1).powi(2) + der(y1).powi(2),
    let square2 = der(x2).powi(2) + der(y2).powi(2),
    let product = der(x1) * der(x2) + der(y1) * der(y2),
    kinetic = (m_crank * square1 + m_coupler * (square1 + product + square2) + m_rocker * square2) / 6.0,
    potential = 0.5 * g * (m_crank * y1 + m_coupler * (y1 + y2) + m_rocker * y2),
    constraint(crank: x1.powi(2) + y1.powi(2) == crank.powi(2)),
    constraint(coupler: (x2 - x1).powi(2) + (y2 - y1).powi(2) == coupler.powi(2)),
    constraint(rocker: (x2 - ground).powi(2) + y2.powi(2) == rocker.powi(2)),
)]
pub struct FourBar {
    /// Mass of the crank.
    pub m_crank: f64,
    /// Mass of the coupler.
    pub m_coupler: f64,
    /// Mass of the rocker.
    pub m_rocker: f64,
    /// Length of the crank.
    pub crank: f64,
    /// Length of the coupler.
    pub coupler: f64,
    /// Length of the rocker.
    pub rocker: f64,
    /// Distance of the pivots.
    pub ground: f64,
    /// Gravitational acceleration.
    pub g: f64,
}

impl FourBar {
    /// `0.75 + 2.5 < 2.25 + 2`: a crank and a rocker.
    pub const STANDARD: Self = Self {
        m_crank: 1.0,
        m_coupler: 2.0,
        m_rocker: 1.5,
        crank: 0.75,
        coupler: 2.5,
        rocker: 2.25,
        ground: 2.0,
        g: GRAVITY,
    };

    /// Crank and rocker upright (of the standard linkage), the crank turning clockwise: the coupler moves without turning.
    pub const fn upright(&self, rate: f64) -> Start<4> {
        let speed = self.crank * rate;
        Start { q: [0.0, self.crank, self.ground, self.rocker], v: [speed, 0.0, speed, 0.0] }
    }
}

impl Scene for FourBar {
    const NAME: &'static str = "four_bar";
    const SUMMARY: &'static str =
        "A crank that turns over, a coupler and a rocker under gravity, three turns.";
    const ORIGIN: &'static str = "García de Jalón & Bayo, Kinematic and Dynamic Simulation of Multibody Systems (1994); numbers of the gallery";
    const HORIZON: f64 = 2.0;
    const CONSERVES_ENERGY: bool = true;

    fn standard() -> Self {
        Self::STANDARD
    }

    fn standard_motion(&self) -> ([f64; 4], [f64; 4]) {
        let Start { q, v } = self.upright(8.0);
        (q, v)
    }

    fn reference() -> Reference<Self> {
        Reference {
            origin: ReferenceOrigin::Octuple,
            q: [0.6282196014143898, 0.4096829657170837, 2.34956968671394, 2.2226787968869273],
            v: [5.7713661365101565, -8.849978244881973, -4.254544774858974, 0.6691294694226313],
        }
    }
}
