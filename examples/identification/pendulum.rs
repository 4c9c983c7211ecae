//! The pendulum, its samples, and their misfit as a function of a run.

use evi_core::prelude::*;
use evi_core::sensitivity::{
    Cost, Course, DerivativeError, Design, Differentiate, Direction, Gradient, ParameterChoice, StateGradient,
};

/// Double pendulum, pivot at the origin, y upwards, whose outer bob a known force pushes to and fro; SI units.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x1, y1, x2, y2),
    kinetic   = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2))
              + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2)),
    potential = g * (m1 * y1 + m2 * y2),
    constraint(rod1: x1.powi(2) + y1.powi(2) == l1.powi(2)),
    constraint(rod2: (x2 - x1).powi(2) + (y2 - y1).powi(2) == l2.powi(2)),
    force(x2: push * (w * t).sin()),
)]
pub(crate) struct PushedPendulum {
    m1: f64,
    m2: f64,
    l1: f64,
    l2: f64,
    g: f64,
    push: f64,
    w: f64,
}

/// What is looked for.
pub(crate) const NAMES: [&str; 4] = ["m1", "m2", "l1", "l2"];
/// What the samples are made with.
pub(crate) const TRUTH: [f64; 4] = [1.3, 0.7, 0.9, 1.1];
/// Angles from the downward vertical at the start, at rest.
const ANGLES: [f64; 2] = [0.7, -0.4];
const H: f64 = 0.01;
const STEPS_PER_SAMPLE: u64 = 2;
const SAMPLES: u64 = 200;

/// The pendulum of four parameters, and where it starts.
fn simulation(&[m1, m2, l1, l2]: &[f64; 4]) -> Simulation<PushedPendulum, Evi<1>> {
    Simulation::new(PushedPendulum { m1, m2, l1, l2, g: 9.81, push: 3.0, w: 4.0 }, Evi::midpoint(H))
}

fn start(&[_, _, l1, l2]: &[f64; 4]) -> [f64; 4] {
    let [(s1, c1), (s2, c2)] = ANGLES.map(f64::sin_cos);
    [l1 * s1, -l1 * c1, l1 * s1 + l2 * s2, -l1 * c1 - l2 * c2]
}

/// The derivatives of the start by the four parameters.
fn start_by_parameters() -> [[f64; 4]; 4] {
    let [(s1, c1), (s2, c2)] = ANGLES.map(f64::sin_cos);
    [[0.0; 4], [0.0; 4], [s1, -c1, s1, -c1], [0.0, 0.0, s2, -c2]]
}

/// Where both bobs were seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) t: f64,
    pub(crate) q: [f64; 4],
}

/// Times and positions of the motion with these parameters.
pub(crate) fn paths(parameters: &[f64; 4]) -> Result<Vec<(f64, [f64; 4])>, DerivativeError> {
    let mut run = simulation(parameters).start(start(parameters), [0.0; 4])?;
    let mut paths = vec![(0.0, *run.state().q())];
    for _ in 0..SAMPLES * STEPS_PER_SAMPLE {
        let state = run.advance()?;
        paths.push((state.t(), *state.q()));
    }
    Ok(paths)
}

/// Samples of the true motion, with normal noise.
pub(crate) fn noisy_samples(noise: f64, seed: u64) -> Result<Vec<Sample>, DerivativeError> {
    let mut random = Random(seed);
    let seen = paths(&TRUTH)?.into_iter().skip(1).skip(STEPS_PER_SAMPLE as usize - 1);
    let noisy = |(t, q): (f64, [f64; 4])| Sample { t, q: q.map(|x| x + noise * random.normal()) };
    Ok(seen.step_by(STEPS_PER_SAMPLE as usize).map(noisy).collect())
}

/// Half the mean of the squares of what lies between samples and motion: of the size of one, as a first step along its gradient then is.
pub(crate) struct Fit {
    pub(crate) samples: Vec<Sample>,
}

/// Numbers are logarithms of the parameters, which so stay positive.
fn parameters(x: &[f64]) -> [f64; 4] {
    core::array::from_fn(|k| x[k].exp())
}

impl Design for Fit {
    type System = PushedPendulum;
    type Scheme = Evi<1>;

    fn simulation(&self, x: &[f64]) -> Simulation<PushedPendulum, Evi<1>> {
        simulation(&parameters(x))
    }

    fn course(&self, x: &[f64]) -> Course<PushedPendulum> {
        let choice = ParameterChoice::of::<PushedPendulum>(&NAMES).unwrap_or_default();
        Course::new(start(&parameters(x)), [0.0; 4], SAMPLES * STEPS_PER_SAMPLE).by_parameters(choice)
    }

    fn cost(&self, _x: &[f64]) -> impl Cost<PushedPendulum> {
        |steps: u64, state: &State<PushedPendulum>, gradient: &mut StateGradient<PushedPendulum>| {
            if steps == 0 || !steps.is_multiple_of(STEPS_PER_SAMPLE) {
                return 0.0;
            }
            let sample = &self.samples[(steps / STEPS_PER_SAMPLE - 1) as usize];
            let weight = 1.0 / self.samples.len() as f64;
            let mut sum = 0.0;
            for i in 0..4 {
                let misfit = state.q()[i] - sample.q[i];
                sum += 0.5 * weight * misfit * misfit;
                gradient.q[i] += weight * misfit;
            }
            sum
        }
    }

    fn chain(&self, x: &[f64], gradient: &Gradient<PushedPendulum>) -> Vec<f64> {
        let by_start = start_by_parameters();
        let by_parameter = |k: usize| {
            let through_start: f64 = (0..4).map(|i| gradient.start.q[i] * by_start[k][i]).sum();
            gradient.start.parameters[k] + through_start
        };
        parameters(x).iter().enumerate().map(|(k, parameter)| parameter * by_parameter(k)).collect()
    }
}

/// Standard errors of the four parameters: roots of the diagonal of `σ² (JᵀJ)⁻¹`, where `J` holds the derivatives of all samples by them.
pub(crate) fn standard_errors(parameters: &[f64; 4], noise: f64) -> Result<[f64; 4], DerivativeError> {
    let simulation = simulation(parameters);
    let directions = (0..4)
        .map(|k| {
            let changes = core::array::from_fn(|i| if i == k { 1.0 } else { 0.0 });
            Direction::of_start(start_by_parameters()[k], [0.0; 4]).with_parameters(changes)
        })
        .collect::<Vec<Direction<PushedPendulum>>>();
    let mut run = simulation.start_with_tangents(start(parameters), [0.0; 4], &directions)?;
    let mut normal = [[0.0; 4]; 4];
    for _ in 0..SAMPLES {
        for _ in 0..STEPS_PER_SAMPLE {
            run.advance()?;
        }
        let moved: [_; 4] = core::array::from_fn(|k| run.tangents()[k].q());
        for row in 0..4 {
            for col in 0..4 {
                normal[row][col] += (0..4).map(|i| moved[row][i] * moved[col][i]).sum::<f64>();
            }
        }
    }
    let inverse = inverse(normal);
    Ok(core::array::from_fn(|k| noise * inverse[k][k].sqrt()))
}

/// The inverse of a positive definite matrix, by Gauss and Jordan's method.
fn inverse<const N: usize>(mut a: [[f64; N]; N]) -> [[f64; N]; N] {
    let mut inverse = [[0.0; N]; N];
    for k in 0..N {
        inverse[k][k] = 1.0;
    }
    for k in 0..N {
        let pivot = 1.0 / a[k][k];
        a[k] = a[k].map(|x| x * pivot);
        inverse[k] = inverse[k].map(|x| x * pivot);
        for row in (0..N).filter(|&row| row != k) {
            let factor = a[row][k];
            for col in 0..N {
                a[row][col] -= factor * a[k][col];
                inverse[row][col] -= factor * inverse[k][col];
            }
        }
    }
    inverse
}

/// The same noise on every machine.
struct Random(u64);

impl Random {
    /// Between 0 and 1 (SplitMix64: Steele, Lea, Flood, OOPSLA 2014).
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Of mean 0 and variance 1 (Box & Muller 1958).
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}
