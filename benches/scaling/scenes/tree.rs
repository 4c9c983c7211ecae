//! A binary tree of rods that hangs from a pivot at its root, let go from a fan above the horizontal.

use std::f64::consts::PI;

use evi_core::prelude::*;
use evi_examples::GRAVITY;

use crate::specimen::Specimen;

const N: usize = 127;
/// Point masses with two others below them.
const INNER: usize = 63;

/// Point mass `i` carries `2i + 1` and `2i + 2`.
#[derive(MechanicalSystem, Clone, Debug)]
#[evi(
    coordinates(p: [N, 2]),
    kinetic = 0.5 * m * sum(0..N, |i| der(p[i]).norm_squared()),
    potential = m * g * sum(0..N, |i| p[i][1]),
    constraint(root: p[0].norm_squared() == l.powi(2)),
    constraint(left[i in 0..INNER]: (p[2 * i + 1] - p[i]).norm_squared() == l.powi(2)),
    constraint(right[i in 0..INNER]: (p[2 * i + 2] - p[i]).norm_squared() == l.powi(2)),
)]
pub(crate) struct Tree {
    m: f64,
    l: f64,
    g: f64,
}

/// At rest, every rod in a direction of its own: the fan of a mass is shared by those that it carries.
pub(crate) fn specimen() -> Specimen<Tree> {
    let l = 1.0 / 7.0;
    let system = Tree { m: 1.0 / N as f64, l, g: GRAVITY };
    let mut q = Vec::with_capacity(2 * N);
    // The middle and the half width of each mass's fan, from the horizontal.
    let mut fans: Vec<[f64; 2]> = Vec::with_capacity(N);
    for i in 0..N {
        let ([x, y], [middle, half]) = match i.checked_sub(1).map(|below| below / 2) {
            None => ([0.0, 0.0], [0.1, PI / 3.0]),
            Some(parent) => {
                let [middle, half] = fans[parent];
                let side = if i % 2 == 1 { 0.5 } else { -0.5 };
                ([q[2 * parent], q[2 * parent + 1]], [middle + side * half, 0.5 * half])
            }
        };
        q.extend([x + l * middle.cos(), y + l * middle.sin()]);
        fans.push([middle, half]);
    }
    Specimen::at_rest("tree", N, l, system, q)
}
