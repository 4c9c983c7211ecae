//! Slider-crank mechanism: a crank turns about the origin, a rod joins its pin to a slider on the horizontal axis. Two angles and a
//! place with two loop constraints leave one degree of freedom; the mass matrix depends on the configuration.
//!
//! Crank and rod are uniform bars under gravity. Energy is conserved. The crank turns over and over: at both dead centres the slider
//! stops while the constraints stay independent, since the rod is longer than the crank. Haug, *Computer Aided Kinematics and Dynamics of
//! Mechanical Systems* (Allyn & Bacon 1989); García de Jalón & Bayo, *Kinematic and Dynamic Simulation of Multibody Systems*
//! (Springer 1994), ch. 2.

use evi_core::prelude::*;

use crate::{GRAVITY, Reference, ReferenceOrigin, Scene, Start};

/// Crank, connecting rod and slider in a vertical plane; angles from the horizontal, anticlockwise; SI units.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(crank, rod, slider),
    let centre_x_rate = -r * crank.sin() * der(crank) - 0.5 * l * rod.sin() * der(rod),
    let centre_y_rate = r * crank.cos() * der(crank) + 0.5 * l * rod.cos() * der(rod),
    kinetic = m_crank * (r * der(crank)).powi(2) / 6.0
            + 0.5 * m_rod * (centre_x_rate.powi(2) + centre_y_rate.powi(2)) + m_rod * (l * der(rod)).powi(2) / 24.0
            + 0.5 * m_slider * der(slider).powi(2),
    potential = g * (0.5 * m_crank * r * crank.sin() + m_rod * (r * crank.sin() + 0.5 * l * rod.sin())),
    constraint(along: r * crank.cos() + l * rod.cos() == slider),
    constraint(across: r * crank.sin() + l * rod.sin() == 0.0),
)]
pub struct SliderCrank {
    /// Mass of the crank.
    pub m_crank: f64,
    /// Mass of the connecting rod.
    pub m_rod: f64,
    /// Mass of the slider.
    pub m_slider: f64,
    /// Length of the crank.
    pub r: f64,
    /// Length of the connecting rod.
    pub l: f64,
    /// Gravitational acceleration.
    pub g: f64,
}

impl SliderCrank {
    /// A rod four times as long as the crank.
    pub const STANDARD: Self = Self { m_crank: 1.0, m_rod: 2.0, m_slider: 0.5, r: 0.25, l: 1.0, g: GRAVITY };

    /// Stretched out, the crank turning with an angular velocity.
    pub const fn stretched_out(&self, rate: f64) -> Start<3> {
        Start { q: [0.0, 0.0, self.r + self.l], v: [rate, -self.r * rate / self.l, 0.0] }
    }
}

impl Scene for SliderCrank {
    const NAME: &'static str = "slider_crank";
    const SUMMARY: &'static str = "A crank, a connecting rod and a slider under gravity, three turns.";
    const ORIGIN: &'static str =
        "Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989); numbers of the gallery";
    const HORIZON: f64 = 2.0;
    const CONSERVES_ENERGY: bool = true;

    fn standard() -> Self {
        Self::STANDARD
    }

    /// The crank starts with 15 rad/s; gravity takes it down to 6 rad/s on top.
    fn standard_motion(&self) -> ([f64; 3], [f64; 3]) {
        let Start { q, v } = self.stretched_out(15.0);
        (q, v)
    }

    fn reference() -> Reference<Self> {
        Reference {
            origin: ReferenceOrigin::Octuple,
            q: [20.274132506965127, -0.24992597167293956, 1.0053555497602713],
            v: [6.1109488534073755, -0.22972765603172896, -1.5682536710032122],
        }
    }
}
