//! Whether an accepted step satisfies its equations, found from its two ends and the user's functions alone.
//!
//! Residuals count in units of the round-off of their terms: of what displacements by a rounding of the largest coordinate, of the velocities and of
//! the time make of them, in every direction, by differences.

use evi_core::comparison::Solver;
use evi_core::generic::GenericSystem;
use num_dual::Dual64;

use crate::inner_points::{InnerPoints, Step, gradient};
use crate::largest;

/// A state.
#[derive(Clone, Debug)]
pub(crate) struct Snapshot {
    pub(crate) t: f64,
    pub(crate) q: Vec<f64>,
    pub(crate) v: Vec<f64>,
    pub(crate) p: Vec<f64>,
}

/// Displacements are so many roundings: far above one, far below the curvature of anything. The longer ones are for where a slope vanishes, but not the
/// round-off of its terms.
const ROUNDINGS: [f64; 2] = [1e3, 1e6];

/// Something beside a state, by so many roundings.
struct Displaced<T> {
    roundings: f64,
    to: T,
}

impl<T> Displaced<T> {
    fn is_close(&self) -> bool {
        self.roundings == ROUNDINGS[0]
    }

    fn map<U>(self, f: impl FnOnce(T) -> U) -> Displaced<U> {
        Displaced { roundings: self.roundings, to: f(self.to) }
    }
}

impl<T> Displaced<Option<T>> {
    /// What is there; of what is not found farther away, nothing, of what is not found close by, that nothing is.
    fn known(self) -> Option<Option<Displaced<T>>> {
        let is_close = self.is_close();
        match self.to {
            Some(to) => Some(Some(Displaced { roundings: self.roundings, to })),
            None => is_close.then_some(None),
        }
    }
}

impl Snapshot {
    pub(crate) fn of(solver: &dyn Solver) -> Self {
        let [q, v, p] = [solver.q(), solver.v(), solver.p()].map(<[f64]>::to_vec);
        Self { t: solver.t(), q, v, p }
    }

    pub(crate) fn numbers(&self) -> Vec<f64> {
        [&self.q[..], &self.v, &self.p, &[self.t]].concat()
    }

    /// The states beside this one, for velocities of this size.
    fn displaced(&self, speed: f64) -> Vec<Displaced<Self>> {
        let mut displaced = self.displaced_positions();
        for roundings in ROUNDINGS {
            for i in 0..self.q.len() {
                for sign in [-1.0, 1.0] {
                    let mut faster = self.clone();
                    faster.v[i] += sign * roundings * f64::EPSILON * speed;
                    displaced.push(Displaced { roundings, to: faster });
                }
            }
        }
        displaced
    }

    /// Those at other places, and later.
    fn displaced_positions(&self) -> Vec<Displaced<Self>> {
        let mut displaced = Vec::new();
        for roundings in ROUNDINGS {
            let by = |size: f64| roundings * f64::EPSILON * size;
            let later = Self { t: self.t * (1.0 + by(1.0)), ..self.clone() };
            displaced.push(Displaced { roundings, to: later });
            for i in 0..self.q.len() {
                for sign in [-1.0, 1.0] {
                    let mut moved = self.clone();
                    moved.q[i] += sign * by(largest(&self.q));
                    displaced.push(Displaced { roundings, to: moved });
                }
            }
        }
        displaced
    }
}

/// The largest of `residuals` in units of a rounding, given what they are at displaced states, and how much of each is round-off in any case.
fn in_roundings(residuals: &[f64], displaced: &[Displaced<Vec<f64>>], in_any_case: f64) -> f64 {
    let ratio = |(i, residual): (usize, &f64)| {
        let of_one = |other: &Displaced<Vec<f64>>| (other.to[i] - residual).abs() / other.roundings;
        let larger = |a: f64, b: f64| if b <= a || a.is_nan() { a } else { b };
        // A NaN close to the state says that it stands at the rim of what is defined: nothing is known there.
        let is_known = |other: &&Displaced<Vec<f64>>| other.is_close() || !other.to[i].is_nan();
        let allowed = displaced.iter().filter(is_known).map(of_one).fold(in_any_case, larger);
        if *residual == 0.0 || allowed.is_nan() { 0.0 } else { residual.abs() / allowed }
    };
    largest(&residuals.iter().enumerate().map(ratio).collect::<Vec<_>>())
}

fn around(
    displaced: Vec<Displaced<Snapshot>>,
    at: impl Fn(&Snapshot) -> Vec<f64>,
) -> Vec<Displaced<Vec<f64>>> {
    displaced.into_iter().map(|state| state.map(|state| at(&state))).collect()
}

/// How far the end of a step is beside the constraints, the terms of which are of this size.
pub(crate) fn constraints<S: GenericSystem>(system: &S, end: &Snapshot, terms: f64) -> f64 {
    let at = |state: &Snapshot| {
        let mut residuals = vec![0.0; system.n_constraints()];
        system.constraints(state.t, &state.q, &mut residuals);
        residuals
    };
    in_roundings(&at(end), &around(end.displaced(0.0), at), f64::EPSILON * terms)
}

/// How far its velocity is beside the hidden constraints, where velocities have the round-off of this speed.
pub(crate) fn hidden_constraints<S: GenericSystem>(system: &S, end: &Snapshot, speed: f64) -> f64 {
    let at = |state: &Snapshot| {
        let q: Vec<Dual64> = state.q.iter().zip(&state.v).map(|(q, v)| Dual64::new(*q, *v)).collect();
        let mut residuals = vec![Dual64::from_re(0.0); system.n_constraints()];
        system.constraints(Dual64::new(state.t, 1.0), &q, &mut residuals);
        residuals.iter().map(|residual| residual.eps).collect::<Vec<_>>()
    };
    in_roundings(&at(end), &around(end.displaced(speed), at), 0.0)
}

/// What a step is a stationary point of: with forces, what their virtual work is balanced by.
#[derive(Clone, Debug)]
pub(crate) enum Equations {
    /// `h L` at the midpoint.
    Midpoint,
    /// The action of a polynomial through points that are not stored.
    Points(InnerPoints),
}

impl Equations {
    /// How far a step is beside `p₀ + D₁L_d ∈ range G₀ᵀ` and `p₁ − D₂L_d ∈ range G₁ᵀ`; `None` where the points between its ends are not found.
    pub(crate) fn residual<S: GenericSystem>(
        &self,
        system: &S,
        (h, inputs): (f64, &[f64]),
        before: &Snapshot,
        after: &Snapshot,
    ) -> Option<f64> {
        match self {
            Self::Midpoint => {
                let momenta =
                    |before: &Snapshot, after: &Snapshot| Some(of_midpoint(system, h, inputs, before, after));
                residual(system, before, after, momenta)
            }
            Self::Points(points) => {
                if !resolves(system, (h, inputs), before, after) {
                    return None;
                }
                let found = points.found(system, ends(h, inputs, before, after))?;
                residual(system, before, after, |before, after| {
                    let step = ends(h, inputs, before, after);
                    let found = points.found_near(system, step, &found)?;
                    Some(points.momenta(system, step, &found))
                })
            }
        }
    }
}

/// Whether a step is short beside the motion. Between the ends of another one several curves may pass, and the ends do not tell which one it has found.
///
/// Over the way of the step the forces change the momentum by less than itself: `h² ∂F/∂q < m`.
fn resolves<S: GenericSystem>(
    system: &S,
    (h, inputs): (f64, &[f64]),
    before: &Snapshot,
    after: &Snapshot,
) -> bool {
    /// What is random has lengths and times of 1.
    const LONGEST_TIME: f64 = 0.2;
    const LONGEST_WAY: f64 = 0.5;
    const PARTS: f64 = 64.0;
    let chord: Vec<f64> = before.q.iter().zip(&after.q).map(|(start, end)| end - start).collect();
    let way = largest(&chord).max(h.abs() * largest(&before.v).max(largest(&after.v)));
    // Written so that a NaN is long.
    let is_short = h.abs() <= LONGEST_TIME && way <= LONGEST_WAY;
    let most = largest(&before.p).max(largest(&after.p)) / PARTS;
    let changes_slowly = |part: f64| {
        let along = |from: &[f64], to: &[f64]| -> Vec<f64> {
            from.iter().zip(to).map(|(from, to)| from + part * (to - from)).collect()
        };
        let (mut q, v, t) = (along(&before.q, &after.q), along(&before.v, &after.v), before.t + part * h);
        let [here, _] = gradient(system, t, &q, &v, inputs);
        (0..q.len()).all(|i| {
            let at = q[i];
            q[i] = at + way / PARTS;
            let [there, _] = gradient(system, t, &q, &v, inputs);
            q[i] = at;
            let change: Vec<f64> = here.iter().zip(&there).map(|(here, there)| h * (there - here)).collect();
            largest(&change) <= most
        })
    };
    is_short && [0.0, 0.25, 0.5, 0.75, 1.0].into_iter().all(changes_slowly)
}

fn ends<'a>(h: f64, inputs: &'a [f64], before: &'a Snapshot, after: &'a Snapshot) -> Step<'a> {
    Step { t: before.t, h, q: [&before.q, &after.q], v: [&before.v, &after.v], inputs }
}

/// The larger of both, where `momenta` are `[−D₁L_d, D₂L_d]` of a step.
fn residual<S: GenericSystem>(
    system: &S,
    before: &Snapshot,
    after: &Snapshot,
    momenta: impl Fn(&Snapshot, &Snapshot) -> Option<[Vec<f64>; 2]>,
) -> Option<f64> {
    let here = momenta(before, after)?;
    let starts =
        before.displaced_positions().into_iter().map(|state| state.map(|start| momenta(&start, after)));
    let ends = after.displaced_positions().into_iter().map(|state| state.map(|end| momenta(before, &end)));
    let displaced =
        starts.chain(ends).filter_map(Displaced::known).collect::<Option<Vec<Displaced<[Vec<f64>; 2]>>>>()?;
    let of_end = |(slot, end): (usize, &Snapshot)| {
        let normals = normals(system, end);
        let left = |momenta: &[Vec<f64>; 2]| -> Vec<f64> {
            end.p.iter().zip(&momenta[slot]).map(|(p, momentum)| p - momentum).collect()
        };
        let whole = left(&here);
        let in_any_case = f64::EPSILON * largest(&whole).max(largest(&end.p));
        let displaced: Vec<Displaced<Vec<f64>>> = displaced
            .iter()
            .map(|there| Displaced { roundings: there.roundings, to: tangential(left(&there.to), &normals) })
            .collect();
        in_roundings(&tangential(whole, &normals), &displaced, in_any_case)
    };
    Some([(0, before), (1, after)].into_iter().map(of_end).fold(0.0, f64::max))
}

/// The momenta of `h L` at the midpoint.
fn of_midpoint<S: GenericSystem>(
    system: &S,
    h: f64,
    inputs: &[f64],
    before: &Snapshot,
    after: &Snapshot,
) -> [Vec<f64>; 2] {
    let pairs = || before.q.iter().zip(&after.q);
    let q: Vec<f64> = pairs().map(|(a, b)| 0.5 * a + 0.5 * b).collect();
    let v: Vec<f64> = pairs().map(|(a, b)| (b - a) / h).collect();
    let [force, momentum] = gradient(system, before.t + 0.5 * h, &q, &v, inputs);
    let with = |sign: f64| momentum.iter().zip(&force).map(|(p, f)| p + sign * 0.5 * h * f).collect();
    [with(-1.0), with(1.0)]
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
