//! Lagrange's heavy top in directors: a symmetric body about a fixed point of its axis, under gravity. Its configuration is the rotation
//! with the columns `d₁, d₂, d₃`, nine coordinates with six constraints that keep the columns orthonormal.
//!
//! With the principal values `E` of the Euler tensor `∫ρ X Xᵀ dV` about the fixed point, the kinetic energy is `½ Σ Eᵢ |ḋᵢ|²`, so that the
//! mass matrix is constant and diagonal; moments of inertia are sums of two, `J₁ = E₂ + E₃`. The directors of a rigid body as coordinates:
//! Betsch & Leyendecker, *The discrete null space method for the energy consistent integration of constrained mechanical systems, part II:
//! multibody dynamics*, Int. J. Numer. Meth. Eng. 67 (2006) 499. Energy, the angular momentum about the vertical and, for the two equal
//! values `E₁ = E₂`, the one about the body's axis are conserved.

use evi_core::prelude::*;

use crate::{GRAVITY, Momentum, Reference, ReferenceOrigin, Scene, Start};

/// A symmetric top whose tip is fixed at the origin, z upwards, `d₃` its axis; SI units.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(d1x, d1y, d1z, d2x, d2y, d2z, d3x, d3y, d3z),
    kinetic = 0.5 * across * (der(d1x).powi(2) + der(d1y).powi(2) + der(d1z).powi(2))
            + 0.5 * across * (der(d2x).powi(2) + der(d2y).powi(2) + der(d2z).powi(2))
            + 0.5 * along * (der(d3x).powi(2) + der(d3y).powi(2) + der(d3z).powi(2)),
    potential = m * g * l * d3z,
    constraint(unit1: d1x.powi(2) + d1y.powi(2) + d1z.powi(2) == 1.0),
    constraint(unit2: d2x.powi(2) + d2y.powi(2) + d2z.powi(2) == 1.0),
    constraint(unit3: d3x.powi(2) + d3y.powi(2) + d3z.powi(2) == 1.0),
    constraint(right12: d1x * d2x + d1y * d2y + d1z * d2z == 0.0),
    constraint(right13: d1x * d3x + d1y * d3y + d1z * d3z == 0.0),
    constraint(right23: d2x * d3x + d2y * d3y + d2z * d3z == 0.0),
    observe(spin: d2x * der(d1x) + d2y * der(d1y) + d2z * der(d1z)),
)]
pub struct HeavyTop {
    /// Mass.
    pub m: f64,
    /// Distance of the centre of mass from the tip.
    pub l: f64,
    /// Gravitational acceleration.
    pub g: f64,
    /// Euler's tensor across the axis, half the moment of inertia about it.
    pub across: f64,
    /// Euler's tensor along the axis.
    pub along: f64,
}

impl HeavyTop {
    /// A uniform cone that stands on its tip.
    pub const fn cone(m: f64, height: f64, radius: f64) -> Self {
        Self {
            m,
            l: 0.75 * height,
            g: GRAVITY,
            across: 0.15 * m * radius * radius,
            along: 0.6 * m * height * height,
        }
    }

    /// A cone of 0.7 kg, 10 cm high and wide.
    pub const STANDARD: Self = Self::cone(0.7, 0.1, 0.05);

    /// The axis tilted by `arccos 0.6` from the upward vertical, towards x, spinning about itself with an angular velocity.
    pub const fn tilted(&self, spin: f64) -> Start<9> {
        Start {
            q: [0.6, 0.0, -0.8, 0.0, 1.0, 0.0, 0.8, 0.0, 0.6],
            v: [0.0, spin, 0.0, -0.6 * spin, 0.0, 0.8 * spin, 0.0, 0.0, 0.0],
        }
    }
}

impl Scene for HeavyTop {
    const NAME: &'static str = "heavy_top";
    const SUMMARY: &'static str = "A cone spinning on its tip at 200 rad/s, let go: it nods and precesses; rotation matrix as coordinates.";
    const ORIGIN: &'static str = "Betsch & Leyendecker, Int. J. Numer. Meth. Eng. 67 (2006) 499; numbers of the gallery, on a cone of its size";
    const HORIZON: f64 = 1.0;
    const CONSERVES_ENERGY: bool = true;
    const MOMENTA: &'static [Momentum<Self>] = &[
        Momentum {
            name: "angular momentum about the vertical",
            value: |_, q, p| (0..3).map(|i| q[3 * i] * p[3 * i + 1] - q[3 * i + 1] * p[3 * i]).sum(),
        },
        Momentum {
            name: "angular momentum about the axis",
            value: |_, q, p| (0..3).map(|i| p[i] * q[3 + i] - p[3 + i] * q[i]).sum(),
        },
    ];

    fn standard() -> Self {
        Self::STANDARD
    }

    fn standard_motion(&self) -> ([f64; 9], [f64; 9]) {
        let Start { q, v } = self.tilted(200.0);
        (q, v)
    }

    fn reference() -> Reference<Self> {
        Reference {
            origin: ReferenceOrigin::Octuple,
            q: [
                -0.5635470664204786,
                0.27104725270077645,
                0.7803512611204227,
                -0.8090296674764585,
                -0.3720443320787846,
                -0.4550318803237659,
                0.1669901226773669,
                -0.8877592025833398,
                0.42894976064428625,
            ],
            v: [
                -160.79198839828248,
                -79.79923966869305,
                -88.4018417384374,
                112.97943235879639,
                -55.64493615208601,
                -155.3766506169655,
                4.729975728408711,
                -1.0441813194868876,
                -4.002428629658932,
            ],
        }
    }
}
