//! The discrete Lagrangians of eight members: sums over the nodes of their curves, member by lane.
//!
//! The equations are those of `mechanics/step_equations`, whatever the mass is; coefficients and weights may follow the parameters of a member.

use super::lane_kkt::LaneKkt;
use super::lane_state::{nothing, side_by_side};
use crate::array::Array;
use crate::mechanics::DiscreteLagrangian;
use crate::scalar::{LANES, Lanes};
use crate::scheme::{InterpolationTable, NodeCoefficients};
use crate::system::{LagrangianGradient, MechanicalSystem};

/// One value per coordinate of eight members.
type Vector<S> = <S as MechanicalSystem>::PerCoordinate<Lanes>;

/// A node of one member: its time from the start of the step, its weight, and how the curve depends on the ends there.
pub(super) struct MemberNode<S: MechanicalSystem> {
    time: f64,
    weight: f64,
    coefficients: S::PerCoordinate<NodeCoefficients>,
}

impl<S: MechanicalSystem> MemberNode<S> {
    /// The nodes of an action.
    pub(super) fn all<T: InterpolationTable, const K: usize>(
        action: &DiscreteLagrangian<S, T, K>,
        h: f64,
    ) -> [Self; K] {
        core::array::from_fn(|node| Self {
            time: (0.5 + action.quadrature().offsets()[node]) * h,
            weight: action.quadrature().weights()[node],
            coefficients: Array::from_fn(|i| action.coefficients(node, i)),
        })
    }
}

/// The same node of eight members, with positions and `h` times velocities per end.
pub(super) struct LaneNode<S: MechanicalSystem> {
    time: Lanes,
    weight: Lanes,
    /// Per `q₀`, the difference held.
    even: Vector<S>,
    even_rate: Vector<S>,
    /// Per `q₀`, the end held.
    start: Vector<S>,
    start_rate: Vector<S>,
    /// Per `q₁`, or per difference.
    end: Vector<S>,
    end_rate: Vector<S>,
}

/// Where a step starts, and what it moves by.
pub(super) struct Curve<'a, S: MechanicalSystem> {
    pub(super) t: f64,
    pub(super) q: &'a Vector<S>,
    pub(super) difference: &'a Vector<S>,
}

/// `D₁L_d` and `D₂L_d`, with the discrete forces.
pub(super) struct EndMomenta<S: MechanicalSystem> {
    pub(super) start: Vector<S>,
    pub(super) end: Vector<S>,
}

impl<S: MechanicalSystem> LaneNode<S> {
    pub(super) fn of(members: [&MemberNode<S>; LANES]) -> Self {
        let all = |number: fn(&NodeCoefficients) -> f64| -> Vector<S> {
            side_by_side(|lane, i| number(&members[lane].coefficients[i]))
        };
        Self {
            time: Lanes::new(members.map(|member| member.time)),
            weight: Lanes::new(members.map(|member| member.weight)),
            even: all(|c| c.even),
            even_rate: all(|c| c.even_rate),
            start: all(NodeCoefficients::start),
            start_rate: all(NodeCoefficients::start_rate),
            end: all(NodeCoefficients::end),
            end_rate: all(NodeCoefficients::end_rate),
        }
    }

    /// Time, position and velocity.
    #[inline(always)]
    fn at<const FUSED: bool>(&self, h: f64, curve: &Curve<'_, S>) -> (Lanes, Vector<S>, Vector<S>) {
        let per_step = Lanes::splat(1.0 / h);
        let (mut x, mut v): (Vector<S>, Vector<S>) = (nothing(), nothing());
        for i in 0..S::N_COORDINATES {
            let d = curve.difference[i];
            x[i] = self.end[i].times_plus::<FUSED>(d, self.even[i] * curve.q[i]);
            v[i] = self.end_rate[i].times_plus::<FUSED>(d, self.even_rate[i] * curve.q[i]) * per_step;
        }
        (self.time + Lanes::splat(curve.t), x, v)
    }

    /// Adds what the node makes of `D₁L_d` and `D₂L_d`.
    #[inline(always)]
    pub(super) fn add_momenta<const FUSED: bool>(
        &self,
        constants: &S::PerConstant<Lanes>,
        h: f64,
        curve: &Curve<'_, S>,
        momenta: &mut EndMomenta<S>,
    ) {
        let (t, x, v) = self.at::<FUSED>(h, curve);
        let mut gradient = S::lagrangian_gradient(constants, t, &x, &v);
        if S::STRUCTURE.forces.exist() {
            let added = S::forces(constants, t, &x, &v, &nothing());
            for &i in S::STRUCTURE.forces.forced {
                gradient.force[i] = gradient.force[i] + added[i];
            }
        }
        self.add_gradient::<FUSED>(h, &gradient, &mut momenta.start, &self.start, &self.start_rate);
        self.add_gradient::<FUSED>(h, &gradient, &mut momenta.end, &self.end, &self.end_rate);
    }

    /// Adds `w (h a (∂L/∂q + f) + a' ∂L/∂v)`.
    #[inline(always)]
    fn add_gradient<const FUSED: bool>(
        &self,
        h: f64,
        gradient: &LagrangianGradient<S, Lanes>,
        sum: &mut Vector<S>,
        position: &Vector<S>,
        rate: &Vector<S>,
    ) {
        let step = Lanes::splat(h) * self.weight;
        for i in 0..S::N_COORDINATES {
            let of_force = (step * position[i]).times_plus::<FUSED>(gradient.force[i], sum[i]);
            sum[i] = (self.weight * rate[i]).times_plus::<FUSED>(gradient.momentum[i], of_force);
        }
    }

    /// Adds what the node makes of `D₁L_d`, and subtracts its part of `D₁D₂L_d` and of the derivatives of the discrete forces.
    #[inline(always)]
    pub(super) fn linearize<const FUSED: bool>(
        &self,
        constants: &S::PerConstant<Lanes>,
        h: f64,
        curve: &Curve<'_, S>,
        start: &mut Vector<S>,
        kkt: &mut LaneKkt<S>,
    ) {
        let (t, x, v) = self.at::<FUSED>(h, curve);
        let (mut gradient, hessian) = S::lagrangian_derivatives(constants, t, &x, &v);
        let step = Lanes::splat(h) * self.weight;
        let per_step = Lanes::splat(1.0 / h) * self.weight;
        S::for_each_qq(
            constants,
            &hessian,
            #[inline(always)]
            |row, col, value| kkt.add(row, col, -(step * self.start[row] * self.end[col] * value)),
        );
        S::for_each_vv(
            constants,
            &hessian,
            #[inline(always)]
            |row, col, value| {
                kkt.add(row, col, -(per_step * self.start_rate[row] * self.end_rate[col] * value));
            },
        );
        for entry in S::STRUCTURE.hessian.vq {
            let value = self.weight * entry.value(constants.as_ref(), hessian.as_ref());
            let (row, col) = (entry.row, entry.col);
            kkt.add(row, col, -(self.start_rate[row] * value * self.end[col]));
            // ∂²L/∂q∂v is the transpose: its row is the coordinate, its column the velocity.
            kkt.add(col, row, -(self.start[col] * value * self.end_rate[row]));
        }
        if S::STRUCTURE.forces.exist() {
            let (added, entries) = S::force_derivatives(constants, t, &x, &v, &nothing());
            for &i in S::STRUCTURE.forces.forced {
                gradient.force[i] = gradient.force[i] + added[i];
            }
            for entry in S::STRUCTURE.forces.q {
                let value = entry.value(constants.as_ref(), entries.as_ref());
                kkt.add(entry.row, entry.col, -(step * self.start[entry.row] * value * self.end[entry.col]));
            }
            for entry in S::STRUCTURE.forces.v {
                let value = self.weight * entry.value(constants.as_ref(), entries.as_ref());
                kkt.add(entry.row, entry.col, -(self.start[entry.row] * value * self.end_rate[entry.col]));
            }
        }
        self.add_gradient::<FUSED>(h, &gradient, start, &self.start, &self.start_rate);
    }
}
