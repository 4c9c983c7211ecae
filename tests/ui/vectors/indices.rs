//! Indices and ranges: out of range, not affine, unknown.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(coordinates(p: [3, 2]), kinetic = sum(0..3, |i| der(p[i]).norm_squared()), potential = p[3][0] + p[0][2] + p[-1][0])]
struct OutOfRange;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(p: [3, 2]),
    kinetic = sum(0..3, |i| der(p[i]).norm_squared()),
    potential = sum(0..3, |i| m[i + 1] * p[i][1]),
    constraint(link[i in 0..3]: (p[i] - p[i - 1]).norm_squared() == 1.0),
)]
struct OutOfRangeInLoops { m: [f64; 3] }

#[derive(MechanicalSystem)]
#[evi(
    coordinates(p: [3, 2]),
    kinetic = sum(0..3, |i| der(p[i]).norm_squared()),
    potential = sum(0..3, |i| p[i * i][0] + p[i / 2][0] + p[2.0][0] + p[m][0] + p[j][0] + p[(i + 1) as usize][0]),
)]
struct NotAffine { m: f64 }

#[derive(MechanicalSystem)]
#[evi(
    coordinates(p: [3, 2]),
    kinetic = sum(0..3, |i| der(p[i]).norm_squared()),
    potential = sum(0..count, |i| p[i][0]) + sum(3, |i| p[i][0]) + sum(0.., |i| p[i][0]) + sum(0..N, |i| p[i][0])
        + sum(2..1, |i| p[i][0]) + sum(0..3) + sum(0..3, |i, j| p[i][0]) + sum(0..3, || p[0][0])
        + sum(0..3, p[0]),
)]
struct Ranges { count: f64 }

#[derive(MechanicalSystem)]
#[evi(
    coordinates(p: [3, 2]),
    kinetic = sum(0..3, |i| der(p[i]).norm_squared()),
    potential = p[N][0],
    constraint(pin[0]: p[0][0] == 0.0),
    constraint(none[]: p[0][0] == 0.0),
    constraint(link[i in 3]: p[i][0] == 0.0),
    constraint(more[i in 0..4]: p[i][0] == 0.0),
)]
struct Families;

const N: usize = 3;

fn main() {}
