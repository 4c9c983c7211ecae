//! The discrete action of a step, evaluated from its definition.

use evi_core::generic::GenericSystem;
use evi_core::scheme::Frequency;
use num_dual::Dual64;

use crate::check::{Snapshot, norm};

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

impl Action {
    /// `[−D₁L_d, D₂L_d]`, the momenta that depart and arrive but for the impulses of the constraints.
    pub(crate) fn momenta<S: GenericSystem>(
        &self,
        system: &S,
        h: f64,
        before: &Snapshot,
        after: &Snapshot,
    ) -> [Vec<f64>; 2] {
        let derivative = |slot| self.derivative(system, h, before.t, (&before.q, &after.q), slot);
        let departing = derivative(Slot::Start).iter().map(|d| -d).collect();
        [departing, derivative(Slot::End)]
    }

    /// What one rounding of the ends of a step makes of its momenta: how far they move when both ends are moved a little, along two
    /// directions with other signs, per length of the ends, times `ε`.
    pub(crate) fn rounding<S: GenericSystem>(
        &self,
        system: &S,
        h: f64,
        before: &Snapshot,
        after: &Snapshot,
    ) -> f64 {
        /// Far above round-off, far below the curvature of anything.
        const MOVE: f64 = 1.0 / (1_u64 << 26) as f64;
        let size = norm(&before.q).max(norm(&after.q));
        if size == 0.0 {
            return 0.0;
        }
        let moved = |q: &[f64], signs: usize| -> Vec<f64> {
            q.iter()
                .enumerate()
                .map(|(i, q)| q + if signs >> (i % 4) & 1 == 0 { MOVE * size } else { -MOVE * size })
                .collect()
        };
        let at = |q0: &[f64], q1: &[f64]| self.derivative(system, h, before.t, (q0, q1), Slot::End);
        let here = at(&before.q, &after.q);
        let change = |there: Vec<f64>| {
            let difference: Vec<f64> = there.iter().zip(&here).map(|(a, b)| a - b).collect();
            norm(&difference)
        };
        let ends: f64 =
            [0b0000, 0b0110].map(|signs| change(at(&before.q, &moved(&after.q, signs)))).iter().sum();
        let starts: f64 =
            [0b0000, 0b0110].map(|signs| change(at(&moved(&before.q, signs), &after.q))).iter().sum();
        f64::EPSILON * (ends + starts) / MOVE
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
