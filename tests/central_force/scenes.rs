//! Scenes of one central force, and scenes that are next to that.

use evi_core::prelude::*;

/// A mass on a spring, fixed beside the origin.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = 0.5 * k * (((x - a).powi(2) + (y - b).powi(2)).sqrt() - l).powi(2) + m * g * y,
)]
pub struct OffCentre {
    pub m: f64,
    pub k: f64,
    pub l: f64,
    pub a: f64,
    pub b: f64,
    pub g: f64,
}

/// Two masses in space on a spring, under gravity that is not along an axis.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(p: [3], s: [3]),
    let reach = (s - p).norm(),
    kinetic = 0.5 * m1 * der(p).norm_squared() + 0.5 * m2 * der(s).norm_squared(),
    potential = 0.5 * k * (reach - l).powi(2) + g * (m1 * p[2] + m2 * s[2] + 0.3 * m2 * s[0]),
)]
pub struct Dumbbell {
    pub m1: f64,
    pub m2: f64,
    pub k: f64,
    pub l: f64,
    pub g: f64,
}

/// Two masses in a plane that attract each other.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(x1, y1, x2, y2),
    kinetic = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2)) + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2)),
    potential = -gamma * m1 * m2 * ((x1 - x2).powi(2) + (y2 - y1).powi(2)).powf(-0.5),
)]
pub struct DoubleStar {
    pub m1: f64,
    pub m2: f64,
    pub gamma: f64,
}

/// A bond in space by Morse's potential.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(r: [3]),
    kinetic = 0.5 * m * der(r).norm_squared(),
    potential = depth * (1.0 - (steepness * (l - r.norm())).exp()).powi(2),
)]
pub struct Morse {
    pub m: f64,
    pub depth: f64,
    pub steepness: f64,
    pub l: f64,
}

/// Two masses on a line on a spring that hardens.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(x1, x2),
    kinetic = 0.5 * m1 * der(x1).powi(2) + 0.5 * m2 * der(x2).powi(2),
    potential = 0.25 * k * (x1 - x2 - l).powi(4) + 0.2 * x1,
)]
pub struct Line {
    pub m1: f64,
    pub m2: f64,
    pub k: f64,
    pub l: f64,
}

/// A mass in a smooth cup, whose force vanishes with the distance.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = 0.25 * k * (x.powi(2) + y.powi(2)).powi(2),
)]
pub struct Cup {
    pub m: f64,
    pub k: f64,
}

/// A centre of finite size; the constant stands before the squares, and between them.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = -mu / (size.powi(2) + x.powi(2) + y.powi(2)).sqrt() - 0.1 * mu * (x.powi(2) - size + y.powi(2)).cos(),
)]
pub struct Softened {
    pub m: f64,
    pub mu: f64,
    pub size: f64,
}

/// A distance in which two coordinates count unequally: with equal masses, the force does not point along it.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * m1 * der(x).powi(2) + 0.5 * m2 * der(y).powi(2),
    potential = 0.5 * k * ((x.powi(2) + 2.0 * y.powi(2)).sqrt() - l).powi(2) + m2 * g * y,
)]
pub struct Elliptic {
    pub m1: f64,
    pub m2: f64,
    pub k: f64,
    pub l: f64,
    pub g: f64,
}
