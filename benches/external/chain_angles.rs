//! The hanging chain as its user would write it for a general solver: equations of motion in angles, derived by hand.
//!
//! With `θ_i` the angle of rod `i` from the downward vertical, equal masses and rods, and `c_ij = N − max(i, j)` point masses that hang below
//! both rods (numbered from 0):
//!
//! ```text
//! Σ_j c_ij cos(θ_i − θ_j) θ̈_j = −Σ_j c_ij sin(θ_i − θ_j) θ̇_j² − (g/l) c_ii sin θ_i
//! ```

use core::f64::consts::FRAC_PI_2;
use std::time::Instant;

use ode_solvers::dop_shared::IntegrationError;
use ode_solvers::{Dop853, OutputType, SVector, System};

use super::dop853::{BETA, LARGEST_FACTOR, MOST_STEPS, NO_STIFFNESS_TEST, SAFETY, SMALLEST_FACTOR};

/// A chain of `N` point masses on rods of length `1/N`; its state `(θ, θ̇)` has `D = 2N` numbers.
struct Angles<const N: usize> {
    /// `g/l`.
    stiffness: f64,
}

impl<const N: usize, const D: usize> System<f64, SVector<f64, D>> for Angles<N> {
    fn system(&self, _t: f64, y: &SVector<f64, D>, slope: &mut SVector<f64, D>) {
        let (angles, rates) = y.as_slice().split_at(N);
        let direction: [(f64, f64); N] = core::array::from_fn(|i| angles[i].sin_cos());
        let below = |i: usize| (N - i) as f64;
        // Of matrix and sums, the upper triangle: `c_ij` is constant along a column of it.
        let mut matrix = [[0.0; N]; N];
        for i in 0..N {
            let (sin_i, cos_i) = direction[i];
            for j in i..N {
                let (sin_j, cos_j) = direction[j];
                matrix[i][j] = below(j) * (cos_i * cos_j + sin_i * sin_j);
            }
        }
        // `Σ_j c_ij (sin, cos)(θ_j) θ̇_j²`: those before `i` hang it as one, those behind it each by itself.
        let pull = |j: usize| [direction[j].0 * rates[j] * rates[j], direction[j].1 * rates[j] * rates[j]];
        let mut before = [0.0; 2];
        let mut behind =
            (0..N).fold([0.0; 2], |sum, j| [sum[0] + below(j) * pull(j)[0], sum[1] + below(j) * pull(j)[1]]);
        let mut accelerations = [0.0; N];
        for i in 0..N {
            let (sin, cos) = direction[i];
            for k in 0..2 {
                before[k] += pull(i)[k];
                behind[k] -= below(i) * pull(i)[k];
            }
            let [sines, cosines] = core::array::from_fn(|k| below(i) * before[k] + behind[k]);
            accelerations[i] = cos * sines - sin * cosines - self.stiffness * below(i) * sin;
        }
        solve(&mut matrix, &mut accelerations);
        slope.as_mut_slice()[..N].copy_from_slice(rates);
        slope.as_mut_slice()[N..].copy_from_slice(&accelerations);
    }
}

/// Elimination of a symmetric positive definite matrix, of which the upper triangle is read, row by row.
fn solve<const N: usize>(matrix: &mut [[f64; N]; N], b: &mut [f64; N]) {
    for j in 0..N {
        let pivots = matrix[j];
        let reciprocal = 1.0 / pivots[j];
        for i in j + 1..N {
            let factor = pivots[i] * reciprocal;
            for k in i..N {
                matrix[i][k] -= factor * pivots[k];
            }
            b[i] -= factor * b[j];
        }
    }
    for i in (0..N).rev() {
        let rest: f64 = (i + 1..N).map(|k| matrix[i][k] * b[k]).sum();
        b[i] = (b[i] - rest) / matrix[i][i];
    }
}

/// A run of DOP853 on the chain.
#[derive(Clone, Debug, PartialEq)]
pub struct AnglesRow {
    /// The shortest of the repetitions in microseconds.
    pub microseconds: f64,
    /// Number of steps.
    pub steps: u64,
    /// The places of the point masses at the end: `x₁, y₁, x₂, …`.
    pub q: Vec<f64>,
}

/// Runs DOP853 on a chain of 20 point masses `1/20` on rods `1/20`, at rest from the horizontal to `t`, with `tolerance` both absolute and relative.
///
/// # Errors
/// What the solver says.
pub fn dop853_chain_20(
    gravity: f64,
    t: f64,
    tolerance: f64,
    repetitions: u32,
) -> Result<AnglesRow, IntegrationError> {
    const N: usize = 20;
    const D: usize = 2 * N;
    let run = || {
        let start = SVector::<f64, D>::from_fn(|i, _| if i < N { FRAC_PI_2 } else { 0.0 });
        let chain = Angles::<N> { stiffness: gravity * N as f64 };
        let mut solver = Dop853::from_param(
            chain,
            0.0,
            t,
            0.0,
            start,
            tolerance,
            tolerance,
            SAFETY,
            BETA,
            SMALLEST_FACTOR,
            LARGEST_FACTOR,
            t,
            0.0,
            MOST_STEPS,
            NO_STIFFNESS_TEST,
            OutputType::Sparse,
        );
        let clock = Instant::now();
        solver.integrate()?;
        let microseconds = 1e6 * clock.elapsed().as_secs_f64();
        let (times, points) = solver.results().get();
        let q = places(points.last().map_or(&[][..], |end| &end.as_slice()[..N]));
        Ok(AnglesRow { microseconds, steps: times.len() as u64 - 1, q })
    };
    let rows = (0..repetitions.max(1)).map(|_| run()).collect::<Result<Vec<AnglesRow>, _>>()?;
    let fastest = rows.into_iter().min_by(|a, b| a.microseconds.total_cmp(&b.microseconds));
    Ok(fastest.expect("a repetition"))
}

/// Where the point masses are.
fn places(angles: &[f64]) -> Vec<f64> {
    let length = 1.0 / angles.len() as f64;
    let mut place = [0.0; 2];
    let next = |angle: &f64| {
        let (sin, cos) = angle.sin_cos();
        place = [place[0] + length * sin, place[1] - length * cos];
        place
    };
    angles.iter().flat_map(next).collect()
}
