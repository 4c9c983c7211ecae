//! Steps as an expert would write them for one scene alone: the measure of what a generated step costs.
//!
//! In: a scene of the gallery, a start and a step size. Out: the midpoint step (for constraints, RATTLE) as a map from
//! `(q, v)` to `(q, v)`, converged to round-off of `φ` and, at turning points too, of `G v`, with its convergence checked; nothing is generic, nothing allocates. Each
//! file uses what its scene permits and no compiler could be asked to know. What depends on the last steps are first guesses
//! only.
//!
//! A trajectory waits for chains of dependent operations, not for their number: guesses and tests stand beside the chain,
//! and velocities are kept times `h`, so that none begins with a multiplication.

mod double_pendulum;
mod double_pendulum_lanes;
mod spherical_pendulum;
mod stiff_spring_pendulum;

pub use double_pendulum::HandWrittenDoublePendulum;
pub use double_pendulum_lanes::{HandWrittenLanes, advance_all};
pub use spherical_pendulum::HandWrittenSphericalPendulum;
pub use stiff_spring_pendulum::{ClosedFormSpringPendulum, HandWrittenSpringPendulum};

/// A run of a step written by hand.
pub trait HandWritten<const N: usize> {
    /// Takes one step. Returns the number of Newton corrections, or `None` if they did not converge or the end is not finite;
    /// then the run stands where it stood.
    fn advance(&mut self) -> Option<u32>;

    /// Positions, in the scene's coordinates.
    fn q(&self) -> [f64; N];

    /// Velocities.
    fn v(&self) -> [f64; N];
}

/// Corrections after which an iteration is given up.
const MAX_CORRECTIONS: u32 = 30;

/// A motion is slow where the velocities that are removed at the end of a step have more than this fraction of its energy: what rounds them is then not
/// round-off of its velocities, and they are removed once more.
const LARGEST_REST: f64 = 1.0 / 16384.0;

/// The multiplier of the kick at the end of a step, from those of this step and the one before: averages over a step with the weights of its two
/// kicks, they belong to a third and two thirds of it.
#[inline(always)]
fn expected_at_end(multiplier: f64, previous: f64) -> f64 {
    multiplier + (multiplier - previous) * (1.0 / 3.0)
}

/// The value that a cubic through the last four, newest first, predicts.
#[inline(always)]
fn extrapolated([newest, second, third, oldest]: [f64; 4]) -> f64 {
    4.0 * (newest + third) - 6.0 * second - oldest
}

#[inline(always)]
fn dot<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    let mut sum = a[0] * b[0];
    for i in 1..N {
        sum += a[i] * b[i];
    }
    sum
}

#[inline(always)]
fn sum<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    core::array::from_fn(|i| a[i] + b[i])
}

#[inline(always)]
fn difference<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    core::array::from_fn(|i| a[i] - b[i])
}

#[inline(always)]
fn times<const N: usize>(factor: f64, a: [f64; N]) -> [f64; N] {
    a.map(|x| factor * x)
}

/// Whether every number is: a sum is finite only if all of its terms are.
#[inline(always)]
fn are_finite<const N: usize, const K: usize>(vectors: [[f64; N]; K]) -> bool {
    vectors.as_flattened().iter().sum::<f64>().is_finite()
}
