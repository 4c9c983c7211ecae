//! Systems that only the laboratory needs.

use evi_core::prelude::*;
use evi_examples::GRAVITY;

/// Two rods with a stiff link between them: a chain of three masses in a plane, pivot at the origin, y upwards. First and last piece are
/// rods of length `l`, the middle one is a spring of that length at rest.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x1, y1, x2, y2, x3, y3),
    let stretch = ((x2 - x1).powi(2) + (y2 - y1).powi(2)).sqrt() - l,
    kinetic = 0.5 * m * (der(x1).powi(2) + der(y1).powi(2) + der(x2).powi(2) + der(y2).powi(2)
                       + der(x3).powi(2) + der(y3).powi(2)),
    potential = m * g * (y1 + y2 + y3) + 0.5 * k * stretch.powi(2),
    constraint(first: x1.powi(2) + y1.powi(2) == l.powi(2)),
    constraint(last: (x3 - x2).powi(2) + (y3 - y2).powi(2) == l.powi(2)),
)]
pub(crate) struct StiffLink {
    pub(crate) m: f64,
    pub(crate) l: f64,
    pub(crate) k: f64,
    pub(crate) g: f64,
}

impl StiffLink {
    pub(crate) const fn with_stiffness(k: f64) -> Self {
        Self { m: 0.7, l: 0.9, k, g: GRAVITY }
    }

    /// Hanging at rest.
    pub(crate) fn hanging(&self) -> [f64; 6] {
        let link = self.l + 2.0 * self.m * self.g / self.k;
        [0.0, -self.l, 0.0, -self.l - link, 0.0, -2.0 * self.l - link]
    }

    /// At rest with the pieces at these angles from the downward vertical, the link as long as it hangs.
    pub(crate) fn at_angles(&self, angles: [f64; 3]) -> [f64; 6] {
        let lengths = [self.l, self.l + 2.0 * self.m * self.g / self.k, self.l];
        let mut q = [0.0; 6];
        let mut end = [0.0; 2];
        for (piece, (angle, length)) in angles.into_iter().zip(lengths).enumerate() {
            end = [end[0] + length * angle.sin(), end[1] - length * angle.cos()];
            q[2 * piece..2 * piece + 2].copy_from_slice(&end);
        }
        q
    }
}

/// A point on a sphere and on a second one that cuts it at the angle `alpha` along the circle `z = 0`: a plane pendulum, y upwards. With
/// `alpha = 0` and `l2 = l` the second constraint says the same again.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x, y, z),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2) + der(z).powi(2)),
    potential = m * g * y,
    constraint(sphere: x.powi(2) + y.powi(2) + z.powi(2) == l.powi(2)),
    constraint(again: x.powi(2) + y.powi(2) + z.powi(2) + 2.0 * l * alpha * z == l2.powi(2)),
)]
pub(crate) struct AlmostTwice {
    pub(crate) m: f64,
    pub(crate) l: f64,
    pub(crate) l2: f64,
    pub(crate) g: f64,
    pub(crate) alpha: f64,
}

impl AlmostTwice {
    pub(crate) const fn at_angle(alpha: f64) -> Self {
        Self { m: 0.8, l: 1.1, l2: 1.1, g: GRAVITY, alpha }
    }

    /// At rest, one radian from the downward vertical.
    pub(crate) fn one_radian(&self) -> [f64; 3] {
        let (sine, cosine) = 1.0_f64.sin_cos();
        [self.l * sine, -self.l * cosine, 0.0]
    }
}

/// A bar on three parallel cranks, one more than it needs: the constraints are dependent at every configuration. Pivots at `x = 0, d, 2d`, y
/// upwards; masses sit at the joints.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x1, y1, x2, y2, x3, y3),
    kinetic = 0.5 * m * (der(x1).powi(2) + der(y1).powi(2) + der(x2).powi(2) + der(y2).powi(2)
                       + der(x3).powi(2) + der(y3).powi(2)),
    potential = m * g * (y1 + y2 + y3),
    constraint(first: x1.powi(2) + y1.powi(2) == l.powi(2)),
    constraint(second: (x2 - d).powi(2) + y2.powi(2) == l.powi(2)),
    constraint(third: (x3 - 2.0 * d).powi(2) + y3.powi(2) == l.powi(2)),
    constraint(bar: (x3 - x1).powi(2) + (y3 - y1).powi(2) == (2.0 * d).powi(2)),
    constraint(middle_x: 2.0 * x2 == x1 + x3),
    constraint(middle_y: 2.0 * y2 == y1 + y3),
)]
pub(crate) struct ThreeCranks {
    pub(crate) m: f64,
    pub(crate) l: f64,
    pub(crate) d: f64,
    pub(crate) g: f64,
}

impl ThreeCranks {
    pub(crate) const STANDARD: Self = Self { m: 0.8, l: 1.25, d: 2.0, g: GRAVITY };

    /// At rest, one radian from the downward vertical.
    pub(crate) fn one_radian(&self) -> [f64; 6] {
        let (sine, cosine) = 1.0_f64.sin_cos();
        let (x, y) = (self.l * sine, -self.l * cosine);
        [x, y, x + self.d, y, x + 2.0 * self.d, y]
    }
}

/// A particle that nothing holds.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(coordinates(x), kinetic = 0.5 * m * der(x).powi(2), potential = 0.0)]
pub(crate) struct FreeParticle {
    pub(crate) m: f64,
}
