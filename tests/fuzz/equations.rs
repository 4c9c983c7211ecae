//! Whether an accepted step satisfies its equations, found from its two ends and the user's functions alone.
//!
//! Residuals count in units of the round-off of their terms: of what displacements by a rounding of the largest coordinate, of the velocities and of
//! the time make of them, in every direction, by differences.

use evi_core::comparison::Solver;
use evi_core::generic::GenericSystem;
use num_dual::Dual64;

use crate::largest;

/// A state.
#[derive(Clone, Debug)]
pub(crate) struct Snapshot {
    pub(crate) t: f64,
    pub(crate) q: Vec<f64>,
    pub(crate) v: Vec<f64>,
    pub(crate) p: Vec<f64>,
}

/// Displacements are so many roundings: far above one, far below the curvature of anything.
const ROUNDINGS: f64 = 1e3;

impl Snapshot {
    pub(crate) fn of(solver: &dyn Solver) -> Self {
        let [q, v, p] = [solver.q(), solver.v(), solver.p()].map(<[f64]>::to_vec);
        Self { t: solver.t(), q, v, p }
    }

    pub(crate) fn numbers(&self) -> Vec<f64> {
        [&self.q[..], &self.v, &self.p, &[self.t]].concat()
    }

    /// The states beside this one, for velocities of this size.
    fn displaced(&self, speed: f64) -> Vec<Self> {
        let by = |size: f64| ROUNDINGS * f64::EPSILON * size;
        let later = Self { t: self.t * (1.0 + by(1.0)), ..self.clone() };
        let mut displaced = vec![later];
        for i in 0..self.q.len() {
            for sign in [-1.0, 1.0] {
                let mut moved = self.clone();
                moved.q[i] += sign * by(largest(&self.q));
                displaced.push(moved);
                let mut faster = self.clone();
                faster.v[i] += sign * by(speed);
                displaced.push(faster);
            }
        }
        displaced
    }
}

/// The largest of `residuals` in units of a rounding, given what they are at displaced states, and how much of each is round-off in any case.
fn in_roundings(residuals: &[f64], displaced: &[Vec<f64>], in_any_case: f64) -> f64 {
    let ratio = |(i, residual): (usize, &f64)| {
        let change = |other: &Vec<f64>| (other[i] - residual).abs();
        let larger = |a: f64, b: f64| if b <= a || a.is_nan() { a } else { b };
        // A NaN beside the state says that it stands at the rim of what is defined: nothing is known there.
        let allowed = displaced.iter().map(change).fold(ROUNDINGS * in_any_case, larger);
        if *residual == 0.0 || allowed.is_nan() { 0.0 } else { ROUNDINGS * residual.abs() / allowed }
    };
    largest(&residuals.iter().enumerate().map(ratio).collect::<Vec<_>>())
}

/// How far the end of a step is beside the constraints, the terms of which are of this size.
pub(crate) fn constraints<S: GenericSystem>(system: &S, end: &Snapshot, terms: f64) -> f64 {
    let at = |state: &Snapshot| {
        let mut residuals = vec![0.0; system.n_constraints()];
        system.constraints(state.t, &state.q, &mut residuals);
        residuals
    };
    in_roundings(&at(end), &end.displaced(0.0).iter().map(at).collect::<Vec<_>>(), f64::EPSILON * terms)
}

/// How far its velocity is beside the hidden constraints, where velocities have the round-off of this speed.
pub(crate) fn hidden_constraints<S: GenericSystem>(system: &S, end: &Snapshot, speed: f64) -> f64 {
    let at = |state: &Snapshot| {
        let q: Vec<Dual64> = state.q.iter().zip(&state.v).map(|(q, v)| Dual64::new(*q, *v)).collect();
        let mut residuals = vec![Dual64::from_re(0.0); system.n_constraints()];
        system.constraints(Dual64::new(state.t, 1.0), &q, &mut residuals);
        residuals.iter().map(|residual| residual.eps).collect::<Vec<_>>()
    };
    in_roundings(&at(end), &end.displaced(speed).iter().map(at).collect::<Vec<_>>(), 0.0)
}

/// How far a step of the midpoint rule is beside `p₀ + D₁L_d ∈ range G₀ᵀ` and `p₁ − D₂L_d ∈ range G₁ᵀ`, `L_d = h L` at the midpoint.
pub(crate) fn midpoint_action<S: GenericSystem>(
    system: &S,
    h: f64,
    before: &Snapshot,
    after: &Snapshot,
) -> f64 {
    [(Slot::Start, before), (Slot::End, after)]
        .map(|(slot, end)| {
            let normals = normals(system, end);
            let residual = |before: &Snapshot, after: &Snapshot| {
                let sign = if slot == Slot::Start { 1.0 } else { -1.0 };
                let derivative = derivative(system, h, before, after, slot);
                end.p.iter().zip(derivative).map(|(p, derivative)| p + sign * derivative).collect::<Vec<_>>()
            };
            let whole = residual(before, after);
            let here = tangential(whole.clone(), &normals);
            let displaced_starts = before.displaced(0.0).into_iter().map(|before| residual(&before, after));
            let displaced_ends = after.displaced(0.0).into_iter().map(|after| residual(before, &after));
            let displaced = displaced_starts.chain(displaced_ends);
            let displaced: Vec<Vec<f64>> = displaced.map(|there| tangential(there, &normals)).collect();
            in_roundings(&here, &displaced, f64::EPSILON * largest(&whole).max(largest(&end.p)))
        })
        .into_iter()
        .fold(0.0, f64::max)
}

#[derive(Clone, Copy, PartialEq)]
enum Slot {
    Start,
    End,
}

fn derivative<S: GenericSystem>(
    system: &S,
    h: f64,
    before: &Snapshot,
    after: &Snapshot,
    slot: Slot,
) -> Vec<f64> {
    let pairs = || before.q.iter().zip(&after.q);
    let mut q: Vec<Dual64> = pairs().map(|(a, b)| Dual64::from_re(0.5 * a + 0.5 * b)).collect();
    let mut v: Vec<Dual64> = pairs().map(|(a, b)| Dual64::from_re((b - a) / h)).collect();
    let t = Dual64::from_re(before.t + 0.5 * h);
    (0..q.len())
        .map(|i| {
            (q[i].eps, v[i].eps) = (0.5, if slot == Slot::Start { -1.0 / h } else { 1.0 / h });
            let along = system.lagrangian(t, &q, &v).eps;
            (q[i].eps, v[i].eps) = (0.0, 0.0);
            h * along
        })
        .collect()
}

/// An orthonormal basis of the gradients of the constraints.
fn normals<S: GenericSystem>(system: &S, at: &Snapshot) -> Vec<Vec<f64>> {
    /// What is left of a gradient beside the others, of so small a part of it, is round-off.
    const DEPENDENT: f64 = 1e-12;
    let (n, m) = (system.n_coordinates(), system.n_constraints());
    let mut rows = vec![vec![0.0; n]; m];
    let mut values = vec![Dual64::from_re(0.0); m];
    for i in 0..n {
        let q: Vec<Dual64> =
            at.q.iter().enumerate().map(|(k, q)| Dual64::new(*q, if k == i { 1.0 } else { 0.0 })).collect();
        system.constraints(Dual64::from_re(at.t), &q, &mut values);
        rows.iter_mut().zip(&values).for_each(|(row, value)| row[i] = value.eps);
    }
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for row in rows {
        // In its own unit: squares of it may leave the numbers.
        let unit = largest(&row);
        let row: Vec<f64> = row.iter().map(|x| x / unit).collect();
        let left = tangential(row, &basis);
        let length = left.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length > DEPENDENT {
            basis.push(left.iter().map(|x| x / length).collect());
        }
    }
    basis
}

/// What is left of `r` beside the normals: twice, for they are orthogonal to round-off only.
fn tangential(mut r: Vec<f64>, normals: &[Vec<f64>]) -> Vec<f64> {
    for normal in normals.iter().chain(normals) {
        let part: f64 = r.iter().zip(normal).map(|(r, normal)| r * normal).sum();
        r.iter_mut().zip(normal).for_each(|(r, normal)| *r -= part * normal);
    }
    r
}
