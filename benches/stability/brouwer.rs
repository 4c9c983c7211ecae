//! Brouwer's law: round-off in the energy, as the difference from the same method in octuple precision.
//!
//! The midpoint member on the spherical pendulum has a step in closed form: the end `q₁ = q₀ + h v½` depends on the multiplier linearly, the
//! sphere makes a quadratic equation of it. Written once more in numbers with 71 digits, it has no round-off; what is between both is the
//! round-off of the steps. Unbiased roundings make a random walk of it, `√N`; a bias would make `N`.

use evi_benches::comparison::methods;
use evi_benches::octuple::Octuple;
use evi_core::comparison::Solver;
use evi_core::scalar::Scalar;
use evi_examples::{SphericalPendulum, Start};

use crate::check::Snapshot;
use crate::observation::Observation;
use crate::rows::{Effort, Finding, Planned};
use crate::specimen::{Experiment, Specimen};
use crate::theory::{Figure, Theory};
use crate::verdict::Kind;

const H: f64 = 0.01;
const BLOCKS: usize = 64;
/// Motions that differ in their amplitudes, so that their roundings are independent.
const AMPLITUDES: [f64; 8] = [1.0, 1.013, 1.029, 1.041, 1.057, 1.071, 1.089, 1.097];

/// Uncompensated and compensated steps.
pub(crate) fn rows(case: &'static str, effort: Effort) -> Vec<Planned> {
    let plan = |method: &'static str| Planned {
        case,
        parameter: "spherical pendulum against octuple precision".into(),
        method,
        work: Box::new(move || finding(method, effort)),
    };
    ["midpoint", "midpoint_compensated"].map(plan).into()
}

fn finding(method: &'static str, effort: Effort) -> Finding {
    let steps_per_block = if effort.quick { 40 } else { 400 };
    let mut seen = Observation::nothing();
    let mut walks = Vec::new();
    for amplitude in AMPLITUDES {
        let (experiment, start) = swing(amplitude);
        let mut solver = match experiment.start(method, H) {
            Ok(solver) => solver,
            Err(failure) => return Finding::broken(failure.to_string()),
        };
        let mut exact = Exact::from(&start);
        let at_start = Snapshot::of(&*solver);
        let mut walk = Vec::new();
        for block in 1..=BLOCKS {
            let end = steps_per_block * block as u64;
            let mut before = Snapshot::of(&*solver);
            let outcome = solver.advance_to(H * (end - 1) as f64).and_then(|()| {
                before = Snapshot::of(&*solver);
                solver.advance_to(H * end as f64)
            });
            if let Err(failure) = outcome {
                return Finding::broken(failure.to_string());
            }
            (0..steps_per_block).for_each(|_| exact.advance());
            let after = Snapshot::of(&*solver);
            seen.samples.push(experiment.look(&at_start, &after, end));
            let residual = experiment.check(method, H, &before, &after, seen.check.steps);
            seen.check.add(end, residual);
            walk.push((energy_of(&*solver) - exact.energy()).rounded());
        }
        walks.push(walk);
        seen.taken += solver.steps();
    }
    seen.steps = seen.taken;
    seen.steps_per_sample = steps_per_block;
    let at = |blocks: usize| root_mean_square(&walks, blocks);
    let largest = at(BLOCKS - 1);
    let exponent = (largest / at(BLOCKS / 16)).log2() / 4.0;
    let mut figures = vec![Figure::seen("round-off of H, J", largest)];
    figures.push(if method == "midpoint" {
        Figure::about("its exponent", exponent, 0.5, 0.5)
    } else {
        Figure::at_most("its exponent", exponent, 0.75)
    });
    let theory = Theory::new("unbiased roundings: √N", &[Kind::Stable]);
    Finding::of(&seen, H, Some(theory), figures)
}

/// Change of the round-off over so many blocks.
fn root_mean_square(walks: &[Vec<f64>], blocks: usize) -> f64 {
    let changes = || walks.iter().flat_map(|walk| walk[blocks..].iter().zip(walk).map(|(b, a)| b - a));
    (changes().map(|change| change * change).sum::<f64>() / changes().count() as f64).sqrt()
}

fn swing(amplitude: f64) -> (Experiment<SphericalPendulum>, Start<3>) {
    let system = SphericalPendulum::UNIT;
    let (sine, cosine) = (0.5 * amplitude).sin_cos();
    let start = Start { q: [sine, 0.0, -cosine], v: [0.0, 1.2, 0.0] };
    let experiment = Experiment::new(system, start.q, start.v, system.g, || {
        vec![methods::midpoint(), methods::midpoint_compensated()]
    });
    (experiment, start)
}

/// `½ |v|² + g z` of a stored state, without the rounding of its evaluation.
fn energy_of(solver: &dyn Solver) -> Octuple {
    let exact = |values: &[f64]| [0, 1, 2].map(|i| Octuple::from_f64(values[i]));
    energy(exact(solver.q()), exact(solver.p()))
}

fn energy(q: [Octuple; 3], p: [Octuple; 3]) -> Octuple {
    Octuple::from_f64(0.5) * dot(p, p) + gravity() * q[2]
}

fn gravity() -> Octuple {
    Octuple::from_f64(SphericalPendulum::UNIT.g)
}

fn dot(a: [Octuple; 3], b: [Octuple; 3]) -> Octuple {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The same motion, on the sphere of its start.
struct Exact {
    q: [Octuple; 3],
    p: [Octuple; 3],
    radius_squared: Octuple,
}

impl Exact {
    fn from(start: &Start<3>) -> Self {
        let [q, p] = [start.q, start.v].map(|values| values.map(Octuple::from_f64));
        Self { q, p, radius_squared: dot(q, q) }
    }

    fn energy(&self) -> Octuple {
        energy(self.q, self.p)
    }

    fn advance(&mut self) {
        let (h, half) = (Octuple::from_f64(H), Octuple::from_f64(0.5 * H));
        let mut kicked = self.p;
        kicked[2] = kicked[2] - half * gravity();
        // q₁ = a − ℓ q₀ with |q₁| = |q₀|: ℓ² − 2βℓ + γ = 0, of which the smaller root is the motion's.
        let a = [0, 1, 2].map(|i| self.q[i] + h * kicked[i]);
        let beta = dot(a, self.q) / self.radius_squared;
        let gamma = (dot(a, a) - self.radius_squared) / self.radius_squared;
        let root = (beta * beta - gamma).sqrt();
        let impulse = gamma / (beta + root);
        let q = [0, 1, 2].map(|i| a[i] - impulse * self.q[i]);
        let mut p = [0, 1, 2].map(|i| (q[i] - self.q[i]) / h);
        p[2] = p[2] - half * gravity();
        let normal = dot(p, q) / self.radius_squared;
        self.p = [0, 1, 2].map(|i| p[i] - normal * q[i]);
        self.q = q;
    }
}
