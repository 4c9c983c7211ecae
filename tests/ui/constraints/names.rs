//! Constraints without a name of their own, and families.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    lagrangian = 0.5 * (der(x).powi(2) + der(y).powi(2)),
    constraint(x == y),
    constraint(_: x == y),
    constraint(rod: x == y),
    constraint(rod: x == 2.0 * y),
    constraint(rods[i in 0..3]: x == y),
    constraint(),
    constraint rod: x == y,
    constraint(wall, x == y),
)]
struct Names;

fn main() {}
