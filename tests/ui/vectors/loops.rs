//! Scenes whose sizes are constants: what is no loop over elements, and what only rustc knows.

use evi_core::prelude::*;

const N: usize = 10;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(p: [N]),
    kinetic = sum(0..N, |i| der(p[i]).powi(2)),
    potential = sum(0..N, |i| p[i]).powi(2) + { let all = sum(0..N, |i| p[i]); sum(0..N, |i| p[i] * all) }
        + sum(0..N, |i| p[i]) * sum(0..N, |i| p[i]),
    constraint(all: sum(0..N, |i| p[i]) == 0.0),
    input(u),
    force(p[0]: u * sum(0..N, |i| p[i])),
    frequency(p[0]: sum(0..N, |i| 1.0 * i)),
    observe(each[i in 0..N]: p[i]),
    observe(length: sum(0..N, |i| p[i]).sqrt()),
)]
struct NoLoop;

#[derive(MechanicalSystem)]
#[evi(coordinates(p: [N]), kinetic = sum(0..N, |i| der(p[i]).powi(2)), potential = p, force(p: 1.0))]
struct Arrays;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(p: [N], q: [N + 1, 2], x),
    kinetic = sum(0..N, |i| der(q[i]).norm_squared()) + der(x).powi(2),
    potential = sum(0..M, |i| p[i]) + q[0][2],
)]
struct Names;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(p: [N]),
    kinetic = sum(0..N, |i| der(p[i]).powi(2)),
    potential = sum(0..N, |i| p[i + 1]) + p[N] + sum(0..N, |i| sum(0..i, |j| p[j - 1])),
    constraint(link[i in 0..N]: p[i] - p[i - 1] == l[i]),
)]
struct Bounds { l: [f64; N] }

fn main() {
    let _ = (NoLoop, Arrays, Names, Bounds { l: [0.0; N] });
}
