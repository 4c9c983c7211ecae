//! Motions with a known end, one for each structure of `L` and `φ`.
//!
//! The ends are certified, or come from extrapolation on accelerations written by hand: numbers that evi-core has no part in,
//! good to round-off.

use evi_core::array::Array;
use evi_core::mechanics::Mechanics;
use evi_core::prelude::*;
use evi_examples::{DoublePendulum, GRAVITY, Pendulum, Reference, Scene, SliderCrank, Start};

use crate::extrapolate_by_hand;
use crate::references::{self, Certified};
use crate::scenes::{
    ChargedParticle, ChargedSphericalPendulum, DampedPendulum, DoublePendulumInAngles, KapitzaPendulum,
    ModulatedPendulum, RelativisticBead,
};

/// A motion with a known end.
pub struct Motion<S> {
    /// The scene.
    pub system: S,
    /// Positions at time 0.
    pub q0: Vec<f64>,
    /// Velocities at time 0.
    pub v0: Vec<f64>,
    /// Time of the end.
    pub t: f64,
    /// Positions at the end.
    pub q: Vec<f64>,
    /// Velocities at the end.
    pub v: Vec<f64>,
    /// Multipliers at the end.
    pub multipliers: Vec<f64>,
    /// Whether `H` is constant.
    pub conserves_energy: bool,
    /// Numbers of steps, each run half as long in its steps as the one before.
    pub steps: [u32; 5],
}

impl<S: MechanicalSystem> Motion<S> {
    /// From `start` to a certified point, in `coarsest` to `16 coarsest` steps.
    pub fn certified<const N: usize>(system: S, start: Start<N>, end: Certified, coarsest: u32) -> Self {
        let Certified { t, q, v, multipliers } = end;
        Self { multipliers: multipliers.to_vec(), ..Self::new(system, start, t, (q, v), coarsest) }
    }

    /// From `start` to positions and velocities that determine the multipliers, in `coarsest` to `16 coarsest` steps.
    pub fn new<const N: usize>(
        system: S,
        start: Start<N>,
        t: f64,
        (q, v): (&[f64], &[f64]),
        coarsest: u32,
    ) -> Self {
        assert!(q.iter().chain(v).all(|x| x.is_finite()), "vacuous reference");
        assert!(q != start.q && v != start.v, "vacuous reference: nothing moves");
        let at_end = Mechanics::new(&system)
            .acceleration(t, &Array::from_fn(|i| q[i]), &Array::from_fn(|i| v[i]))
            .expect("a regular end");
        Self {
            system,
            q0: start.q.to_vec(),
            v0: start.v.to_vec(),
            t,
            q: q.to_vec(),
            v: v.to_vec(),
            multipliers: at_end.multipliers.as_ref().to_vec(),
            conserves_energy: true,
            steps: core::array::from_fn(|i| coarsest << i),
        }
    }

    /// Of a scene that does not conserve its energy.
    #[must_use]
    pub fn without_energy(self) -> Self {
        Self { conserves_energy: false, ..self }
    }
}

/// Steps of the references by hand: halving or doubling them changes the ends by round-off.
const REFERENCE_STEPS: u32 = 100;

/// The double pendulum with unequal parameters, constrained; reference in angles.
fn double_pendulum_from(start: Start<2>, t: f64) -> Motion<DoublePendulum> {
    let angles = DoublePendulumInAngles::UNEQUAL;
    let Start { q, v } = start;
    let (qe, ve) = extrapolate_by_hand(|_, q, v| angles.acceleration(q, v), (q, v), t, REFERENCE_STEPS);
    let end = angles.cartesian(qe, ve);
    Motion::new(angles.constrained(), angles.cartesian(q, v), t, (&end.q, &end.v), 50)
}

/// The same in its angles: the mass depends on the configuration.
fn double_pendulum_in_angles_from(start: Start<2>, t: f64) -> Motion<DoublePendulumInAngles> {
    let system = DoublePendulumInAngles::UNEQUAL;
    let acceleration = |_, q: &[f64; 2], v: &[f64; 2]| system.acceleration(q, v);
    let (q, v) = extrapolate_by_hand(acceleration, (start.q, start.v), t, REFERENCE_STEPS);
    Motion::new(system, start, t, (&q, &v), 50)
}

/// The constrained double pendulum with unequal parameters.
pub fn double_pendulum() -> Motion<DoublePendulum> {
    double_pendulum_from(DoublePendulumInAngles::MODERATE, 1.0)
}

/// The same on a smaller and longer swing, for methods of high order.
pub fn gentle_double_pendulum() -> Motion<DoublePendulum> {
    double_pendulum_from(DoublePendulumInAngles::GENTLE, 2.0)
}

/// The double pendulum with unequal parameters in its angles: the mass depends on the configuration.
pub fn double_pendulum_in_angles() -> Motion<DoublePendulumInAngles> {
    double_pendulum_in_angles_from(DoublePendulumInAngles::MODERATE, 1.0)
}

/// The same for a longer time, for methods of high order.
pub fn long_double_pendulum_in_angles() -> Motion<DoublePendulumInAngles> {
    double_pendulum_in_angles_from(DoublePendulumInAngles::MODERATE, 3.0)
}

/// The plane pendulum, in its angle.
pub fn pendulum() -> Motion<Pendulum> {
    let system = Pendulum { m: 1.3, l: 0.9, g: GRAVITY };
    let (q, v) = ([1.2], [0.4]);
    let t = 2.0;
    let acceleration = |_, q: &[f64; 1], _: &_| [-system.g / system.l * q[0].sin()];
    let (qe, ve) = extrapolate_by_hand(acceleration, (q, v), t, REFERENCE_STEPS);
    Motion::new(system, Start { q, v }, t, (&qe, &ve), 100)
}

/// Gyroscopic coupling without a constraint.
pub fn charged_particle() -> Motion<ChargedParticle> {
    let system = ChargedParticle { m: 0.8, b: 3.0 };
    let start = Start { q: [0.7, -0.2], v: [0.3, 1.5] };
    let t = 2.0;
    let acceleration = |_, q: &[f64; 2], v: &[f64; 2]| system.acceleration(q, v);
    let (q, v) = extrapolate_by_hand(acceleration, (start.q, start.v), t, REFERENCE_STEPS);
    Motion::new(system, start, t, (&q, &v), 50)
}

/// Gyroscopic coupling and a constraint.
pub fn charged_spherical_pendulum() -> Motion<ChargedSphericalPendulum> {
    charged_spherical_pendulum_until(1.5)
}

/// The same for a longer time, so that the large steps of the highest orders are many enough to show a slope.
pub fn long_charged_spherical_pendulum() -> Motion<ChargedSphericalPendulum> {
    charged_spherical_pendulum_until(4.0)
}

fn charged_spherical_pendulum_until(t: f64) -> Motion<ChargedSphericalPendulum> {
    let system = ChargedSphericalPendulum::STANDARD;
    let start = system.one_radian();
    let acceleration = |_, q: &[f64; 3], v: &[f64; 3]| system.acceleration(q, v);
    let (q, v) = extrapolate_by_hand(acceleration, (start.q, start.v), t, REFERENCE_STEPS);
    Motion::new(system, start, t, (&q, &v), 50)
}

/// The potential depends on time.
pub fn modulated_pendulum() -> Motion<ModulatedPendulum> {
    let system = ModulatedPendulum { g: 9.0, a: 0.4, w: 5.0 };
    let start = Start { q: [1.0], v: [-0.5] };
    let t = 1.5;
    let (q, v) =
        extrapolate_by_hand(|t, q, _| system.acceleration(t, q), (start.q, start.v), t, REFERENCE_STEPS);
    Motion::new(system, start, t, (&q, &v), 100).without_energy()
}

/// The mass depends on time.
pub fn damped_pendulum() -> Motion<DampedPendulum> {
    let system = DampedPendulum { g: 9.0, c: 0.6 };
    let start = Start { q: [1.0], v: [-0.5] };
    let t = 2.25;
    let (q, v) =
        extrapolate_by_hand(|_, q, v| system.acceleration(q, v), (start.q, start.v), t, REFERENCE_STEPS);
    Motion::new(system, start, t, (&q, &v), 100).without_energy()
}

/// Not quadratic in the velocity, with a constraint.
pub fn relativistic_bead() -> Motion<RelativisticBead> {
    let system = RelativisticBead::STANDARD;
    let (angle, rate) = ([1.0], [-2.0]);
    let t = 1.0;
    let (angle_end, rate_end) =
        extrapolate_by_hand(|_, q, v| system.acceleration(q, v), (angle, rate), t, REFERENCE_STEPS);
    let end = RelativisticBead::at_angle(angle_end[0], rate_end[0]);
    Motion::new(system, RelativisticBead::at_angle(angle[0], rate[0]), t, (&end.q, &end.v), 50)
}

/// The constraint depends on time.
pub fn kapitza_pendulum() -> Motion<KapitzaPendulum> {
    let system = KapitzaPendulum::STANDARD;
    Motion::certified(system, system.near_inverted(), references::RHEONOMIC_PENDULUM, 400).without_energy()
}

/// A mechanism whose mass matrix depends on its configuration, with constraints: three turns of the gallery's slider-crank.
pub fn slider_crank() -> Motion<SliderCrank> {
    let system = SliderCrank::STANDARD;
    let Reference { q, v, .. } = SliderCrank::reference();
    Motion::new(system, system.stretched_out(15.0), SliderCrank::HORIZON, (&q, &v), 40)
}
