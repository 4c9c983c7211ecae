//! The gallery: mechanical scenes with their Lagrangians, standard parameters and starts.
//!
//! Every scene is one file: the derive, one paragraph of physics, parameters and starts that the tests, examples and
//! benchmarks share.

pub mod andrews_squeezer;
pub mod car_axis;
pub mod double_pendulum;
pub mod driven_pendulum;
pub mod fermi_pasta_ulam;
pub mod harmonic_oscillator;
pub mod kapitza_pendulum;
pub mod pendulum;
mod scene;
pub mod spherical_pendulum;
pub mod stiff_spring_pendulum;

pub use andrews_squeezer::AndrewsSqueezer;
pub use car_axis::CarAxis;
pub use double_pendulum::DoublePendulum;
pub use driven_pendulum::DrivenPendulum;
pub use fermi_pasta_ulam::FermiPastaUlam;
pub use harmonic_oscillator::HarmonicOscillator;
pub use kapitza_pendulum::KapitzaPendulum;
pub use pendulum::Pendulum;
pub use scene::{Momentum, Reference, ReferenceOrigin, Scene, Visitor};
pub use spherical_pendulum::SphericalPendulum;
pub use stiff_spring_pendulum::StiffSpringPendulum;

/// Standard gravity as in the certified reference solutions, m/s².
pub const GRAVITY: f64 = 9.81;

/// Where a motion begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start<const N: usize> {
    /// Positions.
    pub q: [f64; N],
    /// Velocities.
    pub v: [f64; N],
}

/// Shows the visitor every scene of the gallery, in alphabetical order.
pub fn visit_all(visitor: &mut impl Visitor) {
    visitor.visit::<DoublePendulum>();
}

/// Compiles the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
