//! Powers of other languages.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * mass * (der(x)^2 + der(y)^2),
    potential = stiffness * x^4 + y^0.5 + 2.0 * y^mass + x^2.0,
    constraint(rod: x^2 + y^2 == length^2),
)]
struct Caret { mass: f64, stiffness: f64, length: f64 }

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * (der(x) ** 2 + der(y)**2),
    potential = x ** thrre,
)]
struct Stars { three: f64 }

fn main() {}
