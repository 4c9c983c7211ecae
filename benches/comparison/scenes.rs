//! Scenes with their types erased: solvers to start, and states to judge.

use evi_core::array::Array;
use evi_core::comparison::{Failure, Solver};
use evi_core::mechanics::Mechanics;
use evi_examples::{ReferenceOrigin, Scene, Visitor};

use super::measure::Outcome;
use super::methods::{self, Method, MethodFacts};
use super::{Motion, Refusal};
use crate::external::{HeyokaRow, PeerError, heyoka};

/// A scene of the gallery, with every method.
pub trait AnyScene {
    /// What there is to say about it.
    fn facts(&self) -> SceneFacts;

    /// The methods, in the order in which they are counted.
    fn methods(&self) -> Vec<MethodFacts>;

    /// A solver at the start of the standard motion, by the method of that number, with a step size or tolerance.
    ///
    /// # Errors
    /// Why the method does not start on this scene.
    fn start(&self, method: usize, resolution: f64) -> Result<Box<dyn Solver>, Failure>;

    /// Runs of a method on [`Path::Program`](super::methods::Path::Program), each with its tolerance.
    ///
    /// # Errors
    /// Why there are none.
    fn runs_of_program(&self, tolerances: &[f64]) -> Result<Vec<(f64, Outcome)>, Failure>;

    /// By how much the solver violates what the motion keeps.
    fn deviation(&self, solver: &dyn Solver) -> Deviation;

    /// Distance of the solver, at the horizon, from the end of the standard motion.
    fn distance_from_reference(&self, solver: &dyn Solver) -> Distance;
}

/// What there is to say about a scene.
#[derive(Clone, Debug)]
pub struct SceneFacts {
    /// Name on the command line and in files.
    pub name: &'static str,
    /// One sentence of physics.
    pub summary: &'static str,
    /// Where its equations come from.
    pub origin: &'static str,
    /// Number of coordinates.
    pub n_coordinates: usize,
    /// Number of constraints.
    pub n_constraints: usize,
    /// Duration of the standard motion.
    pub horizon: f64,
    /// Whether energy is conserved.
    pub conserves_energy: bool,
    /// Names of the conserved momenta.
    pub momenta: Vec<&'static str>,
    /// How the end of the standard motion is known.
    pub reference: ReferenceOrigin,
    /// Length `‖q‖` of the configuration at the end.
    pub size: f64,
}

/// By how much a state violates what the motion keeps; `None` where the motion keeps no such thing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deviation {
    /// `|H − H₀|`.
    pub energy: Option<f64>,
    /// Largest `|φ|`, in the units of the constraints.
    pub constraint: Option<f64>,
    /// Largest `|G v + ∂φ/∂t|` relative to its terms.
    pub hidden_constraint: Option<f64>,
    /// Largest change of a conserved momentum.
    pub momentum: Option<f64>,
}

impl Deviation {
    /// The larger of both, kind by kind.
    #[must_use]
    pub fn or_larger(self, other: Self) -> Self {
        let larger = |a: Option<f64>, b: Option<f64>| a.zip(b).map(|(a, b)| larger(a, b)).or(a).or(b);
        Self {
            energy: larger(self.energy, other.energy),
            constraint: larger(self.constraint, other.constraint),
            hidden_constraint: larger(self.hidden_constraint, other.hidden_constraint),
            momentum: larger(self.momentum, other.momentum),
        }
    }
}

/// How far from the end of the standard motion.
#[derive(Clone, Copy, Debug)]
pub struct Distance {
    /// `‖q − q*‖`, Euclidean over all coordinates.
    pub position: f64,
    /// `|H − H*|`.
    pub energy: f64,
}

/// The scenes of the gallery.
pub fn all() -> Vec<Box<dyn AnyScene>> {
    struct Gather(Vec<Box<dyn AnyScene>>);
    impl Visitor for Gather {
        fn visit<S: Scene>(&mut self) {
            self.0.push(Box::new(Typed::<S>::new()));
        }
    }
    let mut gather = Gather(Vec::new());
    evi_examples::visit_all(&mut gather);
    gather.0
}

struct Typed<S: Scene> {
    motion: Motion<S>,
    mechanics: Mechanics<S>,
    methods: Vec<Method<S>>,
    start_energy: f64,
    start_momenta: Vec<f64>,
}

impl<S: Scene> Typed<S> {
    fn new() -> Self {
        let motion = Motion::<S>::standard();
        let Motion { system, q, v, .. } = &motion;
        let mechanics = Mechanics::new(system);
        let p = mechanics.momentum_at(0.0, q, v);
        let start_energy = mechanics.energy_at(0.0, q, v);
        let start_momenta =
            S::MOMENTA.iter().map(|momentum| (momentum.value)(system, q.as_ref(), p.as_ref())).collect();
        Self { motion, mechanics, methods: methods::all(), start_energy, start_momenta }
    }
}

impl<S: Scene> AnyScene for Typed<S> {
    fn facts(&self) -> SceneFacts {
        let reference = S::reference();
        SceneFacts {
            name: S::NAME,
            summary: S::SUMMARY,
            origin: S::ORIGIN,
            n_coordinates: S::N_COORDINATES,
            n_constraints: S::N_CONSTRAINTS,
            horizon: S::HORIZON,
            conserves_energy: S::CONSERVES_ENERGY,
            momenta: S::MOMENTA.iter().map(|momentum| momentum.name).collect(),
            reference: reference.origin,
            size: distance(reference.q.as_ref(), &vec![0.0; S::N_COORDINATES]),
        }
    }

    fn methods(&self) -> Vec<MethodFacts> {
        self.methods.iter().map(|method| method.facts).collect()
    }

    fn start(&self, method: usize, resolution: f64) -> Result<Box<dyn Solver>, Failure> {
        (self.methods[method].start)(&self.motion, resolution)
    }

    fn runs_of_program(&self, tolerances: &[f64]) -> Result<Vec<(f64, Outcome)>, Failure> {
        let Motion { system, q, v, .. } = &self.motion;
        let start = (q.as_ref(), v.as_ref());
        let rows = heyoka(S::NAME, system, start, S::HORIZON, tolerances, REPETITIONS).map_err(refused)?;
        let outcome = |row: HeyokaRow| {
            let (q, v) = (array::<S>(&row.q), array::<S>(&row.v));
            let p = self.mechanics.momentum_at(S::HORIZON, &q, &v);
            let distance = self.distance(&q, &v);
            let mut deviation = self.deviation_at(S::HORIZON, &q, &v, p.as_ref());
            deviation.energy = deviation.energy.or(Some(distance.energy));
            let outcome = Outcome {
                seconds: 1e-6 * row.microseconds,
                seconds_spread: None,
                steps: row.steps,
                position_error: distance.position,
                deviation,
            };
            (row.tolerance, outcome)
        };
        Ok(rows.into_iter().map(outcome).collect())
    }

    fn deviation(&self, solver: &dyn Solver) -> Deviation {
        self.deviation_at(solver.t(), &array::<S>(solver.q()), &array::<S>(solver.v()), solver.p())
    }

    fn distance_from_reference(&self, solver: &dyn Solver) -> Distance {
        self.distance(&array::<S>(solver.q()), &array::<S>(solver.v()))
    }
}

/// Repetitions of a program's runs, of which the fastest counts.
const REPETITIONS: u32 = 20;

/// A program that is not there is no failure of the comparison.
fn refused(error: PeerError) -> Failure {
    match error {
        PeerError::NotInstalled { .. } | PeerError::UnknownScene { .. } => {
            Refusal::NotRun { reason: error.to_string() }.into()
        }
        error => error.into(),
    }
}

impl<S: Scene> Typed<S> {
    fn deviation_at(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
        v: &S::PerCoordinate<f64>,
        p: &[f64],
    ) -> Deviation {
        let momenta = S::MOMENTA.iter().zip(&self.start_momenta);
        let mechanics = &self.mechanics;
        Deviation {
            energy: S::CONSERVES_ENERGY.then(|| (mechanics.energy_at(t, q, v) - self.start_energy).abs()),
            constraint: largest(mechanics.constraint_residual_at(t, q).as_ref().iter().copied()),
            hidden_constraint: largest(
                mechanics.hidden_constraint_residual_at(t, q, v).as_ref().iter().copied(),
            ),
            momentum: largest(
                momenta.map(|(momentum, start)| (momentum.value)(&self.motion.system, q.as_ref(), p) - start),
            ),
        }
    }

    fn distance(&self, q: &S::PerCoordinate<f64>, v: &S::PerCoordinate<f64>) -> Distance {
        let reference = S::reference();
        let energy = |q, v| self.mechanics.energy_at(S::HORIZON, q, v);
        Distance {
            position: distance(q.as_ref(), reference.q.as_ref()),
            energy: (energy(q, v) - energy(&reference.q, &reference.v)).abs(),
        }
    }
}

fn array<S: Scene>(values: &[f64]) -> S::PerCoordinate<f64> {
    Array::from_fn(|i| values[i])
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// Largest magnitude; `None` of nothing.
fn largest(values: impl Iterator<Item = f64>) -> Option<f64> {
    values.map(f64::abs).reduce(larger)
}

/// The larger of two magnitudes; NaN if one is.
fn larger(a: f64, b: f64) -> f64 {
    if a <= b || b.is_nan() { b } else { a }
}
