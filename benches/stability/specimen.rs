//! What is tried: a motion with every method that is asked of it, its type erased.

use evi_benches::comparison::methods::{Method, MethodFacts, Resolution};
use evi_benches::comparison::{Motion, Subject};
use evi_core::array::Array;
use evi_core::comparison::{Failure, Solver};
use evi_core::mechanics::Mechanics;
use evi_core::scheme::Frequency;
use evi_core::system::MechanicalSystem;
use evi_examples::Momentum;

use crate::action::{Action, Equations, GAUSS_4, LOBATTO_4, MIDPOINT, SIMPSON, TRAPEZOID};
use crate::check::{self, Promise, Residual, Snapshot, Velocity, norm};
use crate::observation::Sample;
use crate::tangent::Tangents;

/// Relative and absolute tolerance of methods that choose their steps.
const TOLERANCE: f64 = 1e-9;

/// A system whose motions can go to the thread of their row.
pub(crate) trait Portable: Subject + MechanicalSystem<PerCoordinate<f64>: Send + Sync> {}

impl<S: Subject + MechanicalSystem<PerCoordinate<f64>: Send + Sync>> Portable for S {}

/// A motion with its type erased.
pub(crate) trait Specimen: Send + Sync {
    /// The methods that are tried on it.
    fn methods(&self) -> Vec<MethodFacts>;

    /// A solver at its start, with steps of size `h`, or with a tolerance where the method chooses its steps.
    fn start(&self, method: &str, h: f64) -> Result<Box<dyn Solver>, Failure>;

    /// What a state shows, beside the start.
    fn look(&self, start: &Snapshot, state: &Snapshot, step: u64) -> Sample;

    /// The worst residual of a step, after so many others were checked.
    fn check(&self, method: &str, h: f64, before: &Snapshot, after: &Snapshot, checked: u64) -> Residual;

    /// Largest `‖q‖ / ‖q₀‖` of the motion.
    fn largest_size(&self) -> f64;

    /// Frequency of the fastest small oscillation about the equilibrium, if one is known.
    fn fastest_frequency(&self) -> Option<f64>;

    /// The same system and methods from another state.
    fn restarted(&self, state: &Snapshot) -> Box<dyn Specimen>;
}

/// A motion with its type.
#[derive(Clone)]
pub(crate) struct Experiment<S: Portable> {
    pub(crate) motion: Motion<S>,
    /// The energy that the motion exchanges: the unit of energy errors.
    pub(crate) exchanged: f64,
    pub(crate) largest_size: f64,
    /// Sine of the smallest angle between its constraints, 1 of constraints that are well apart.
    pub(crate) smallest_angle: f64,
    pub(crate) momenta: &'static [Momentum<S>],
    pub(crate) methods: fn() -> Vec<Method<S>>,
}

impl<S: Portable> Experiment<S> {
    /// Of a system from `(q, v)` at time 0, with methods and the energy that it exchanges.
    pub(crate) fn new(
        system: S,
        q: impl Into<S::PerCoordinate<f64>>,
        v: impl Into<S::PerCoordinate<f64>>,
        exchanged: f64,
        methods: fn() -> Vec<Method<S>>,
    ) -> Self {
        let motion = Motion { system, q: q.into(), v: v.into(), equilibrium: None, frequency: None };
        Self { motion, exchanged, largest_size: 1.0, smallest_angle: 1.0, momenta: &[], methods }
    }

    pub(crate) fn about(mut self, equilibrium: impl Into<S::PerCoordinate<f64>>) -> Self {
        self.motion.equilibrium = Some(equilibrium.into());
        self
    }

    pub(crate) fn with_frequency(mut self, frequency: impl Into<Frequency>) -> Self {
        self.motion.frequency = Some(frequency.into());
        self
    }

    pub(crate) fn keeping(self, momenta: &'static [Momentum<S>]) -> Self {
        Self { momenta, ..self }
    }

    /// Of a motion that goes so many times as far as it begins.
    pub(crate) fn reaching(self, largest_size: f64) -> Self {
        Self { largest_size, ..self }
    }

    /// With constraints that are nearly dependent.
    pub(crate) fn nearly_dependent(self, smallest_angle: f64) -> Self {
        Self { smallest_angle, ..self }
    }

    fn promise(&self, method: &str) -> Promise {
        let of_ends = |nodes, frequency| Equations::OfEnds(Action { nodes, frequency });
        let straight = |nodes| Some(of_ends(nodes, Frequency::ZERO));
        let curved = |nodes| self.motion.frequency.map(|frequency| of_ends(nodes, frequency));
        let action = match method {
            "midpoint" | "midpoint_compensated" | "midpoint_of_rank" => straight(MIDPOINT),
            "trapezoid" | "rattle" => straight(TRAPEZOID),
            "simpson" => straight(SIMPSON),
            "midpoint_trig" => curved(MIDPOINT),
            "trapezoid_trig" => curved(TRAPEZOID),
            "simpson_trig" => curved(SIMPSON),
            "galerkin_4" => Some(Equations::OfPoints(&LOBATTO_4)),
            "gauss_4" => Some(Equations::OfPoints(&GAUSS_4)),
            _ => None,
        };
        let is_index_1 = matches!(method, "rk4" | "implicit_midpoint" | "dop853");
        let hidden_constraints = match method {
            "shake" | "generalized_alpha" => Velocity::Free,
            _ if is_index_1 => Velocity::Free,
            "rattle" | "galerkin_4" | "exponential" => Velocity::ProjectedOnce,
            _ => Velocity::Projected,
        };
        // The Gram matrix of the constraints squares their condition; with a stated rank nothing does, and momenta bear it once.
        let conditioning = match method {
            "midpoint_of_rank" => [1.0, 1.0 / self.smallest_angle],
            _ => [self.smallest_angle.powi(-2), 1.0],
        };
        Promise { constraints: !is_index_1, hidden_constraints, conditioning, action }
    }

    fn array(values: &[f64]) -> S::PerCoordinate<f64> {
        Array::from_fn(|i| values[i])
    }
}

impl<S: Portable> Specimen for Experiment<S> {
    fn methods(&self) -> Vec<MethodFacts> {
        (self.methods)().iter().map(|method| method.facts).collect()
    }

    fn start(&self, method: &str, h: f64) -> Result<Box<dyn Solver>, Failure> {
        let method = (self.methods)().into_iter().find(|known| known.facts.name == method);
        let Method { facts, start } = method.expect("a method of this specimen");
        start(&self.motion, if facts.resolution == Resolution::StepSize { h } else { TOLERANCE })
    }

    fn look(&self, start: &Snapshot, state: &Snapshot, step: u64) -> Sample {
        let mechanics = Mechanics::new(&self.motion.system);
        let energy = |at: &Snapshot| mechanics.energy_at(at.t, &Self::array(&at.q), &Self::array(&at.v));
        let tangents = Tangents::at(&self.motion.system, state.t, &state.q);
        let size = norm(&state.q);
        let relative = |value: f64, scale: f64| if value == 0.0 { 0.0 } else { value.abs() / scale };
        let constraint = tangents
            .residuals
            .iter()
            .zip(&tangents.rows)
            .map(|(residual, row)| relative(*residual, norm(row) * size));
        let hidden =
            mechanics.hidden_constraint_residual_at(state.t, &Self::array(&state.q), &Self::array(&state.v));
        let momentum = self.momenta.iter().map(|momentum| {
            let value = |at: &Snapshot| (momentum.value)(&self.motion.system, &at.q, &at.p);
            relative(value(state) - value(start), size * norm(&state.p).max(norm(&start.p)))
        });
        Sample {
            step,
            energy: (energy(state) - energy(start)) / self.exchanged,
            constraint: constraint.fold(0.0, f64::max),
            hidden: hidden.as_ref().iter().copied().fold(0.0, f64::max),
            momentum: momentum.fold(0.0, f64::max),
            size: relative(size, norm(&start.q)),
        }
    }

    fn check(&self, method: &str, h: f64, before: &Snapshot, after: &Snapshot, checked: u64) -> Residual {
        /// To find the points between the ends of a step takes longer than the step: they are looked for in one out of so many.
        const WITH_POINTS: u64 = 4;
        let mut promise = self.promise(method);
        if !checked.is_multiple_of(WITH_POINTS) {
            promise.action = promise.action.filter(|action| matches!(action, Equations::OfEnds(_)));
        }
        check::step(&self.motion.system, &promise, h, before, after)
    }

    fn largest_size(&self) -> f64 {
        self.largest_size
    }

    fn fastest_frequency(&self) -> Option<f64> {
        let equilibrium = self.motion.equilibrium.as_ref()?;
        let linearisation = Mechanics::new(&self.motion.system).linearised_at(equilibrium).ok()?;
        linearisation.squared_frequencies().iter().copied().reduce(f64::max).map(f64::sqrt)
    }

    fn restarted(&self, state: &Snapshot) -> Box<dyn Specimen> {
        let mut other = self.clone();
        (other.motion.q, other.motion.v) = (Self::array(&state.q), Self::array(&state.v));
        Box::new(other)
    }
}
