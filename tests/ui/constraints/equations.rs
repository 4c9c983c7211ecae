//! What stands in a constraint instead of one equation.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    lagrangian = 0.5 * (der(x).powi(2) + der(y).powi(2)),
    constraint(assigned: x.powi(2) = y),
    constraint(at_most: x <= y),
    constraint(below: x < y),
    constraint(different: x != y),
    constraint(arrow: x => y),
    constraint(nothing: x - y^2),
    constraint(two: x == y == 1.0),
    constraint(both: z = y^2),
)]
struct Relations;

fn main() {}
