//! Solvers of other projects behind [`Solver`](evi_core::comparison::Solver), set up as their best users would: the scene's own
//! kernels for the right sides, no output that nobody asked for.
//!
//! A general solver takes `q̇ = v`, `v̇ = a(t, q, v)` with the accelerations of the index-1 equations: constraints are
//! differentiated twice and drift within its tolerance.

mod chain_angles;
mod diffsol;
mod dop853;
mod heyoka;
mod heyoka_batch;
mod index_one;
mod mujoco;
mod python;
mod rapier;

pub use chain_angles::{AnglesRow, dop853_chain_20};
pub use diffsol::{DiffsolError, DiffsolMethod, diffsol};
pub use dop853::{Dop853Error, dop853};
pub use heyoka::{HeyokaRow, heyoka};
pub use heyoka_batch::{BatchRow, heyoka_batch};
pub use mujoco::{MujocoRow, mujoco_chain};
pub use python::PeerError;
pub use rapier::{NotBuilt, rapier_chain};

/// What the error of a step of size `h` may be, in every component `y`: `absolute + relative · |y|`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerances {
    /// Part that scales with the component.
    pub relative: f64,
    /// Part that does not.
    pub absolute: f64,
}

impl Tolerances {
    /// The same number for both.
    pub const fn both(tolerance: f64) -> Self {
        Self { relative: tolerance, absolute: tolerance }
    }

    /// Whether both are finite and positive.
    pub(crate) fn are_sound(&self) -> bool {
        [self.relative, self.absolute].iter().all(|tolerance| tolerance.is_finite() && *tolerance > 0.0)
    }
}
