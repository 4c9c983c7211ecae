//! The gallery: mechanical scenes with their Lagrangians, standard parameters and starts.
//!
//! Every scene is one file: the derive, one paragraph of physics, parameters and starts that the tests, examples and
//! benchmarks share.

pub mod andrews_squeezer;
pub mod car_axis;
mod chain;
pub mod chain_20;
pub mod chain_5;
pub mod double_pendulum;
pub mod double_pendulum_angles;
pub mod driven_pendulum;
pub mod fermi_pasta_ulam;
pub mod four_bar;
pub mod harmonic_oscillator;
pub mod heavy_top;
pub mod henon_heiles;
pub mod kapitza_pendulum;
pub mod kepler;
pub mod long_chain;
mod loops;
pub mod net;
pub mod pendulum;
pub mod pendulum_cartesian;
mod scene;
pub mod slider_crank;
pub mod spherical_pendulum;
pub mod stiff_spring_pendulum;

pub use andrews_squeezer::AndrewsSqueezer;
pub use car_axis::CarAxis;
pub use chain_5::Chain5;
pub use chain_20::Chain20;
pub use double_pendulum::DoublePendulum;
pub use double_pendulum_angles::DoublePendulumAngles;
pub use driven_pendulum::DrivenPendulum;
pub use fermi_pasta_ulam::FermiPastaUlam;
pub use four_bar::FourBar;
pub use harmonic_oscillator::HarmonicOscillator;
pub use heavy_top::HeavyTop;
pub use henon_heiles::HenonHeiles;
pub use kapitza_pendulum::KapitzaPendulum;
pub use kepler::Kepler;
pub use long_chain::LongChain;
pub use loops::{LoopScene, LoopVisitor, visit_loops};
pub use net::Net;
pub use pendulum::Pendulum;
pub use pendulum_cartesian::PendulumCartesian;
pub use scene::{Momentum, Reference, ReferenceOrigin, Scene, Visitor};
pub use slider_crank::SliderCrank;
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
    visitor.visit::<AndrewsSqueezer>();
    visitor.visit::<CarAxis>();
    visitor.visit::<Chain20>();
    visitor.visit::<Chain5>();
    visitor.visit::<DoublePendulum>();
    visitor.visit::<DoublePendulumAngles>();
    visitor.visit::<DrivenPendulum>();
    visitor.visit::<FermiPastaUlam>();
    visitor.visit::<FourBar>();
    visitor.visit::<HarmonicOscillator>();
    visitor.visit::<HeavyTop>();
    visitor.visit::<HenonHeiles>();
    visitor.visit::<KapitzaPendulum>();
    visitor.visit::<Kepler>();
    visitor.visit::<Pendulum>();
    visitor.visit::<PendulumCartesian>();
    visitor.visit::<SliderCrank>();
    visitor.visit::<SphericalPendulum>();
    visitor.visit::<StiffSpringPendulum>();
}

/// Compiles the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
