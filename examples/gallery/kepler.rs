//! Kepler's problem: a body in a plane, drawn to the origin by the inverse square of its distance, without constraints.
//!
//! Energy and angular momentum are conserved. On an ellipse of eccentricity `e` the speed at the near end is `(1 + e)/(1 − e)` times
//! that at the far end, so that a constant step is wasted on most of the way. Hairer, Lubich, Wanner, *Geometric Numerical Integration*
//! (Springer 2006), sec. I.2.

use evi_core::prelude::*;

use crate::{Momentum, Reference, ReferenceOrigin, Scene, Start};

/// A body about a fixed centre at the origin; units of the problem.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = -m * mu / (x.powi(2) + y.powi(2)).sqrt(),
)]
pub struct Kepler {
    /// Mass of the body.
    pub m: f64,
    /// Gravitational parameter of the centre.
    pub mu: f64,
}

impl Kepler {
    /// Semi-axis 1 has period 2π.
    pub const UNIT: Self = Self { m: 1.0, mu: 1.0 };

    /// At the near end of an ellipse with semi-axis 1.
    pub fn near_end(&self, eccentricity: f64) -> Start<2> {
        let speed = (self.mu * (1.0 + eccentricity) / (1.0 - eccentricity)).sqrt();
        Start { q: [1.0 - eccentricity, 0.0], v: [0.0, speed] }
    }
}

impl Scene for Kepler {
    const NAME: &'static str = "kepler";
    const SUMMARY: &'static str =
        "A body on an ellipse of eccentricity 0.6 about a fixed centre, for three periods and a bit.";
    const ORIGIN: &'static str = "Hairer, Lubich, Wanner, Geometric Numerical Integration (2006), sec. I.2";
    const HORIZON: f64 = 20.0;
    const CONSERVES_ENERGY: bool = true;
    const MOMENTA: &'static [Momentum<Self>] =
        &[Momentum { name: "angular momentum", value: |_, q, p| q[0] * p[1] - q[1] * p[0] }];

    fn standard() -> Self {
        Self::UNIT
    }

    fn standard_motion(&self) -> ([f64; 2], [f64; 2]) {
        let Start { q, v } = self.near_end(0.6);
        (q, v)
    }

    /// `x = a (cos E − e)`, `y = a √(1 − e²) sin E` with Kepler's equation `E − e sin E = n t`, for the start as rounded to `f64`.
    fn reference() -> Reference<Self> {
        Reference {
            origin: ReferenceOrigin::ClosedForm,
            q: [-0.7700755784112334, 0.7883448169944256],
            v: [-0.894183731988696, -0.12346176415843607],
        }
    }
}
