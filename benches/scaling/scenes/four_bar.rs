//! Windows of four-bar linkages side by side: 41 upright rods on the ground, each joined to the next on top. One degree of freedom, and whenever the
//! uprights lie flat all 81 constraints are dependent. IFToMM's benchmark: M. González, D. Dopico, U. Lugrís, J. Cuadrado, *A benchmarking system
//! for MBS simulation software*, Multibody System Dynamics 16 (2006) 179.

use evi_core::prelude::*;
use evi_examples::GRAVITY;

use crate::specimen::Specimen;

/// Windows.
const N: usize = 40;
/// Moving joints.
const JOINTS: usize = 41;

/// Uniform rods of mass `m` and length `l`; the kinetic energy of one with the ends `a`, `b` is `m (|ȧ|² + ȧ·ḃ + |ḃ|²)/6`.
#[derive(MechanicalSystem, Clone, Debug)]
#[evi(
    coordinates(b: [JOINTS, 2]),
    kinetic = m / 6.0 * (sum(0..JOINTS, |i| der(b[i]).norm_squared())
            + sum(0..N, |i| der(b[i]).norm_squared() + der(b[i]).dot(der(b[i + 1])) + der(b[i + 1]).norm_squared())),
    potential = 0.5 * m * g * (sum(0..JOINTS, |i| b[i][1]) + sum(0..N, |i| b[i][1] + b[i + 1][1])),
    constraint(upright[i in 0..JOINTS]: (b[i][0] - l * i).powi(2) + b[i][1].powi(2) == l.powi(2)),
    constraint(coupler[i in 0..N]: (b[i + 1] - b[i]).norm_squared() == l.powi(2)),
)]
pub(crate) struct FourBars {
    m: f64,
    l: f64,
    g: f64,
}

/// Upright, moving to the right with 1 m/s, as in the benchmark.
pub(crate) fn specimen() -> Specimen<FourBars> {
    let system = FourBars { m: 1.0, l: 1.0, g: GRAVITY };
    let q = (0..JOINTS).flat_map(|i| [i as f64, 1.0]).collect();
    let v = (0..JOINTS).flat_map(|_| [1.0, 0.0]).collect();
    Specimen::moving("four_bars", N, 1.0, system, q, v)
}
