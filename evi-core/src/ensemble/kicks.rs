//! Steps of eight members without their constraint forces: a kick, a drift and a kick, with the numbers of each member in its lane.
//!
//! In: the steps of [`FoldedStep`] and [`LeapfrogStep`], folded for every member by itself. Out: the same maps on lanes.

use super::lane_matrix::LaneMatrix;
use super::lane_state::{nothing, side_by_side};
use crate::mechanics::{
    AsMass, AsScene, ConstantLegendre, CoordinateMatrix, FoldedStep, KickDriftKick, LeapfrogStep,
};
use crate::scalar::{LANES, Lanes};
use crate::scheme::Interpolant;
use crate::system::MechanicalSystem;

/// A step without its constraint forces, `p½ = p₀ + k₀`, `q₁ = q₀ + D p½`, `p⁻ = p½ + k₁`, of eight members.
pub(super) trait LaneKicks<S: MechanicalSystem> {
    /// What it is made of, per member.
    type Member: KickDriftKick<S>;

    /// The steps of eight members.
    fn of(members: [&Self::Member; LANES]) -> Self;

    /// `p½` without constraint forces.
    fn kicked_at_start<const FUSED: bool>(
        &self,
        constants: &S::PerConstant<Lanes>,
        t: Lanes,
        q: &S::PerCoordinate<Lanes>,
        p: &S::PerCoordinate<Lanes>,
    ) -> S::PerCoordinate<Lanes>;

    /// `p⁻` from `p½`.
    fn kicked_at_end<const FUSED: bool>(
        &self,
        constants: &S::PerConstant<Lanes>,
        t: Lanes,
        q: &S::PerCoordinate<Lanes>,
        p: &S::PerCoordinate<Lanes>,
    ) -> S::PerCoordinate<Lanes>;
}

/// An affine force times a time, per member.
struct LaneKick<S: MechanicalSystem> {
    linear: LaneMatrix<S, AsScene>,
    constant: S::PerCoordinate<Lanes>,
}

/// The linear part of a member's kick, and its constant.
type MemberKick<'a, S> = (&'a CoordinateMatrix<S, AsScene>, &'a <S as MechanicalSystem>::PerCoordinate<f64>);

impl<S: MechanicalSystem> LaneKick<S> {
    /// The kicks of eight members.
    fn of(kicks: [MemberKick<'_, S>; LANES]) -> Self {
        Self {
            linear: LaneMatrix::of(kicks.map(|(linear, _)| linear)),
            constant: side_by_side(|lane, i| kicks[lane].1[i]),
        }
    }

    #[inline(always)]
    fn apply<const FUSED: bool>(
        &self,
        is_straight: bool,
        q: &S::PerCoordinate<Lanes>,
        p: &S::PerCoordinate<Lanes>,
    ) -> S::PerCoordinate<Lanes> {
        let mut kicked: S::PerCoordinate<Lanes> = nothing();
        if is_straight && S::STRUCTURE.hessian.qq.is_empty() {
            for i in 0..S::N_COORDINATES {
                kicked[i] = p[i] + self.constant[i];
            }
        } else {
            let linear = self.linear.times::<FUSED>(q);
            for i in 0..S::N_COORDINATES {
                kicked[i] = p[i] + (linear[i] + self.constant[i]);
            }
        }
        kicked
    }
}

/// Of quadratic Lagrangians.
pub(super) struct FoldedLanes<S: MechanicalSystem, F> {
    start: LaneKick<S>,
    end: LaneKick<S>,
    curves: core::marker::PhantomData<F>,
}

impl<S: MechanicalSystem, F: Interpolant<S>> LaneKicks<S> for FoldedLanes<S, F> {
    type Member = FoldedStep<S, F>;

    fn of(members: [&FoldedStep<S, F>; LANES]) -> Self {
        Self {
            start: LaneKick::of(members.map(FoldedStep::start_kick)),
            end: LaneKick::of(members.map(FoldedStep::end_kick)),
            curves: core::marker::PhantomData,
        }
    }

    #[inline(always)]
    fn kicked_at_start<const FUSED: bool>(
        &self,
        _constants: &S::PerConstant<Lanes>,
        _t: Lanes,
        q: &S::PerCoordinate<Lanes>,
        p: &S::PerCoordinate<Lanes>,
    ) -> S::PerCoordinate<Lanes> {
        self.start.apply::<FUSED>(F::IS_STRAIGHT, q, p)
    }

    #[inline(always)]
    fn kicked_at_end<const FUSED: bool>(
        &self,
        _constants: &S::PerConstant<Lanes>,
        _t: Lanes,
        q: &S::PerCoordinate<Lanes>,
        p: &S::PerCoordinate<Lanes>,
    ) -> S::PerCoordinate<Lanes> {
        self.end.apply::<FUSED>(F::IS_STRAIGHT, q, p)
    }
}

/// Of the trapezoidal rule on straight curves.
pub(super) struct LeapfrogLanes<S: MechanicalSystem> {
    half_h: Lanes,
    momentum_at_rest: S::PerCoordinate<Lanes>,
}

impl<S: MechanicalSystem> LeapfrogLanes<S> {
    /// `p + ½h ∂L/∂q ± a`.
    #[inline(always)]
    fn kicked<const FUSED: bool>(
        &self,
        constants: &S::PerConstant<Lanes>,
        (t, q): (Lanes, &S::PerCoordinate<Lanes>),
        p: &S::PerCoordinate<Lanes>,
        at_rest: impl Fn(Lanes, Lanes) -> Lanes,
    ) -> S::PerCoordinate<Lanes> {
        let force = S::lagrangian_gradient(constants, t, q, &nothing()).force;
        let mut kicked: S::PerCoordinate<Lanes> = nothing();
        for i in 0..S::N_COORDINATES {
            kicked[i] = self.half_h.times_plus::<FUSED>(force[i], p[i]);
            if !S::STRUCTURE.momentum_vanishes_at_rest {
                kicked[i] = at_rest(kicked[i], self.momentum_at_rest[i]);
            }
        }
        kicked
    }
}

impl<S: MechanicalSystem> LaneKicks<S> for LeapfrogLanes<S> {
    type Member = LeapfrogStep<S>;

    fn of(members: [&LeapfrogStep<S>; LANES]) -> Self {
        Self {
            half_h: Lanes::new(members.map(LeapfrogStep::half_h)),
            momentum_at_rest: side_by_side(|lane, i| members[lane].legendre().momentum_at_rest()[i]),
        }
    }

    #[inline(always)]
    fn kicked_at_start<const FUSED: bool>(
        &self,
        constants: &S::PerConstant<Lanes>,
        t: Lanes,
        q: &S::PerCoordinate<Lanes>,
        p: &S::PerCoordinate<Lanes>,
    ) -> S::PerCoordinate<Lanes> {
        self.kicked::<FUSED>(constants, (t, q), p, |p, rest| p - rest)
    }

    #[inline(always)]
    fn kicked_at_end<const FUSED: bool>(
        &self,
        constants: &S::PerConstant<Lanes>,
        t: Lanes,
        q: &S::PerCoordinate<Lanes>,
        p: &S::PerCoordinate<Lanes>,
    ) -> S::PerCoordinate<Lanes> {
        self.kicked::<FUSED>(constants, (t, q), p, |p, rest| p + rest)
    }
}

/// The Legendre transforms `v = M⁻¹ (p − a)` of eight members with constant masses.
pub(super) struct LaneLegendre<S: MechanicalSystem> {
    pub(super) inverse_mass: LaneMatrix<S, AsMass>,
    momentum_at_rest: S::PerCoordinate<Lanes>,
}

impl<S: MechanicalSystem> LaneLegendre<S> {
    pub(super) fn of(members: [&ConstantLegendre<S>; LANES]) -> Self {
        Self {
            inverse_mass: LaneMatrix::of(members.map(ConstantLegendre::inverse_mass)),
            momentum_at_rest: side_by_side(|lane, i| members[lane].momentum_at_rest()[i]),
        }
    }

    /// `M v = p − a`.
    #[inline(always)]
    pub(super) fn moving(&self, p: &S::PerCoordinate<Lanes>) -> S::PerCoordinate<Lanes> {
        let mut moving = p.clone();
        if !S::STRUCTURE.momentum_vanishes_at_rest {
            for i in 0..S::N_COORDINATES {
                moving[i] = p[i] - self.momentum_at_rest[i];
            }
        }
        moving
    }

    /// The velocities of momenta.
    #[inline(always)]
    pub(super) fn velocity<const FUSED: bool>(&self, p: &S::PerCoordinate<Lanes>) -> S::PerCoordinate<Lanes> {
        self.inverse_mass.times::<FUSED>(&self.moving(p))
    }
}
