//! Bodies in directors.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x),
    kinetic = 0.5 * der(x).powi(2),
    potential = b.point([x, 0.0, 0.0])[0] + b.point([1.0, 2.0])[0] + b.point()[1] + x.point([1.0, 2.0, 3.0]),
    rigid_body(b, mass = 1.0, center = [0.0, 0.0, 1.0], inertia = [1.0, 1.0, 1.0]),
)]
struct Points;

#[derive(MechanicalSystem)]
#[evi(
    rigid_body(a, mass = 1.0),
    rigid_body(b, mass = 1.0, centre = [0.0, 0.0, 1.0], inertia = [1.0, 1.0, 1.0]),
    rigid_body(mass = 1.0),
    rigid_body(c, mass = 1.0, center = [0.0, 1.0, 2.0, 3.0], inertia = [1.0, 1.0, 1.0]),
    rigid_body(e, mass = 1.0, center = [0.0, 1.0, 2.0], inertia = j),
    rigid_body d,
    rigid_body(f[i in 1..4], mass = 1.0, center = [0.0, 1.0, 2.0], inertia = [1.0, 1.0, 1.0]),
    rigid_body(g[2], mass = 1.0, center = [0.0, 1.0, 2.0], inertia = [1.0, 1.0, 1.0]),
    potential = 0.0,
)]
struct Properties { j: f64 }

fn main() {}
