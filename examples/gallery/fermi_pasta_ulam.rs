//! Fermi-Pasta-Ulam-Tsingou chain: six unit masses in a line between walls, three stiff harmonic springs between four soft
//! quartic ones.
//!
//! Coordinates are those of the stiff springs: scaled displacements `x` of their centres and scaled expansions `y`. The energy of each
//! stiff spring, `½ ẏ² + ½ ω² y²`, is exchanged with the others over times of order `ω`, while their sum stays within `O(1/ω)` over very
//! long times: an adiabatic invariant (Hairer, Lubich, Wanner, Geometric Numerical Integration, sec. I.5.1 and ch. XIII). Energy is
//! conserved.

use evi_core::prelude::*;

use crate::{Reference, ReferenceOrigin, Scene, Start};

/// Three stiff springs; unit masses, time in units of a slow oscillation.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x1, x2, x3, y1, y2, y3),
    kinetic   = 0.5 * (der(x1).powi(2) + der(x2).powi(2) + der(x3).powi(2))
              + 0.5 * (der(y1).powi(2) + der(y2).powi(2) + der(y3).powi(2)),
    potential = 0.5 * omega.powi(2) * (y1.powi(2) + y2.powi(2) + y3.powi(2))
              + 0.25 * ((x1 - y1).powi(4) + (x2 - y2 - x1 - y1).powi(4)
                      + (x3 - y3 - x2 - y2).powi(4) + (x3 + y3).powi(4)),
)]
pub struct FermiPastaUlam {
    /// Frequency of the stiff springs.
    pub omega: f64,
}

impl FermiPastaUlam {
    /// The frequency of the literature, 50.
    pub const STANDARD: Self = Self { omega: 50.0 };

    /// One stiff spring excited, with as much energy as the slow motion.
    pub fn one_spring_excited(&self) -> Start<6> {
        Start { q: [1.0, 0.0, 0.0, 1.0 / self.omega, 0.0, 0.0], v: [1.0, 0.0, 0.0, 1.0, 0.0, 0.0] }
    }

    /// The stiffness of the springs alone, for [`Evi::stiffness`].
    pub fn stiff_springs(&self) -> [[f64; 6]; 6] {
        let stiffness =
            |row: usize, col: usize| if row == col && row >= 3 { self.omega.powi(2) } else { 0.0 };
        core::array::from_fn(|row| core::array::from_fn(|col| stiffness(row, col)))
    }

    /// The energy of each stiff spring.
    pub fn oscillatory_energies(&self, q: &[f64; 6], v: &[f64; 6]) -> [f64; 3] {
        core::array::from_fn(|i| 0.5 * (v[3 + i].powi(2) + (self.omega * q[3 + i]).powi(2)))
    }
}

impl Scene for FermiPastaUlam {
    const NAME: &'static str = "fermi_pasta_ulam";
    const SUMMARY: &'static str =
        "Six masses between walls on stiff harmonic and soft quartic springs, one stiff spring excited.";
    const ORIGIN: &'static str = "Hairer, Lubich, Wanner, Geometric Numerical Integration (2006), sec. I.5.1";
    const HORIZON: f64 = 10.0;
    const CONSERVES_ENERGY: bool = true;

    fn standard() -> Self {
        Self::STANDARD
    }

    fn standard_motion(&self) -> ([f64; 6], [f64; 6]) {
        let Start { q, v } = self.one_spring_excited();
        (q, v)
    }

    fn reference() -> Reference<Self> {
        Reference {
            origin: ReferenceOrigin::Certified,
            q: [
                1.042057637102509,
                0.24363557036319108,
                -0.10636043796464913,
                -0.02755793120125174,
                -0.0005927177946675772,
                0.0003950540596100755,
            ],
            v: [
                0.8973233890558256,
                -0.615417550566789,
                -0.1287070270742707,
                -0.11632415447804959,
                0.22468371856386707,
                0.002549069486236396,
            ],
        }
    }

    fn equilibrium(&self) -> Option<[f64; 6]> {
        Some([0.0; 6])
    }
}
