//! Constraints that no motion can change.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x),
    lagrangian = 0.5 * der(x).powi(2),
    constraint(mistaken: x == y),
    constraint(lengths: a == b),
    constraint(moves: x == a),
    constraint(time: t == 1.0),
)]
struct Fixed { a: f64, b: f64 }

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    lagrangian = 0.5 * (der(x).powi(2) + der(y).powi(2)),
    constraint(itself: x == x),
    constraint(in_another_order: x + 2.0 * y == y + x + y),
    constraint(moves: x == a),
)]
struct Trivial { a: f64 }

fn main() {}
