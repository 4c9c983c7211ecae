//! Steps of eight members as functions of their impulses: `q₁(ℓ) = q₀ + D (p½ − G₀ᵀ ℓ)`.
//!
//! What only the rare way of a step needs again is computed again there: what a function apart is given lies in memory, and the way of most steps
//! would have to put it there.

use super::kicks::{LaneKicks, LaneLegendre};
use super::lane_matrix::{LaneMatrix, Slopes};
use super::lane_state::{LaneState, nothing, side_by_side};
use super::mask::LaneMask;
use crate::mechanics::{KickDriftKick, Mechanics};
use crate::newton;
use crate::scalar::{InstructionSet, LANES, Lanes, Scalar};
use crate::system::MechanicalSystem;

/// Of a term, twice what is round-off of it.
const TWICE: f64 = 2.0 * newton::TARGET;

/// What a drift couples.
pub(super) type Drift<S, K> = <<K as LaneKicks<S>>::Member as KickDriftKick<S>>::Coupling;

/// The numbers of eight steps that do not change.
pub(super) struct LaneStep<S: MechanicalSystem, K: LaneKicks<S>> {
    pub(super) h: f64,
    pub(super) slopes: Slopes<S>,
    pub(super) kicks: K,
    pub(super) drift: LaneMatrix<S, Drift<S, K>>,
    pub(super) legendre: LaneLegendre<S>,
    pub(super) instructions: InstructionSet,
    /// The members whose `G q` is the same everywhere on the constraints, and what is round-off of twice a residual there.
    forms: LaneMask,
    constant_round_off: S::PerConstraint<Lanes>,
}

/// Eight steps from their starts, up to their impulses.
pub(super) struct Span<'a, S: MechanicalSystem> {
    /// Time at the end.
    pub(super) end: f64,
    /// `q₀`.
    pub(super) start: &'a S::PerCoordinate<Lanes>,
    /// `p½`, without constraint forces.
    pub(super) kicked: S::PerCoordinate<Lanes>,
    /// `D p½`.
    pub(super) drifted: S::PerCoordinate<Lanes>,
    /// Varying entries of `G₀`.
    pub(super) jacobian: S::PerJacobianEntry<Lanes>,
}

/// Ends of steps with their impulses.
pub(super) struct Ends<S: MechanicalSystem> {
    pub(super) q: S::PerCoordinate<Lanes>,
    pub(super) impulse: S::PerConstraint<Lanes>,
    /// `G₀ᵀ ℓ`.
    pub(super) pull: S::PerCoordinate<Lanes>,
}

impl<S: MechanicalSystem, K: LaneKicks<S>> LaneStep<S, K> {
    pub(super) fn new(h: f64, mechanics: [&Mechanics<S>; LANES], members: [&K::Member; LANES]) -> Self {
        let reaches = mechanics.map(Mechanics::constant_reach);
        let constant_round_off =
            side_by_side(|lane, c| reaches[lane].as_ref().map_or(0.0, |reach| TWICE * reach[c].abs()));
        let forms = LaneMask::of(reaches.each_ref().map(Option::is_some));
        Self {
            forms,
            constant_round_off,
            h,
            slopes: Slopes::new(side_by_side(|lane, i| mechanics[lane].constants[i])),
            kicks: K::of(members),
            drift: LaneMatrix::of(members.map(|member| member.drift())),
            legendre: LaneLegendre::of(members.map(|member| member.legendre())),
            instructions: InstructionSet::detect(),
        }
    }

    /// The steps from `state`.
    #[inline(always)]
    pub(super) fn span<'a, const FUSED: bool>(&self, state: &'a LaneState<S>) -> Span<'a, S> {
        let t = Lanes::splat(state.t);
        let constants = self.slopes.constants();
        let kicked = self.kicks.kicked_at_start::<FUSED>(constants, t, &state.q, &state.p);
        let drifted = self.drift.times::<FUSED>(&kicked);
        let (_, jacobian) = S::constraint_derivatives(constants, t, &state.q);
        Span { end: state.t + self.h, start: &state.q, kicked, drifted, jacobian }
    }

    /// `q₁(ℓ) = q₀ − D G₀ᵀ ℓ + D p½`, with `G₀ᵀ ℓ`.
    #[inline(always)]
    pub(super) fn end<const FUSED: bool>(
        &self,
        span: &Span<'_, S>,
        impulse: S::PerConstraint<Lanes>,
    ) -> Ends<S> {
        let pull = self.slopes.pull::<FUSED>(&span.jacobian, &impulse);
        let moved = self.drift.times::<FUSED>(&pull);
        let mut q: S::PerCoordinate<Lanes> = nothing();
        for i in 0..S::N_COORDINATES {
            q[i] = (span.start[i] - moved[i]) + span.drifted[i];
        }
        Ends { q, impulse, pull }
    }

    /// What is round-off of twice the residuals of quadratic constraints: their terms are as large as `G q`.
    #[inline(always)]
    pub(super) fn twice_round_off<const FUSED: bool>(
        &self,
        jacobian: &S::PerJacobianEntry<Lanes>,
        q: &S::PerCoordinate<Lanes>,
    ) -> S::PerConstraint<Lanes> {
        let mut allowed = self.constant_round_off.clone();
        if self.forms.is_all() {
            return allowed;
        }
        let reach = self.slopes.along::<FUSED>(jacobian, q);
        for c in 0..S::N_CONSTRAINTS {
            allowed[c] = self.forms.select(allowed[c], Lanes::splat(TWICE) * reach[c].abs());
        }
        allowed
    }

    /// The constraints and their slopes at the ends.
    #[inline(always)]
    pub(super) fn constraints(
        &self,
        span: &Span<'_, S>,
        q: &S::PerCoordinate<Lanes>,
    ) -> (S::PerConstraint<Lanes>, S::PerJacobianEntry<Lanes>) {
        S::constraint_derivatives(self.slopes.constants(), Lanes::splat(span.end), q)
    }
}
