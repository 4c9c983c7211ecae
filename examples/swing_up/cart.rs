//! A pendulum on a cart, and what its motion costs.

use evi_core::prelude::*;
use evi_core::sensitivity::{Cost, Course, DerivativeError, Design, Gradient, StateGradient};

/// Pendulum on a cart that a force pushes along a rail; the angle is that from the downward vertical; SI units.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x, theta),
    kinetic = 0.5 * (cart + bob) * der(x).powi(2) + bob * l * theta.cos() * der(x) * der(theta)
            + 0.5 * bob * l.powi(2) * der(theta).powi(2),
    potential = -bob * g * l * theta.cos(),
    input(push),
    force(x: push),
)]
pub(crate) struct CartPole {
    cart: f64,
    bob: f64,
    l: f64,
    g: f64,
}

/// Length of the rod.
pub(crate) const LENGTH: f64 = 0.5;
const SYSTEM: CartPole = CartPole { cart: 1.0, bob: 0.3, l: LENGTH, g: 9.81 };
/// Step size; the force is constant over a step.
pub(crate) const H: f64 = 0.02;
pub(crate) const STEPS: u64 = 144;
/// What a squared newton costs per second.
const EFFORT: f64 = 0.05;

fn simulation() -> Simulation<CartPole, Evi<1>> {
    Simulation::new(SYSTEM, Evi::midpoint(H))
}

/// A push to and fro: hanging at rest without any force no small force is better than none, and the gradient is zero.
pub(crate) fn first_guess() -> Vec<f64> {
    (0..STEPS).map(|step| 2.0 * (4.0 * (step as f64 + 0.5) * H).sin()).collect()
}

/// Time, position and velocity of every state.
pub(crate) fn motion(forces: &[f64]) -> Result<Vec<(f64, [f64; 2], [f64; 2])>, DerivativeError> {
    let mut run = simulation().start([0.0; 2], [0.0; 2])?;
    let mut motion = vec![(0.0, *run.state().q(), *run.state().v())];
    for &force in forces {
        run.set_inputs([force]);
        let state = run.advance()?;
        motion.push((state.t(), *state.q(), *state.v()));
    }
    Ok(motion)
}

/// `½ r h Σ u²` for the effort and `w (1 + cos θ + ½ x² + ½ ẋ² + ½ (l θ̇)²)` for the end.
pub(crate) struct SwingUp {
    pub(crate) weight: f64,
}

impl Design for SwingUp {
    type System = CartPole;
    type Scheme = Evi<1>;

    fn simulation(&self, _forces: &[f64]) -> Simulation<CartPole, Evi<1>> {
        simulation()
    }

    fn course(&self, forces: &[f64]) -> Course<CartPole> {
        Course::new([0.0; 2], [0.0; 2], STEPS).with_inputs(forces.iter().map(|&force| [force]).collect())
    }

    fn cost(&self, _forces: &[f64]) -> impl Cost<CartPole> {
        |steps: u64, state: &State<CartPole>, gradient: &mut StateGradient<CartPole>| {
            if steps < STEPS {
                let [force] = *state.inputs();
                gradient.inputs[0] += EFFORT * H * force;
                return 0.5 * EFFORT * H * force * force;
            }
            let ([x, theta], [x_rate, rate]) = (*state.q(), *state.v());
            let weight = self.weight;
            gradient.q[0] += weight * x;
            gradient.q[1] -= weight * theta.sin();
            gradient.v[0] += weight * x_rate;
            gradient.v[1] += weight * LENGTH * LENGTH * rate;
            weight * (1.0 + theta.cos() + 0.5 * (x * x + x_rate * x_rate + (LENGTH * rate).powi(2)))
        }
    }

    fn chain(&self, _forces: &[f64], gradient: &Gradient<CartPole>) -> Vec<f64> {
        gradient.inputs.iter().map(|[by_force]| *by_force).collect()
    }
}
