//! Hénon & Heiles' potential: a star in the field of a galaxy, two oscillators with a cubic coupling, without constraints.
//!
//! Energy is conserved. Below one twelfth, half the energy of escape, nearly all motions are regular; towards one sixth chaos takes
//! over (Hénon & Heiles, *The applicability of the third integral of motion*, Astron. J. 69 (1964) 73).

use evi_core::prelude::*;

use crate::{Reference, ReferenceOrigin, Scene, Start};

/// A unit mass in the plane of Hénon & Heiles; units of the problem.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * (der(x).powi(2) + der(y).powi(2)),
    potential = 0.5 * (x.powi(2) + y.powi(2)) + coupling * (x.powi(2) * y - y.powi(3) / 3.0),
)]
pub struct HenonHeiles {
    /// Strength of the cubic coupling.
    pub coupling: f64,
}

impl HenonHeiles {
    /// The coupling of the literature, 1.
    pub const STANDARD: Self = Self { coupling: 1.0 };

    /// Across the axis with energy 0.085 (of the standard coupling): a regular motion.
    pub const fn regular(&self) -> Start<2> {
        Start { q: [0.0, 0.1], v: [0.4, 0.0] }
    }
}

impl Scene for HenonHeiles {
    const NAME: &'static str = "henon_heiles";
    const SUMMARY: &'static str =
        "A star in the field of a galaxy, two oscillators with a cubic coupling, on a regular motion.";
    const ORIGIN: &'static str = "Hénon & Heiles, Astron. J. 69 (1964) 73";
    const HORIZON: f64 = 100.0;
    const CONSERVES_ENERGY: bool = true;

    fn standard() -> Self {
        Self::STANDARD
    }

    fn standard_motion(&self) -> ([f64; 2], [f64; 2]) {
        let Start { q, v } = self.regular();
        (q, v)
    }

    fn reference() -> Reference<Self> {
        Reference {
            origin: ReferenceOrigin::Octuple,
            q: [0.09590214648832245, 0.30267980030079245],
            v: [0.2843540209531449, 0.024143324459033704],
        }
    }

    fn equilibrium(&self) -> Option<[f64; 2]> {
        Some([0.0; 2])
    }
}
