//! Scenes beside the gallery: one for each structure of `L` or `φ` that the gallery does not have, with the
//! accelerations by hand as an independent reference.

use evi_core::prelude::*;
pub use evi_examples::KapitzaPendulum;
use evi_examples::{DoublePendulum, Start};

/// Plane double pendulum in its angles from the downward vertical: the mass matrix depends on the
/// configuration.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(a, b),
    kinetic = 0.5 * (m1 + m2) * l1.powi(2) * der(a).powi(2) + 0.5 * m2 * l2.powi(2) * der(b).powi(2)
            + m2 * l1 * l2 * der(a) * der(b) * (a - b).cos(),
    potential = -(m1 + m2) * g * l1 * a.cos() - m2 * g * l2 * b.cos(),
)]
pub struct DoublePendulumInAngles {
    /// Mass of the inner bob.
    pub m1: f64,
    /// Mass of the outer bob.
    pub m2: f64,
    /// Length of the inner rod.
    pub l1: f64,
    /// Length of the outer rod.
    pub l2: f64,
    /// Gravitational acceleration.
    pub g: f64,
}

impl DoublePendulumInAngles {
    /// Unequal masses and lengths, so that no term can take the place of another.
    pub const UNEQUAL: Self = Self { m1: 1.3, m2: 0.7, l1: 0.9, l2: 1.1, g: 9.81 };

    /// A swing of moderate size with both rates nonzero.
    pub const MODERATE: Start<2> = Start { q: [0.8, -0.3], v: [0.5, 1.1] };

    /// A smaller swing, on which errors of high order settle early and keep their sign.
    pub const GENTLE: Start<2> = Start { q: [0.5, 0.4], v: [-0.5, 0.6] };

    /// The same pendulum with constraints.
    pub const fn constrained(&self) -> DoublePendulum {
        let Self { m1, m2, l1, l2, g } = *self;
        DoublePendulum { m1, m2, l1, l2, g }
    }

    /// Cartesian positions and velocities of angles and rates.
    pub fn cartesian(&self, q: [f64; 2], v: [f64; 2]) -> Start<4> {
        let ([sine1, cosine1], [sine2, cosine2]) = ([q[0].sin(), q[0].cos()], [q[1].sin(), q[1].cos()]);
        let inner = [self.l1 * sine1, -self.l1 * cosine1];
        let inner_rate = [self.l1 * cosine1 * v[0], self.l1 * sine1 * v[0]];
        Start {
            q: [inner[0], inner[1], inner[0] + self.l2 * sine2, inner[1] - self.l2 * cosine2],
            v: [
                inner_rate[0],
                inner_rate[1],
                inner_rate[0] + self.l2 * cosine2 * v[1],
                inner_rate[1] + self.l2 * sine2 * v[1],
            ],
        }
    }

    /// Angular accelerations, from the balance of forces on each rod.
    pub fn acceleration(&self, q: &[f64; 2], v: &[f64; 2]) -> [f64; 2] {
        let Self { m1, m2, l1, l2, g } = *self;
        let (sine, cosine) = (q[0] - q[1]).sin_cos();
        // (m1 + m2) l1 a'' + m2 l2 cos b'' = f1,   l1 cos a'' + l2 b'' = f2
        let f1 = -m2 * l2 * sine * v[1].powi(2) - (m1 + m2) * g * q[0].sin();
        let f2 = l1 * sine * v[0].powi(2) - g * q[1].sin();
        let determinant = l1 * l2 * (m1 + m2 * sine * sine);
        [
            (f1 * l2 - m2 * l2 * cosine * f2) / determinant,
            ((m1 + m2) * l1 * f2 - l1 * cosine * f1) / determinant,
        ]
    }
}

/// Charged particle in a plane, across a magnetic field: `L` couples positions and velocities.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x, y),
    lagrangian = 0.5 * m * (der(x).powi(2) + der(y).powi(2)) + 0.5 * b * (x * der(y) - y * der(x))
               - (0.25 * x.powi(4) + 0.5 * x.powi(2) * y + y.powi(2)),
)]
pub struct ChargedParticle {
    /// Mass.
    pub m: f64,
    /// Charge times magnetic field.
    pub b: f64,
}

impl ChargedParticle {
    /// The Lorentz force and the force of the potential.
    pub fn acceleration(&self, q: &[f64; 2], v: &[f64; 2]) -> [f64; 2] {
        let force =
            [self.b * v[1] - q[0].powi(3) - q[0] * q[1], -self.b * v[0] - 0.5 * q[0].powi(2) - 2.0 * q[1]];
        force.map(|force| force / self.m)
    }
}

/// Spherical pendulum with a charge in a vertical magnetic field: gyroscopic coupling and a constraint, so
/// that the momentum on the constraint is not `M v`.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x, y, z),
    lagrangian = 0.5 * m * (der(x).powi(2) + der(y).powi(2) + der(z).powi(2))
               + 0.5 * b * (x * der(y) - y * der(x)) - m * g * z,
    constraint(rod: x.powi(2) + y.powi(2) + z.powi(2) == l.powi(2)),
)]
pub struct ChargedSphericalPendulum {
    /// Mass.
    pub m: f64,
    /// Length of the rod.
    pub l: f64,
    /// Gravitational acceleration.
    pub g: f64,
    /// Charge times magnetic field.
    pub b: f64,
}

impl ChargedSphericalPendulum {
    /// Unequal parameters.
    pub const STANDARD: Self = Self { m: 0.8, l: 1.0, g: 9.81, b: 2.5 };

    /// One radian from the downward vertical with horizontal velocity 1.2.
    pub fn one_radian(&self) -> Start<3> {
        let (sine, cosine) = 1.0_f64.sin_cos();
        Start { q: [self.l * sine, 0.0, -self.l * cosine], v: [0.0, 1.2, 0.0] }
    }

    /// Gravity, Lorentz force, and the pull of the rod that keeps `q·a = −v²`.
    pub fn acceleration(&self, q: &[f64; 3], v: &[f64; 3]) -> [f64; 3] {
        let free = [self.b * v[1] / self.m, -self.b * v[0] / self.m, -self.g];
        let inner = |a: &[f64; 3], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let pull = (inner(q, &free) + inner(v, v)) / inner(q, q);
        core::array::from_fn(|i| free[i] - pull * q[i])
    }
}

/// Pendulum whose pivot shakes fast with small amplitude, as a modulated gravity: the potential depends on
/// time.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(theta),
    kinetic = 0.5 * der(theta).powi(2),
    potential = -g * (1.0 + a * (w * t).cos()) * theta.cos(),
)]
pub struct ModulatedPendulum {
    /// Gravitational acceleration over length.
    pub g: f64,
    /// Relative amplitude of the modulation.
    pub a: f64,
    /// Angular frequency of the modulation.
    pub w: f64,
}

impl ModulatedPendulum {
    /// Angular acceleration.
    pub fn acceleration(&self, t: f64, q: &[f64; 1]) -> [f64; 1] {
        [-self.g * (1.0 + self.a * (self.w * t).cos()) * q[0].sin()]
    }
}

/// Pendulum with linear damping in the Lagrangian of Caldirola and Kanai: the mass depends on time.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(coordinates(theta), lagrangian = (c * t).exp() * (0.5 * der(theta).powi(2) + g * theta.cos()))]
pub struct DampedPendulum {
    /// Gravitational acceleration over length.
    pub g: f64,
    /// Damping rate.
    pub c: f64,
}

impl DampedPendulum {
    /// Angular acceleration.
    pub fn acceleration(&self, q: &[f64; 1], v: &[f64; 1]) -> [f64; 1] {
        [-self.c * v[0] - self.g * q[0].sin()]
    }
}

/// Fast bead on a circle under gravity, relativistic: `L` is not quadratic in the velocity.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x, y),
    lagrangian = -m * c.powi(2) * (1.0 - (der(x).powi(2) + der(y).powi(2)) / c.powi(2)).sqrt() - m * g * y,
    constraint(circle: x.powi(2) + y.powi(2) == 1.0),
)]
pub struct RelativisticBead {
    /// Rest mass.
    pub m: f64,
    /// Speed of light.
    pub c: f64,
    /// Gravitational acceleration.
    pub g: f64,
}

impl RelativisticBead {
    /// A speed of light that the motion comes near to.
    pub const STANDARD: Self = Self { m: 0.7, c: 4.0, g: 9.81 };

    /// The bead at an angle from the downward vertical that changes at `rate`.
    pub fn at_angle(angle: f64, rate: f64) -> Start<2> {
        let (sine, cosine) = angle.sin_cos();
        Start { q: [sine, -cosine], v: [rate * cosine, rate * sine] }
    }

    /// Angular acceleration: `γ³ θ'' = −g sin θ`.
    pub fn acceleration(&self, q: &[f64; 1], v: &[f64; 1]) -> [f64; 1] {
        [-self.g * q[0].sin() * (1.0 - (v[0] / self.c).powi(2)).powf(1.5)]
    }
}

/// Two masses on a massless rod in the plane, without any force: linear and angular momentum are conserved.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x1, y1, x2, y2),
    kinetic = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2)) + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2)),
    potential = 0.0,
    constraint(rod: (x2 - x1).powi(2) + (y2 - y1).powi(2) == l.powi(2)),
)]
pub struct Dumbbell {
    /// One mass.
    pub m1: f64,
    /// The other mass.
    pub m2: f64,
    /// Length of the rod.
    pub l: f64,
}

impl Dumbbell {
    /// Unequal masses.
    pub const STANDARD: Self = Self { m1: 1.0, m2: 2.0, l: 1.0 };

    /// Lying along the x-axis near the origin, turning at 2 rad/s while it moves.
    pub const fn turning(&self) -> Start<4> {
        Start { q: [0.5, 0.2, 0.5 + self.l, 0.2], v: [0.3, -0.4, 0.3, -0.4 + 2.0 * self.l] }
    }
}

/// `KapitzaPendulum` in its angle from the downward vertical: no constraint, a kinetic energy that depends on time.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(theta),
    let pivot = -a * w * (w * t).sin(),
    kinetic = 0.5 * m * ((l * theta.cos() * der(theta)).powi(2) + (pivot + l * theta.sin() * der(theta)).powi(2)),
    potential = m * g * (a * (w * t).cos() - l * theta.cos()),
)]
pub struct KapitzaPendulumInAngle {
    /// Mass.
    pub m: f64,
    /// Length of the rod.
    pub l: f64,
    /// Gravitational acceleration.
    pub g: f64,
    /// Amplitude of the pivot.
    pub a: f64,
    /// Angular frequency of the pivot.
    pub w: f64,
}

impl KapitzaPendulumInAngle {
    /// The same pendulum.
    pub const fn of(KapitzaPendulum { m, l, g, a, w }: KapitzaPendulum) -> Self {
        Self { m, l, g, a, w }
    }
}

/// `DoublePendulumInAngles` with friction in both joints and a torque that follows the rods and the clock: a
/// mass matrix that depends on the configuration, forces whose derivatives are not symmetric.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(a, b),
    kinetic = 0.5 * (m1 + m2) * l1.powi(2) * der(a).powi(2) + 0.5 * m2 * l2.powi(2) * der(b).powi(2)
            + m2 * l1 * l2 * der(a) * der(b) * (a - b).cos(),
    potential = -(m1 + m2) * g * l1 * a.cos() - m2 * g * l2 * b.cos(),
    dissipation = 0.5 * inner * der(a).powi(2) + 0.25 * outer * (der(b) - der(a)).powi(4),
    force(b: torque * (a - 2.0 * b).sin() * (w * t).cos()),
)]
pub struct MotorisedDoublePendulum {
    /// Mass of the inner bob.
    pub m1: f64,
    /// Mass of the outer bob.
    pub m2: f64,
    /// Length of the inner rod.
    pub l1: f64,
    /// Length of the outer rod.
    pub l2: f64,
    /// Gravitational acceleration.
    pub g: f64,
    /// Friction of the inner joint, torque per rate.
    pub inner: f64,
    /// Friction of the outer joint, torque per cube of the rate.
    pub outer: f64,
    /// Largest torque on the outer rod.
    pub torque: f64,
    /// Angular frequency of the torque.
    pub w: f64,
}

impl MotorisedDoublePendulum {
    /// Unequal parameters.
    pub const STANDARD: Self =
        Self { m1: 1.3, m2: 0.7, l1: 0.9, l2: 1.1, g: 9.81, inner: 0.4, outer: 0.3, torque: 2.5, w: 3.0 };

    /// Torques of friction and motor.
    pub fn forces(&self, t: f64, q: &[f64; 2], v: &[f64; 2]) -> [f64; 2] {
        let outer = self.outer * (v[1] - v[0]).powi(3);
        let motor = self.torque * (q[0] - 2.0 * q[1]).sin() * (self.w * t).cos();
        [outer - self.inner * v[0], motor - outer]
    }

    /// Angular accelerations: those of the free pendulum, and the inverse mass matrix times the torques.
    pub fn acceleration(&self, t: f64, q: &[f64; 2], v: &[f64; 2]) -> [f64; 2] {
        let Self { m1, m2, l1, l2, g, .. } = *self;
        let free = DoublePendulumInAngles { m1, m2, l1, l2, g }.acceleration(q, v);
        let [fa, fb] = self.forces(t, q, v);
        let (aa, bb) = ((m1 + m2) * l1 * l1, m2 * l2 * l2);
        let ab = m2 * l1 * l2 * (q[0] - q[1]).cos();
        let determinant = aa * bb - ab * ab;
        [free[0] + (bb * fa - ab * fb) / determinant, free[1] + (aa * fb - ab * fa) / determinant]
    }
}

/// Two masses on a rod in the plane, in a fluid that drags each with its own coefficient, and one of them
/// pushed by the caller; no other force.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x1, y1, x2, y2),
    kinetic = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2)) + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2)),
    potential = 0.0,
    constraint(rod: (x2 - x1).powi(2) + (y2 - y1).powi(2) == l.powi(2)),
    input(push_x, push_y),
    dissipation = 0.5 * c1 * (der(x1).powi(2) + der(y1).powi(2)) + 0.5 * c2 * (der(x2).powi(2) + der(y2).powi(2)),
    force(x1: push_x),
    force(y1: push_y),
    observe(angle: (y2 - y1).atan2(x2 - x1)),
    observe(power: push_x * der(x1) + push_y * der(y1)),
)]
pub struct PushedDumbbell {
    /// The mass that is pushed.
    pub m1: f64,
    /// The other mass.
    pub m2: f64,
    /// Length of the rod.
    pub l: f64,
    /// Drag of the mass that is pushed, force per velocity.
    pub c1: f64,
    /// Drag of the other mass.
    pub c2: f64,
}

impl PushedDumbbell {
    /// Unequal masses and drags.
    pub const STANDARD: Self = Self { m1: 1.0, m2: 2.0, l: 1.0, c1: 0.3, c2: 0.7 };

    /// As `Dumbbell::turning`.
    pub const fn turning(&self) -> Start<4> {
        Dumbbell { m1: self.m1, m2: self.m2, l: self.l }.turning()
    }
}

/// Oscillator with linear damping, driven by the caller; its frequency is the scene's.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x),
    kinetic = 0.5 * m * der(x).powi(2),
    potential = 0.5 * k * x.powi(2),
    dissipation = 0.5 * c * der(x).powi(2),
    input(push),
    force(x: push),
    frequency(x: (k / m).sqrt()),
    observe(energy: 0.5 * m * der(x).powi(2) + 0.5 * k * x.powi(2)),
)]
pub struct DampedOscillator {
    /// Mass.
    pub m: f64,
    /// Stiffness.
    pub k: f64,
    /// Damping coefficient, force per velocity.
    pub c: f64,
}

impl DampedOscillator {
    /// Damping ratio 0.1.
    pub const STANDARD: Self = Self { m: 2.0, k: 8.0, c: 0.8 };

    /// Position and velocity a time `t` after `(x, v)` under a constant push.
    pub fn exact(&self, t: f64, (x, v): (f64, f64), push: f64) -> (f64, f64) {
        let Self { m, k, c } = *self;
        let (decay, rest) = (0.5 * c / m, push / k);
        let rate = (k / m - decay * decay).sqrt();
        let (sine, cosine) = (rate * t).sin_cos();
        let (x, factor) = (x - rest, (-decay * t).exp());
        (
            rest + factor * (x * cosine + (v + decay * x) / rate * sine),
            factor * (v * cosine - (k / m * x + decay * v) / rate * sine),
        )
    }
}
