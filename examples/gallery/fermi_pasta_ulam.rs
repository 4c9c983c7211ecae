//! Fermi-Pasta-Ulam-Tsingou chain: six unit masses in a line between walls, three stiff harmonic springs between four soft
//! quartic ones.
//!
//! Coordinates are those of the stiff springs: scaled displacements `x` of their centres and scaled expansions `y`. The energy of each
//! stiff spring, `½ ẏ² + ½ ω² y²`, is exchanged with the others over times of order `ω`, while their sum stays within `O(1/ω)` over very
//! long times: an adiabatic invariant (Hairer, Lubich, Wanner, Geometric Numerical Integration, sec. I.5.1 and ch. XIII). Energy is
//! conserved.

use evi_core::prelude::*;

use crate::Start;

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
