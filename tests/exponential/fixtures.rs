//! Scenes that only these tests need, and how far a run strays from a motion.

use evi_core::prelude::*;
use evi_examples::Start;
use evi_tests::largest_difference;

/// A particle on a circle, free of forces.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = 0.0,
    constraint(circle: x.powi(2) + y.powi(2) == r.powi(2)),
)]
pub(crate) struct Ring {
    pub(crate) m: f64,
    pub(crate) r: f64,
}

/// Three unequal masses in a plane, on springs that harden: translations are free, and so are rotations.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x1, y1, x2, y2, x3, y3),
    kinetic = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2)) + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2))
            + 0.5 * m3 * (der(x3).powi(2) + der(y3).powi(2)),
    let a = (x2 - x1 - 1.0).powi(2) + (y2 - y1).powi(2),
    let b = (x3 - x2 - 1.0).powi(2) + (y3 - y2).powi(2),
    potential = 0.5 * k * (a + b) + 0.25 * k * (a.powi(2) + b.powi(2)),
)]
pub(crate) struct Molecule {
    pub(crate) m1: f64,
    pub(crate) m2: f64,
    pub(crate) m3: f64,
    pub(crate) k: f64,
}

impl Molecule {
    pub(crate) const STANDARD: Self = Self { m1: 1.0, m2: 2.5, m3: 0.6, k: 40.0 };

    /// Stretched along the x-axis at rest.
    pub(crate) const REST: [f64; 6] = [0.0, 0.0, 1.0, 0.0, 2.0, 0.0];

    /// Far from the origin, moving and vibrating.
    pub(crate) fn moving(&self) -> Start<6> {
        Start { q: [3.1, -0.8, 4.0, -0.9, 5.2, -0.75], v: [0.4, -0.1, 0.5, 0.7, 0.2, -0.3] }
    }
}

/// A bead on a hanging curve that is no conic, `y = x² + x⁴/2 + …`, with unequal parameters: the curvature of the constraint varies.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = m * g * y + 0.5 * k * x.powi(2),
    constraint(curve: y == c * x.cosh() + 0.2 * x.powi(3)),
)]
pub(crate) struct Bead {
    pub(crate) m: f64,
    pub(crate) g: f64,
    pub(crate) k: f64,
    pub(crate) c: f64,
}

impl Bead {
    pub(crate) const STANDARD: Self = Self { m: 1.4, g: 9.81, k: 3.0, c: 0.8 };

    pub(crate) fn at(&self, x: f64, rate: f64) -> Start<2> {
        let slope = self.c * x.sinh() + 0.6 * x.powi(2);
        Start { q: [x, self.c * x.cosh() + 0.2 * x.powi(3)], v: [rate, rate * slope] }
    }

    /// The acceleration of `x` alone: `m (1 + y'²) x'' = −m y' y'' x'² − m g y' − k x`.
    pub(crate) fn acceleration(&self, q: &[f64; 1], v: &[f64; 1]) -> [f64; 1] {
        let [x] = *q;
        let slope = self.c * x.sinh() + 0.6 * x.powi(2);
        let bend = self.c * x.cosh() + 1.2 * x;
        let force = -self.m * (slope * bend * v[0].powi(2) + self.g * slope) - self.k * x;
        [force / (self.m * (1.0 + slope.powi(2)))]
    }
}

/// A bead in a round bowl with its lowest point at the origin: there every coordinate vanishes, the terms of the constraint do not.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = m * g * y,
    constraint(bowl: x.powi(2) + (y - l).powi(2) == l.powi(2)),
)]
pub(crate) struct Bowl {
    pub(crate) m: f64,
    pub(crate) l: f64,
    pub(crate) g: f64,
}

/// Largest difference of a run from `motion`, a function of time, at every step up to `t_end`.
#[track_caller]
pub(crate) fn distance_from<S, F, const N: usize>(
    system: S,
    scheme: F,
    start: Start<N>,
    t_end: f64,
    motion: impl Fn(f64) -> ([f64; N], [f64; N]),
) -> f64
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S>,
{
    let mut run = Simulation::new(system, scheme).start(start.q, start.v).expect("a start");
    let mut largest = 0.0_f64;
    while run.state().t() + 0.5 * run.map().h() < t_end {
        let state = run.advance().expect("a step");
        let (q, v) = motion(state.t());
        largest = largest.max(largest_difference(state.q(), &q)).max(largest_difference(state.v(), &v));
    }
    assert!(run.steps() > 10, "vacuous");
    largest
}

/// Three rods in a row, hanging, whose constraints are written in units that differ by `scale`.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x1, y1, x2, y2, x3, y3),
    kinetic = 0.5 * (der(x1).powi(2) + der(y1).powi(2)) + 0.4 * (der(x2).powi(2) + der(y2).powi(2))
            + 0.7 * (der(x3).powi(2) + der(y3).powi(2)),
    potential = g * (y1 + 0.8 * y2 + 1.4 * y3),
    constraint(rod1: x1.powi(2) + y1.powi(2) == 1.0),
    constraint(rod2: scale * ((x2 - x1).powi(2) + (y2 - y1).powi(2)) == scale),
    constraint(rod3: scale.powi(2) * ((x3 - x2).powi(2) + (y3 - y2).powi(2)) == scale.powi(2)),
)]
pub(crate) struct ThreeRods {
    pub(crate) g: f64,
    pub(crate) scale: f64,
}

impl ThreeRods {
    pub(crate) const HANGING: [f64; 6] = [0.0, -1.0, 0.0, -2.0, 0.0, -3.0];

    /// At rest, every rod off the vertical.
    pub(crate) fn deflected(&self) -> Start<6> {
        let rods = [0.3_f64, 0.5, -0.4].map(f64::sin_cos);
        let mut q = [0.0; 6];
        for (k, (sine, cosine)) in rods.into_iter().enumerate() {
            let above = if k == 0 { [0.0; 2] } else { [q[2 * k - 2], q[2 * k - 1]] };
            (q[2 * k], q[2 * k + 1]) = (above[0] + sine, above[1] - cosine);
        }
        Start { q, v: [0.0; 6] }
    }
}
