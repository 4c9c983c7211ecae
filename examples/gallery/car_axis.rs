//! The car axis: two point masses at the ends of a rigid axle, on springs whose right end follows a bumpy road. The left mass moves
//! across the line of the spring feet, so that two constraints hold, of which one depends on time; energy is not conserved.
//! Test Set for IVP Solvers (Mazzia & Magherini), problem `caraxis`; its multipliers have the opposite sign.

use evi_core::prelude::*;

use crate::{Reference, ReferenceOrigin, Scene, Start};

/// Car axis, y upwards; units of the test set.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(xl, yl, xr, yr),
    let mass = 0.5 * m * eps.powi(2),
    let yb = r * (w * t).sin(),
    let xb = (l.powi(2) - yb.powi(2)).sqrt(),
    let left = (xl.powi(2) + yl.powi(2)).sqrt() - l0,
    let right = ((xr - xb).powi(2) + (yr - yb).powi(2)).sqrt() - l0,
    kinetic = 0.5 * mass * (der(xl).powi(2) + der(yl).powi(2) + der(xr).powi(2) + der(yr).powi(2)),
    potential = 0.5 * (left.powi(2) + right.powi(2)) + mass * g * (yl + yr),
    constraint(guide: xl * xb + yl * yb == 0.0),
    constraint(axle: (xl - xr).powi(2) + (yl - yr).powi(2) == l.powi(2)),
)]
pub struct CarAxis {
    /// Twice the mass of a wheel over `eps²`.
    pub m: f64,
    /// Smallness of the mass.
    pub eps: f64,
    /// Length of the axle, and of the line between the feet of the springs.
    pub l: f64,
    /// Rest length of the springs.
    pub l0: f64,
    /// Height of the bumps.
    pub r: f64,
    /// Angular frequency of the road.
    pub w: f64,
    /// Gravitational acceleration.
    pub g: f64,
}

impl CarAxis {
    /// The parameters of the test set.
    pub const STANDARD: Self = Self { m: 10.0, eps: 0.01, l: 1.0, l0: 0.5, r: 0.1, w: 10.0, g: 1.0 };

    /// Upright, moving to the left (of the standard axis).
    pub const fn standard_start(&self) -> Start<4> {
        Start { q: [0.0, 0.5, 1.0, 0.5], v: [-0.5, 0.0, -0.5, 0.0] }
    }
}

impl Scene for CarAxis {
    const NAME: &'static str = "car_axis";
    const SUMMARY: &'static str = "A rigid axle on two springs, whose right end follows a bumpy road.";
    const ORIGIN: &'static str = "Test Set for IVP Solvers (Mazzia & Magherini), caraxis";
    const HORIZON: f64 = 3.0;
    const CONSERVES_ENERGY: bool = false;

    fn standard() -> Self {
        Self::STANDARD
    }

    fn standard_motion(&self) -> ([f64; 4], [f64; 4]) {
        let Start { q, v } = self.standard_start();
        (q, v)
    }

    fn reference() -> Reference<Self> {
        Reference {
            origin: ReferenceOrigin::Certified,
            q: [0.049345578427524094, 0.4969894602300081, 1.0417425248854262, 0.3739110272653658],
            v: [-0.07705836840359208, 0.007446866592068417, 0.017556815753541736, 0.7703410437796011],
        }
    }
}
