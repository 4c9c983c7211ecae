//! Vectors where numbers are due, and the other way round; lengths that do not match.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(coordinates(r: [3]), kinetic = 0.5 * der(r), potential = r.sin() + r.powi(2) + 2.0.powf(r) + r)]
struct VectorForNumber;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(r: [3], s: [2], x),
    kinetic = 0.5 * (der(r).norm_squared() + der(s).norm_squared() + der(x).powi(2)),
    potential = r.dot(s) + (r + s).norm() + (r + 1.0).norm() + (1.0 / r).norm() + (r * r).norm() + s.cross(s).norm()
        + x.norm() + r.dot() + r.norm(x) + x[0] + der(x)[0] + r[0][0] + [1.0, x].dot([x, 1.0, x]),
)]
struct Lengths;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(r: [3], p: [2, 3], x),
    kinetic = 0.5 * (der(r).norm_squared() + der(x).powi(2)),
    potential = p.norm() + { let i = 1; p[i][0] },
    constraint(pin: r == [0.0, 0.0]),
    constraint(wall: r == 0.0),
    constraint(rail: x == [0.0]),
)]
struct Equations;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(r: [3], p: [2, 3], x),
    kinetic = 0.5 * (der(r).norm_squared() + der(p[1]).norm_squared() + der(p[0]).dot([1.0, 2.0, 0.0]).powi(2) + der(x).powi(2)),
    potential = 0.0,
    force(r: 1.0),
    force(p[0]: [1.0, 2.0]),
    force(p[2]: [1.0, 2.0, 3.0]),
    force(x[0]: 1.0),
    force(x: r),
    frequency(r[1]: 1.0),
    frequency(r: 2.0),
    input(u[2]),
    dissipation = der(r),
)]
struct Forces;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, p: [1, 1, 1, 1, 1, 1, 1, 1, 2]),
    kinetic = der(x).powi(2),
    let deep = [[[[[[[[[x]]]]]]]]],
    let long = [big[0], big[1], big[2], big[3], big[4], big[5]],
    potential = x * big.norm() + long[0].norm(),
)]
struct TooLarge { big: [[f64; 2000]; 6] }

#[derive(MechanicalSystem)]
#[evi(coordinates(x, p: [3, unsafe]), kinetic = der(x).powi(2), potential = x)]
struct BrokenOff;

fn main() {}
