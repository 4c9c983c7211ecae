//! Anything but a struct with named fields; what else is mistaken there does not count.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * m * der(x)^2, potential = y, foo)]
struct Tuple(f64);

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * m * der(x).powi(2), potential = y)]
enum Enum { M(f64) }

#[derive(MechanicalSystem)]
union Union { m: f64, n: u64 }

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * m * der(x).powi(2), potential = y)]
struct Type<T> { m: T }

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * m * der(x).powi(2), potential = y)]
struct Lifetime<'a> { m: f64, name: &'a str }

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * m * der(x).powi(2), potential = y)]
struct Const<const N: usize> where [f64; N]: Clone { m: [f64; N] }

fn use_them(tuple: Tuple, choice: Enum, union: Union, generic: Type<f64>, lifetime: Lifetime, array: Const<3>) {
    let _ = Simulation::new(tuple, Evi::midpoint(0.1)).start([0.0], [0.0]);
    let _ = Simulation::new(choice, Evi::midpoint(0.1)).start([0.0], [0.0]);
    let _ = Simulation::new(union, Evi::midpoint(0.1));
    let _ = Simulation::new(generic, Evi::midpoint(0.1)).start([0.0], [0.0]);
    let _ = Simulation::new(lifetime, Evi::midpoint(0.1)).start([0.0], [0.0]);
    let _ = Simulation::new(array, Evi::midpoint(0.1)).start([0.0], [0.0]);
}

fn main() {}
