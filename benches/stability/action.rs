//! The discrete action of a step, evaluated from its definition.

use std::sync::LazyLock;

use evi_core::generic::GenericSystem;
use evi_core::scheme::Frequency;
use num_dual::Dual64;

use crate::check::{Snapshot, norm};
use crate::inner_points::{InnerPoints, Step};

/// What a step is a stationary point of.
#[derive(Clone, Debug)]
pub(crate) enum Equations {
    /// An action of the two ends.
    OfEnds(Action),
    /// One of points between them, too, on polynomials.
    OfPoints(&'static InnerPoints),
}

/// `Galerkin::<4>`.
pub(crate) static LOBATTO_4: LazyLock<InnerPoints> = LazyLock::new(|| InnerPoints::lobatto(4));
/// `Gauss::<4>`.
pub(crate) static GAUSS_4: LazyLock<InnerPoints> = LazyLock::new(|| InnerPoints::gauss(4));

/// `L_d(q₀, q₁) = h Σ wⱼ L(tⱼ, xⱼ, vⱼ)` on curves of one frequency: the nodes and weights of the rule, and the frequency.
#[derive(Clone, Debug)]
pub(crate) struct Action {
    pub(crate) nodes: &'static [(f64, f64)],
    pub(crate) frequency: Frequency,
}

pub(crate) const MIDPOINT: &[(f64, f64)] = &[(0.5, 1.0)];
pub(crate) const TRAPEZOID: &[(f64, f64)] = &[(0.0, 0.5), (1.0, 0.5)];
pub(crate) const SIMPSON: &[(f64, f64)] = &[(0.0, 1.0 / 6.0), (0.5, 4.0 / 6.0), (1.0, 1.0 / 6.0)];

/// `g₁`, `g₂`, `h g₁'`, `h g₂'` at a node.
#[derive(Clone, Copy)]
struct Weights {
    start: f64,
    end: f64,
    start_rate: f64,
    end_rate: f64,
}

#[derive(Clone, Copy)]
enum Slot {
    Start,
    End,
}

impl Equations {
    /// The momenta that depart and arrive but for the impulses of the constraints, and what one rounding of the ends of the step makes of the latter: how
    /// far they move when both ends are moved a little, along two directions with other signs, per length of the ends, times `ε`. `None` where the points
    /// between the ends are not found.
    pub(crate) fn momenta_with_rounding<S: GenericSystem>(
        &self,
        system: &S,
        h: f64,
        before: &Snapshot,
        after: &Snapshot,
    ) -> Option<([Vec<f64>; 2], f64)> {
        let ends = [&before.q[..], &after.q];
        match self {
            Self::OfEnds(action) => {
                let momenta = |ends: [&[f64]; 2]| Some(action.momenta(system, h, before.t, ends));
                let here = momenta(ends)?;
                let rounding = rounding(ends, &here[1], momenta)?;
                Some((here, rounding))
            }
            Self::OfPoints(points) => {
                let step = between(h, before, after, ends);
                let found = points.found(system, step)?;
                let here = points.momenta(system, step, &found);
                let rounding = rounding(ends, &here[1], |ends: [&[f64]; 2]| {
                    let step = between(h, before, after, ends);
                    let found = points.found_near(system, step, &found)?;
                    Some(points.momenta(system, step, &found))
                })?;
                Some((here, rounding))
            }
        }
    }
}

/// The step between these ends, at the velocities of others.
fn between<'a>(h: f64, before: &'a Snapshot, after: &'a Snapshot, q: [&'a [f64]; 2]) -> Step<'a> {
    Step { t: before.t, h, q, v: [&before.v, &after.v], inputs: &[] }
}

fn rounding(
    ends: [&[f64]; 2],
    here: &[f64],
    momenta: impl Fn([&[f64]; 2]) -> Option<[Vec<f64>; 2]>,
) -> Option<f64> {
    /// Far above round-off, far below the curvature of anything.
    const MOVE: f64 = 1.0 / (1_u64 << 26) as f64;
    let size = norm(ends[0]).max(norm(ends[1]));
    if size == 0.0 {
        return Some(0.0);
    }
    let moved = |q: &[f64], signs: usize| -> Vec<f64> {
        q.iter()
            .enumerate()
            .map(|(i, q)| q + if signs >> (i % 4) & 1 == 0 { MOVE * size } else { -MOVE * size })
            .collect()
    };
    let change = |ends: [&[f64]; 2]| -> Option<f64> {
        let [_, there] = momenta(ends)?;
        Some(norm(&there.iter().zip(here).map(|(a, b)| a - b).collect::<Vec<_>>()))
    };
    let mut changes = 0.0;
    for signs in [0b0000, 0b0110] {
        changes += change([ends[0], &moved(ends[1], signs)])? + change([&moved(ends[0], signs), ends[1]])?;
    }
    Some(f64::EPSILON * changes / MOVE)
}

impl Action {
    /// `[−D₁L_d, D₂L_d]`, the momenta that depart and arrive but for the impulses of the constraints.
    pub(crate) fn momenta<S: GenericSystem>(
        &self,
        system: &S,
        h: f64,
        t: f64,
        ends: [&[f64]; 2],
    ) -> [Vec<f64>; 2] {
        let derivative = |slot| self.derivative(system, h, t, (ends[0], ends[1]), slot);
        let departing = derivative(Slot::Start).iter().map(|d| -d).collect();
        [departing, derivative(Slot::End)]
    }

    fn derivative<S: GenericSystem>(
        &self,
        system: &S,
        h: f64,
        t: f64,
        (q0, q1): (&[f64], &[f64]),
        slot: Slot,
    ) -> Vec<f64> {
        let mut derivative = vec![0.0; q0.len()];
        for &(node, weight) in self.nodes {
            let g = self.weights(node, h);
            let at = |a: f64, b: f64| -> Vec<Dual64> {
                q0.iter().zip(q1).map(|(q0, q1)| Dual64::from_re(a * q0 + b * q1)).collect()
            };
            let mut x = at(g.start, g.end);
            let mut v = at(g.start_rate / h, g.end_rate / h);
            if self.is_straight() {
                // The same sum without the cancellation of large products.
                v = q0.iter().zip(q1).map(|(q0, q1)| Dual64::from_re((q1 - q0) / h)).collect();
            }
            let (along, along_rate) = match slot {
                Slot::Start => (g.start, g.start_rate / h),
                Slot::End => (g.end, g.end_rate / h),
            };
            for i in 0..q0.len() {
                (x[i].eps, v[i].eps) = (along, along_rate);
                derivative[i] += h * weight * system.lagrangian(Dual64::from_re(t + node * h), &x, &v).eps;
                (x[i].eps, v[i].eps) = (0.0, 0.0);
            }
        }
        derivative
    }

    fn is_straight(&self) -> bool {
        self.frequency.value() == 0.0
    }

    /// As the paper has them: `g₁ = sin u(1 − τ) / sin u`, `g₂ = sin uτ / sin u`.
    fn weights(&self, node: f64, h: f64) -> Weights {
        let u = self.frequency.value() * h;
        if self.is_straight() {
            return Weights { start: 1.0 - node, end: node, start_rate: -1.0, end_rate: 1.0 };
        }
        let is_trigonometric = matches!(self.frequency, Frequency::Trigonometric(_));
        let sine = |x: f64| if is_trigonometric { x.sin() } else { x.sinh() };
        let cosine = |x: f64| if is_trigonometric { x.cos() } else { x.cosh() };
        Weights {
            start: sine(u * (1.0 - node)) / sine(u),
            end: sine(u * node) / sine(u),
            start_rate: -u * cosine(u * (1.0 - node)) / sine(u),
            end_rate: u * cosine(u * node) / sine(u),
        }
    }
}

#[cfg(test)]
mod tests {
    use evi_core::comparison::Solver;
    use evi_core::prelude::*;
    use evi_examples::{DoublePendulum, GRAVITY, StiffSpringPendulum};

    use super::*;
    use crate::check::{Promise, ROUNDINGS, Velocity, step};

    const H: f64 = 0.05;

    /// Roundings by which the equations of the points of a step are left, as it is and with a momentum that is beside it by a part in 1e8.
    fn roundings<S: MechanicalSystem + GenericSystem + Clone>(
        system: &S,
        scheme: impl Scheme<S>,
        points: &'static InnerPoints,
        (q, v): (S::PerCoordinate<f64>, S::PerCoordinate<f64>),
    ) -> [f64; 2] {
        let mut run = Simulation::new(system.clone(), scheme).start(q, v).expect("a start");
        let promise = Promise {
            constraints: true,
            hidden_constraints: Velocity::ProjectedOnce,
            conditioning: [1.0, 1e9],
            action: Some(Equations::OfPoints(points)),
        };
        let mut largest = [0.0_f64, f64::INFINITY];
        for _ in 0..20 {
            let before = Snapshot::of(&run as &dyn Solver);
            run.advance().expect("a step");
            let after = Snapshot::of(&run as &dyn Solver);
            let found = step(system, &promise, H, &before, &after);
            assert!(found.has_action, "no points at t = {}", before.t);
            let mut beside = after.clone();
            beside.p.iter_mut().for_each(|p| *p *= 1.0 + 1e-8);
            largest[0] = largest[0].max(found.roundings);
            largest[1] = largest[1].min(step(system, &promise, H, &before, &beside).roundings);
        }
        println!("{largest:?}");
        largest
    }

    #[test]
    fn points_between_the_ends_tell_a_step_from_one_beside_it() {
        let pendulum = DoublePendulum { m1: 1.0, m2: 0.5, l1: 1.0, l2: 0.8, g: GRAVITY };
        let start = pendulum.at_angles(0.7, -0.4);
        let spring = StiffSpringPendulum { m: 1.3, l: 0.9, k: 300.0, g: GRAVITY };
        for [here, beside] in [
            roundings(&pendulum, Galerkin::<4>::new(H), &LOBATTO_4, (start.q, start.v)),
            roundings(&spring, Gauss::<4>::new(H), &GAUSS_4, ([0.9, 0.1], [0.2, -0.5])),
        ] {
            // 0.6 measured.
            assert!(here <= 1.0 && beside >= ROUNDINGS, "{here}, {beside}");
        }
    }
}
