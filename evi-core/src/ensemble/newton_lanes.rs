//! Eight members' steps whose positions and multipliers are found together: Newton's iteration, member by lane.
//!
//! The equations are those of `mechanics/step_equations`, for every `L` that is quadratic in the velocity. A lane that has converged is frozen while others
//! go on; one that does not converge in `MOST` corrections, or whose matrix needs pivoting, is taken alone.

use super::lane_kkt::{LaneKkt, Unknowns};
use super::lane_map::LaneMap;
use super::lane_matrix::Slopes;
use super::lane_state::{LaneState, nothing, side_by_side};
use super::mask::LaneMask;
use super::node_lanes::{Curve, EndMomenta, LaneNode, MemberNode};
use crate::array::Array;
use crate::linear::{Cholesky, constraint_index};
use crate::mechanics::{DiscreteLagrangian, Mechanics, State};
use crate::newton::{LIGHT, STAGNATION, STAGNATION_RATIO, TARGET};
use crate::scalar::{LANES, Lanes, Scalar};
use crate::scheme::InterpolationTable;
use crate::system::MechanicalSystem;

/// Corrections that a group takes at most: alone, a member may take more.
const MOST: usize = 12;
/// The projection is linear; its second round takes what the elimination of the first has left.
const PROJECTIONS: usize = 2;

/// One value per coordinate, and per constraint, of eight members.
type Vector<S> = <S as MechanicalSystem>::PerCoordinate<Lanes>;
type Impulses<S> = <S as MechanicalSystem>::PerConstraint<Lanes>;

/// What a member brings into the steps of eight.
pub(super) struct NewtonMember<S: MechanicalSystem, const K: usize> {
    nodes: [MemberNode<S>; K],
    /// `√Mᵢᵢ` at the start.
    units: S::PerCoordinate<f64>,
}

/// The steps of eight members.
pub(super) struct NewtonLanes<S: MechanicalSystem, const K: usize> {
    h: f64,
    slopes: Slopes<S>,
    nodes: [LaneNode<S>; K],
    /// What a coordinate is multiplied with before lengths are compared.
    units: Vector<S>,
    kkt: LaneKkt<S>,
    /// What the last two steps have gone beside `h v`, the last one first: they affect the number of corrections, nothing else.
    sags: [Vector<S>; 2],
    /// `ℓ` of the last step.
    impulse: Impulses<S>,
}

impl<S: MechanicalSystem, const K: usize> NewtonMember<S, K> {
    /// `None` where the mass matrix is not positive definite: its elimination would need pivots.
    pub(super) fn new<T: InterpolationTable>(
        action: &DiscreteLagrangian<S, T, K>,
        h: f64,
        start: &State<S>,
    ) -> Option<Self> {
        let mass = action.mechanics.mass_at(&start.q);
        Cholesky::new::<S::PerCoordinate<f64>>(&mass)?;
        let units = Array::from_fn(|i| Scalar::sqrt(mass[i][i]));
        Some(Self { nodes: MemberNode::all(action, h), units })
    }
}

impl<S: MechanicalSystem, const K: usize> NewtonLanes<S, K> {
    /// Whether the scene's steps can be taken so.
    pub(super) const EXISTS: bool =
        S::STRUCTURE.is_quadratic_in_velocity() && S::N_INPUTS == 0 && S::STATED_RANK.is_none();

    pub(super) fn new(
        h: f64,
        mechanics: [&Mechanics<S>; LANES],
        members: [&NewtonMember<S, K>; LANES],
    ) -> Self {
        Self {
            h,
            slopes: Slopes::new(side_by_side(|lane, i| mechanics[lane].constants[i])),
            nodes: core::array::from_fn(|node| LaneNode::of(members.map(|member| &member.nodes[node]))),
            units: side_by_side(|lane, i| members[lane].units[i]),
            kkt: LaneKkt::new(),
            sags: core::array::from_fn(|_| nothing()),
            impulse: nothing(),
        }
    }

    /// Overwrites difference and impulse with the solution of the step equations in the lanes that are returned.
    #[inline(always)]
    fn solve<const FUSED: bool>(
        &mut self,
        state: &LaneState<S>,
        active: LaneMask,
        difference: &mut Vector<S>,
        impulse: &mut Impulses<S>,
    ) -> LaneMask {
        let n = S::N_COORDINATES;
        let constants = self.slopes.constants();
        let (t, t_end) = (Lanes::splat(state.t), Lanes::splat(state.t + self.h));
        let mut at_start: S::PerJacobianEntry<Lanes> = nothing();
        if S::N_CONSTRAINTS > 0 {
            (_, at_start) = S::constraint_derivatives(constants, t, &state.q);
        }
        let mut previous = Lanes::ZERO;
        let mut pending = active;
        for _ in 0..MOST {
            let mut row: Vector<S> = nothing();
            self.kkt.clear();
            let curve = Curve { t: state.t, q: &state.q, difference };
            for node in 0..K {
                self.nodes[node].linearize::<FUSED>(constants, self.h, &curve, &mut row, &mut self.kkt);
            }
            let mut residual: Unknowns<S> = nothing();
            if S::N_CONSTRAINTS > 0 {
                let mut end: Vector<S> = nothing();
                for i in 0..n {
                    end[i] = state.q[i] + difference[i];
                }
                let (beside, at_end) = S::constraint_derivatives(constants, t_end, &end);
                self.kkt.set_constraints(constants, &at_start, &at_end);
                let pull = self.slopes.pull::<FUSED>(&at_start, impulse);
                for i in 0..n {
                    row[i] = row[i] - pull[i];
                }
                for c in 0..S::N_CONSTRAINTS {
                    residual[constraint_index::<S>(c)] = beside[c];
                }
            }
            for i in 0..n {
                residual[i] = -(row[i] + state.p[i]);
            }
            self.kkt.factor::<FUSED>();
            self.kkt.solve::<FUSED>(&mut residual);
            let [mut square, mut reach, mut plain_square, mut plain_reach] = [Lanes::ZERO; 4];
            for i in 0..n {
                let moved = residual[i] * self.units[i];
                square = moved.times_plus::<FUSED>(moved, square);
                plain_square = residual[i].times_plus::<FUSED>(residual[i], plain_square);
                difference[i] = pending.select(difference[i] - residual[i], difference[i]);
                let plain = state.q[i].abs() + difference[i].abs();
                let size = plain * self.units[i];
                reach = size.times_plus::<FUSED>(size, reach);
                plain_reach = plain.times_plus::<FUSED>(plain, plain_reach);
            }
            for c in 0..S::N_CONSTRAINTS {
                let change = residual[constraint_index::<S>(c)];
                impulse[c] = pending.select(impulse[c] - change, impulse[c]);
            }
            let light = Lanes::splat(LIGHT * LIGHT) * plain_square / plain_reach;
            let relative = (square / reach).larger(light);
            pending = pending.without(converged::<FUSED>(relative, previous));
            if !pending.is_any() {
                break;
            }
            previous = relative;
        }
        active.without(pending)
    }

    /// Velocities and momenta on the hidden constraints, from those that arrive: `∂L/∂v(q₁, v₁) + G₁ᵀ N = p⁻`, `G₁ v₁ + ∂φ/∂t = 0`.
    #[inline(always)]
    fn project<const FUSED: bool>(&mut self, t: Lanes, q: &Vector<S>, v: &mut Vector<S>, p: &mut Vector<S>) {
        let n = S::N_COORDINATES;
        let constants = self.slopes.constants();
        let mut jacobian: S::PerJacobianEntry<Lanes> = nothing();
        self.kkt.clear();
        let (_, hessian) = S::lagrangian_derivatives(constants, t, q, v);
        let kkt = &mut self.kkt;
        S::for_each_vv(
            constants,
            &hessian,
            #[inline(always)]
            |row, col, value| kkt.add(row, col, value),
        );
        if S::N_CONSTRAINTS > 0 {
            (_, jacobian) = S::constraint_derivatives(constants, t, q);
            kkt.set_constraints(constants, &jacobian, &jacobian);
        }
        kkt.factor::<FUSED>();
        for _ in 0..PROJECTIONS {
            let momentum = S::lagrangian_gradient(constants, t, q, v).momentum;
            let mut change: Unknowns<S> = nothing();
            for i in 0..n {
                change[i] = p[i] - momentum[i];
            }
            if S::N_CONSTRAINTS > 0 {
                let rate = self.slopes.rate::<FUSED>(&jacobian, v);
                for c in 0..S::N_CONSTRAINTS {
                    change[constraint_index::<S>(c)] = -rate[c];
                }
            }
            self.kkt.solve::<FUSED>(&mut change);
            for i in 0..n {
                v[i] = v[i] + change[i];
            }
            if S::N_CONSTRAINTS > 0 {
                let mut removed: Impulses<S> = nothing();
                for c in 0..S::N_CONSTRAINTS {
                    removed[c] = change[constraint_index::<S>(c)];
                }
                let pull = self.slopes.pull::<FUSED>(&jacobian, &removed);
                for i in 0..n {
                    p[i] = p[i] - pull[i];
                }
            }
        }
    }
}

/// Where a correction of this relative length, by its square, leaves no further one: as `newton::Progress` decides it.
#[inline(always)]
fn converged<const FUSED: bool>(square: Lanes, previous: Lanes) -> LaneMask {
    const SQUARED: Lanes = Lanes::splat(TARGET * TARGET);
    let predicted = LaneMask::at_most(square * square, SQUARED * previous.larger(SQUARED));
    let small = LaneMask::at_most(square, Lanes::splat(STAGNATION * STAGNATION));
    let shrinks = LaneMask::at_most(square, Lanes::splat(STAGNATION_RATIO * STAGNATION_RATIO) * previous);
    let began = LaneMask::below(Lanes::ZERO, previous);
    predicted.or(small.and(began).without(shrinks))
}

impl<S: MechanicalSystem, const K: usize> LaneMap<S> for NewtonLanes<S, K> {
    #[inline(always)]
    fn advance<const FUSED: bool>(&mut self, state: &mut LaneState<S>, active: LaneMask) -> LaneMask {
        let n = S::N_COORDINATES;
        let (h, two) = (Lanes::splat(self.h), Lanes::splat(2.0));
        let mut difference: Vector<S> = nothing();
        for i in 0..n {
            let sag = two.times_plus::<FUSED>(self.sags[0][i], -self.sags[1][i]);
            difference[i] = h.times_plus::<FUSED>(state.v[i], sag);
        }
        let mut impulse = self.impulse.clone();
        let found = self.solve::<FUSED>(state, active, &mut difference, &mut impulse);
        let mut momenta = EndMomenta { start: nothing(), end: nothing() };
        let curve = Curve { t: state.t, q: &state.q, difference: &difference };
        for node in 0..K {
            self.nodes[node].add_momenta::<FUSED>(self.slopes.constants(), self.h, &curve, &mut momenta);
        }
        let (mut q, mut v, mut p): (Vector<S>, Vector<S>, _) = (nothing(), nothing(), momenta.end);
        for i in 0..n {
            q[i] = state.q[i] + difference[i];
            v[i] = difference[i] * Lanes::splat(1.0 / self.h);
        }
        self.project::<FUSED>(Lanes::splat(state.t + self.h), &q, &mut v, &mut p);
        for i in 0..n {
            let sag = difference[i] - h * state.v[i];
            self.sags[1][i] = self.sags[0][i];
            self.sags[0][i] = sag;
        }
        self.impulse = impulse;
        state.replace(q, v, p, active, active.without(found))
    }

    fn forget(&mut self, lane: usize, _mechanics: &Mechanics<S>, _state: &State<S>) {
        for sag in &mut self.sags {
            for i in 0..S::N_COORDINATES {
                sag[i] = sag[i].with(lane, 0.0);
            }
        }
        for c in 0..S::N_CONSTRAINTS {
            self.impulse[c] = self.impulse[c].with(lane, 0.0);
        }
    }
}
