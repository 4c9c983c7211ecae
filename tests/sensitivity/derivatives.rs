//! The derivatives of a run by everything that it follows from.

use evi_core::integrator::OfRank;
use evi_core::prelude::*;
use evi_core::sensitivity::{
    Course, Differentiable, Differentiate, Direction, ParameterChoice, StateGradient,
};
use evi_examples::{DoublePendulum, HenonHeiles, KapitzaPendulum, Start};
use evi_tests::Random;
use evi_tests::scenes::{
    ChargedSphericalPendulum, DoublePendulumInAngles, MotorisedDoublePendulum, PushedDumbbell,
    RelativisticBead,
};

/// A field of a scene.
type Field<S> = fn(&mut S) -> &mut f64;

const STEPS: u64 = 10;

/// A direction at random, in the space of starts, parameters and inputs.
struct Change {
    q: Vec<f64>,
    v: Vec<f64>,
    parameters: Vec<f64>,
    /// One list per step.
    inputs: Vec<Vec<f64>>,
}

impl Change {
    fn random<S: MechanicalSystem>(random: &mut Random) -> Self {
        let mut numbers = |n: usize| (0..n).map(|_| random.between(-1.0, 1.0)).collect::<Vec<_>>();
        Self {
            q: numbers(S::N_COORDINATES),
            v: numbers(S::N_COORDINATES),
            parameters: numbers(S::PARAMETERS.len()),
            inputs: (0..STEPS).map(|_| numbers(S::N_INPUTS)).collect(),
        }
    }
}

/// Everything that a run of a scene follows from.
struct Case<S, F, const N: usize> {
    system: S,
    scheme: F,
    start: Start<N>,
    /// In the order of [`MechanicalSystem::PARAMETERS`]; none where the scheme refuses to follow them.
    fields: Vec<(&'static str, Field<S>)>,
}

impl<S, F, const N: usize> Case<S, F, N>
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Clone,
    F: Scheme<S, Step: Differentiable<S>> + Clone,
{
    fn inputs(&self, step: u64) -> S::PerInput<f64> {
        evi_core::array::Array::from_fn(|k| 0.4 + (1.3 * step as f64 + k as f64).sin())
    }

    /// `(q, v, p)` at the end of the run that is displaced along `change`.
    fn displaced(&self, change: &Change, by: f64) -> Vec<f64> {
        let mut system = self.system.clone();
        for ((_, field), rate) in self.fields.iter().zip(&change.parameters) {
            *field(&mut system) += by * rate;
        }
        let q = core::array::from_fn(|i| self.start.q[i] + by * change.q[i]);
        let v = core::array::from_fn(|i| self.start.v[i] + by * change.v[i]);
        let mut run =
            Simulation::new(system, self.scheme.clone()).start_projected(0.0, q, v).expect("a start");
        for step in 0..STEPS {
            let mut inputs = self.inputs(step);
            for k in 0..S::N_INPUTS {
                inputs[k] += by * change.inputs[step as usize][k];
            }
            *run.inputs_mut() = inputs;
            run.advance().expect("a step");
        }
        let state = run.state();
        [*state.q(), *state.v(), *state.p()].concat()
    }

    /// The derivative along `change`, by differences of fourth order.
    fn quotient(&self, change: &Change) -> Vec<f64> {
        const BY: f64 = 1e-3;
        let points = [-2.0, -1.0, 1.0, 2.0].map(|times| self.displaced(change, times * BY));
        (0..3 * N)
            .map(|i| (points[0][i] - 8.0 * points[1][i] + 8.0 * points[2][i] - points[3][i]) / (12.0 * BY))
            .collect()
    }

    /// The same by the run's own tangents.
    fn tangent(&self, change: &Change) -> Vec<f64> {
        let mut parameters: S::PerParameter<f64> = evi_core::array::Array::from_fn(|_| 0.0);
        for k in 0..self.fields.len() {
            parameters[k] = change.parameters[k];
        }
        let array = |x: &[f64]| <[f64; N]>::try_from(x).expect("one per coordinate");
        let direction = Direction::of_start(array(&change.q), array(&change.v)).with_parameters(parameters);
        let simulation = Simulation::new(self.system.clone(), self.scheme.clone());
        let mut run =
            simulation.start_with_tangents(self.start.q, self.start.v, &[direction]).expect("a start");
        let mut alone = simulation.start(self.start.q, self.start.v).expect("a start");
        for step in 0..STEPS {
            run.set_inputs(self.inputs(step));
            *alone.inputs_mut() = self.inputs(step);
            let rates: S::PerInput<f64> =
                evi_core::array::Array::from_fn(|k| change.inputs[step as usize][k]);
            run.set_input_rates(0, rates);
            run.advance().expect("a step");
            alone.advance().expect("a step");
        }
        assert!(alone.state() == run.state(), "tangents change the run");
        let tangent = &run.tangents()[0];
        [*tangent.q(), *tangent.v(), *tangent.p()].concat()
    }

    /// What a random cost of all states changes by along `change`: by its gradient, and by the tangents of the states.
    fn forward_and_back(&self, change: &Change, seed: u64) -> [f64; 2] {
        let choice = match self.fields.len() {
            0 => ParameterChoice::none(),
            _ => ParameterChoice::all::<S>(),
        };
        let n_parameters = choice.len();
        // Σ over the states of a·q + b·v + c·p + d·u and half of their squares: of weights that are another at every step.
        let cost = |step: u64, state: &State<S>, gradient: &mut StateGradient<S>| {
            let mut random = Random::new(seed + step);
            let mut sum = 0.0;
            let mut add = |x: &[f64], gradient: &mut [f64]| {
                for (x, gradient) in x.iter().zip(gradient) {
                    let weight = random.between(-1.0, 1.0);
                    sum += weight * (x + 0.5 * x * x);
                    *gradient += weight * (1.0 + x);
                }
            };
            add(state.q(), gradient.q.as_mut());
            add(state.v(), gradient.v.as_mut());
            add(state.p(), gradient.p.as_mut());
            if step < STEPS {
                add(state.inputs().as_ref(), gradient.inputs.as_mut());
            }
            sum
        };
        let simulation = Simulation::new(self.system.clone(), self.scheme.clone());
        let inputs = (0..STEPS).map(|step| self.inputs(step)).collect();
        let course = Course::new(self.start.q, self.start.v, STEPS).with_inputs(inputs).by_parameters(choice);
        let gradient = simulation.gradient_of(&course, &cost).expect("a gradient");
        let alone = simulation.cost_of(&course, &cost).expect("a cost");
        assert_eq!(gradient.cost, alone, "the same sum of the same states");
        let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
        let mut back = dot(&gradient.start.q, &change.q)
            + dot(&gradient.start.v, &change.v)
            + dot(&gradient.start.parameters, &change.parameters[..n_parameters]);
        for (gradient, rates) in gradient.inputs.iter().zip(&change.inputs) {
            back += dot(gradient.as_ref(), rates);
        }

        let mut parameters: S::PerParameter<f64> = evi_core::array::Array::from_fn(|_| 0.0);
        parameters.as_mut()[..n_parameters].copy_from_slice(&change.parameters[..n_parameters]);
        let array = |x: &[f64]| <[f64; N]>::try_from(x).expect("one per coordinate");
        let direction = Direction::of_start(array(&change.q), array(&change.v)).with_parameters(parameters);
        let mut run =
            simulation.start_with_tangents(self.start.q, self.start.v, &[direction]).expect("a start");
        let mut forward = 0.0;
        for step in 0..=STEPS {
            if step < STEPS {
                run.set_inputs(self.inputs(step));
                let rates: S::PerInput<f64> =
                    evi_core::array::Array::from_fn(|k| change.inputs[step as usize][k]);
                run.set_input_rates(0, rates);
            }
            let mut by_state = StateGradient::zero(n_parameters);
            cost(step, run.state(), &mut by_state);
            let tangent = &run.tangents()[0];
            forward +=
                dot(&by_state.q, tangent.q()) + dot(&by_state.v, tangent.v()) + dot(&by_state.p, tangent.p());
            if step < STEPS {
                forward += dot(by_state.inputs.as_ref(), &change.inputs[step as usize]);
                run.advance().expect("a step");
            }
        }
        [forward, back]
    }

    #[track_caller]
    fn check(&self) {
        let named: Vec<_> = self.fields.iter().map(|(name, _)| *name).collect();
        assert!(named.is_empty() || named == S::PARAMETERS, "{named:?}");
        for seed in 0..3 {
            let change = Change::random::<S>(&mut Random::new(seed));
            let (quotient, tangent) = (self.quotient(&change), self.tangent(&change));
            let scale = tangent.iter().fold(0.0, |x: f64, y| x.max(y.abs()));
            assert!(scale > 0.1, "vacuous: {tangent:?}");
            let error = evi_tests::largest_difference(&quotient, &tangent) / scale;
            let [forward, back] = self.forward_and_back(&change, 100 * seed);
            let disagreement = (forward - back).abs() / (1.0 + forward.abs());
            println!(
                "{}: quotient {error:.1e}, back {disagreement:.1e} of {forward:.2}",
                core::panic::Location::caller()
            );
            // Round-off of the states over the displacement, and its fourth power times fifth derivatives: 4e-11. Back, round-off alone: 6e-14.
            assert!(error <= 1e-10, "off by {error:e}: {tangent:?} instead of {quotient:?}");
            assert!(disagreement <= 2e-13, "{back} instead of {forward}");
        }
    }
}

macro_rules! fields {
    ($scene:ty: $($name:ident)*) => {
        vec![$((stringify!($name), (|scene: &mut $scene| &mut scene.$name) as Field<$scene>)),*]
    };
}

fn double_pendulum<F>(scheme: F) -> Case<DoublePendulum, F, 4> {
    let angles = DoublePendulumInAngles::UNEQUAL;
    let start = angles.cartesian([0.9, -0.4], [1.1, 2.3]);
    Case { system: angles.constrained(), scheme, start, fields: fields!(DoublePendulum: m1 m2 l1 l2 g) }
}

fn motorised<F>(scheme: F) -> Case<MotorisedDoublePendulum, F, 2> {
    let (system, start) = (MotorisedDoublePendulum::STANDARD, DoublePendulumInAngles::MODERATE);
    let fields = fields!(MotorisedDoublePendulum: m1 m2 l1 l2 g inner outer torque w);
    Case { system, scheme, start, fields }
}

/// A bead on a sphere that breathes, in a trap that is not quadratic, driven around by a force that has no potential: all that steps with a constant
/// mass can have at their inner points, but for forces on velocities.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(x, y, z),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)) + 0.5 * n * der(z).powi(2),
    potential = m * g * z + 0.25 * k * (x.powi(4) + 2.0 * y.powi(4)) + x * y * z,
    constraint(sphere: x.powi(2) + y.powi(2) + z.powi(2) == (l + a * (w * t).sin()).powi(2)),
    input(push),
    force(x: -c * y + push),
    force(y: 2.0 * c * x),
)]
struct DrivenBead {
    m: f64,
    n: f64,
    g: f64,
    k: f64,
    l: f64,
    a: f64,
    w: f64,
    c: f64,
}

/// A pendulum whose rod is written down twice.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = m * g * y,
    constraint(rod: x.powi(2) + y.powi(2) == l.powi(2)),
    constraint(again: 2.0 * (x.powi(2) + y.powi(2)) == 2.0 * l.powi(2)),
)]
struct HeldTwice {
    m: f64,
    g: f64,
    l: f64,
}

const H: f64 = 0.05;

#[test]
fn constant_mass_and_constraints() {
    double_pendulum(Evi::midpoint(H)).check();
}

#[test]
fn frequencies() {
    double_pendulum(Evi::simpson(H).frequency(3.13)).check();
}

#[test]
fn stages_of_a_composition() {
    double_pendulum(Evi::midpoint(H).composed(Composition::suzuki_4())).check();
}

#[test]
fn mass_that_depends_on_the_configuration_with_forces_that_are_not_symmetric() {
    motorised(Evi::simpson(H)).check();
}

#[test]
fn inner_points_on_constraints() {
    double_pendulum(Galerkin::<3>::new(H)).check();
}

#[test]
fn inner_points_with_a_potential_forces_and_a_constraint_that_moves() {
    let system = DrivenBead { m: 1.3, n: 0.8, g: 9.81, k: 3.0, l: 0.9, a: 0.1, w: 7.0, c: 1.7 };
    let scheme = Galerkin::<4>::new(H);
    let run = Simulation::new(system, scheme).start_projected(0.0, [0.5, 0.4, -0.6], [0.8, -0.5, 0.3]);
    let run = run.expect("a start");
    let start = Start { q: *run.state().q(), v: *run.state().v() };
    let fields = fields!(DrivenBead: m n g k l a w c);
    Case { system, scheme, start, fields: fields.clone() }.check();
    // By Newton's iteration the same steps, and their derivatives from the matrix of all points.
    Case { system, scheme: scheme.by_newton(), start, fields }.check();
}

#[test]
fn inner_points_with_a_mass_that_depends_on_the_configuration_and_forces() {
    motorised(Galerkin::<2>::new(H)).check();
}

#[test]
fn gauss_nodes() {
    motorised(Gauss::<3>::new(H)).check();
}

#[test]
fn kicks_of_a_potential_at_the_ends() {
    let Start { q, v } = HenonHeiles::STANDARD.regular();
    let fields = fields!(HenonHeiles: coupling);
    let scheme = Evi::trapezoid(0.2);
    Case { system: HenonHeiles::STANDARD, scheme, start: Start { q, v }, fields }.check();
}

#[test]
fn a_quadratic_part_integrated_exactly() {
    let hanging = [0.0, -0.9, 0.0, -2.0];
    let fields = Vec::new();
    Case { fields, ..double_pendulum(Evi::trapezoid(H).linearised_at(hanging)) }.check();
    let fields = Vec::new();
    Case { fields, ..double_pendulum(Evi::simpson(H).linearised_at(hanging)) }.check();
}

#[test]
fn a_constraint_that_follows_from_another() {
    let system = OfRank::<HeldTwice, 1>(HeldTwice { m: 1.3, g: 9.81, l: 0.9 });
    let start = Start { q: [0.9 * 0.6, -0.9 * 0.8], v: [0.8, 0.6] };
    let fields: Vec<(_, Field<OfRank<HeldTwice, 1>>)> = HeldTwice::PARAMETERS
        .iter()
        .map(|&name| -> (_, Field<OfRank<HeldTwice, 1>>) {
            match name {
                "m" => (name, |scene| &mut scene.0.m),
                "g" => (name, |scene| &mut scene.0.g),
                _ => (name, |scene| &mut scene.0.l),
            }
        })
        .collect();
    Case { system, scheme: Evi::midpoint(H), start, fields }.check();
}

#[test]
fn gyroscopic_coupling_with_a_constraint() {
    let system = ChargedSphericalPendulum::STANDARD;
    let fields = fields!(ChargedSphericalPendulum: m l g b);
    Case { system, scheme: Evi::simpson(H), start: system.one_radian(), fields }.check();
}

#[test]
fn not_quadratic_in_velocity_with_a_constraint() {
    let start = RelativisticBead::at_angle(1.0, -2.0);
    let fields = fields!(RelativisticBead: m c g);
    Case { system: RelativisticBead::STANDARD, scheme: Evi::midpoint(H), start, fields }.check();
}

#[test]
fn inputs_and_drag_with_a_constraint() {
    let system = PushedDumbbell::STANDARD;
    let fields = fields!(PushedDumbbell: m1 m2 l c1 c2);
    Case { system, scheme: Evi::midpoint(H), start: system.turning(), fields }.check();
}

#[test]
fn a_constraint_that_moves_in_time() {
    let system = KapitzaPendulum { m: 1.3, l: 0.9, g: 9.81, a: 0.1, w: 7.0 };
    let Start { q, v } = kapitza_start(&system);
    let fields = fields!(KapitzaPendulum: m l g a w);
    Case { system, scheme: Evi::midpoint(H), start: Start { q, v }, fields }.check();
}

/// One radian from the downward vertical, with a velocity that the constraint allows.
fn kapitza_start(system: &KapitzaPendulum) -> Start<2> {
    let scheme = Evi::midpoint(H);
    let (sine, cosine) = 1.0_f64.sin_cos();
    let guess = [system.l * sine, system.a - system.l * cosine];
    let run = Simulation::new(*system, scheme).start_projected(0.0, guess, [1.0, 0.5]).expect("a start");
    Start { q: *run.state().q(), v: *run.state().v() }
}
