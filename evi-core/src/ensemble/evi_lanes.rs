//! The lanes of [`Evi`] members: steps that are folded, those of the trapezoidal rule, and all others, by Newton's iteration.

use super::kicks::{FoldedLanes, LeapfrogLanes};
use super::lane_map::{LaneMap, LaneScheme};
use super::lane_state::LaneState;
use super::mask::LaneMask;
use super::multiplier_lanes::MultiplierLanes;
use super::newton_lanes::{NewtonLanes, NewtonMember};
use crate::integrator::{Evi, EviStep, Symmetric};
use crate::mechanics::{FoldedStep, LeapfrogStep, Mechanics, State};
use crate::scalar::LANES;
use crate::scheme::{Interpolant, SchemeError};
use crate::system::MechanicalSystem;

/// A step of one kind or another: a kick, a drift and a kick, `A` of quadratic Lagrangians and `B` of the trapezoidal rule, or `C` of any other.
pub(super) enum Kind<A, B, C> {
    /// Folded over its nodes.
    Folded(A),
    /// Of a potential that acts at the ends alone.
    Leapfrog(B),
    /// Whose positions and multipliers are found together.
    Newton(C),
}

/// The step of one member of an [`Evi`] ensemble.
pub struct EviMember<S: MechanicalSystem, F, const K: usize>(
    Kind<FoldedStep<S, F>, LeapfrogStep<S>, NewtonMember<S, K>>,
);

/// The steps of eight members, folded.
type Folded<S, F> = MultiplierLanes<S, FoldedLanes<S, F>>;
/// The steps of eight members by the trapezoidal rule.
type Leapfrog<S> = MultiplierLanes<S, LeapfrogLanes<S>>;

/// The steps of eight members of an [`Evi`] ensemble.
pub struct EviLanes<S: MechanicalSystem, F: Interpolant<S>, const K: usize>(
    Kind<Folded<S, F>, Leapfrog<S>, NewtonLanes<S, K>>,
);

impl<S: MechanicalSystem, const K: usize, F: Interpolant<S> + Clone> LaneScheme<S> for Evi<K, F> {
    type Member = EviMember<S, F, K>;
    type Lanes = EviLanes<S, F, K>;

    fn h(&self) -> f64 {
        self.step_size()
    }

    fn member(
        &self,
        mechanics: &Mechanics<S>,
        start: &State<S>,
    ) -> Result<Option<EviMember<S, F, K>>, SchemeError> {
        let h = self.step_size();
        let action = self.action(mechanics.clone())?;
        // Which kind it is the scene and the scheme decide, which members share.
        Ok(if FoldedStep::<S, F>::EXISTS {
            FoldedStep::new(&action).ok().map(Kind::Folded)
        } else if EviStep::<S, F, K>::MAY_LEAP && action.quadrature().is_trapezoid() {
            LeapfrogStep::new(&action.mechanics, h).ok().map(Kind::Leapfrog)
        } else if NewtonLanes::<S, K>::EXISTS {
            NewtonMember::new(&action, h, start).map(Kind::Newton)
        } else {
            None
        }
        .map(EviMember))
    }

    fn join(
        &self,
        mechanics: [&Mechanics<S>; LANES],
        members: [&EviMember<S, F, K>; LANES],
    ) -> EviLanes<S, F, K> {
        let (h, mixed) = (self.step_size(), "members of one ensemble have steps of one kind");
        EviLanes(match members[0].0 {
            Kind::Folded(_) => Kind::Folded(MultiplierLanes::new(
                h,
                mechanics,
                members.map(
                    |EviMember(kind)| {
                        if let Kind::Folded(step) = kind { step } else { unreachable!("{mixed}") }
                    },
                ),
            )),
            Kind::Leapfrog(_) => Kind::Leapfrog(MultiplierLanes::new(
                h,
                mechanics,
                members.map(
                    |EviMember(kind)| {
                        if let Kind::Leapfrog(step) = kind { step } else { unreachable!("{mixed}") }
                    },
                ),
            )),
            Kind::Newton(_) => Kind::Newton(NewtonLanes::new(
                h,
                mechanics,
                members.map(
                    |EviMember(kind)| {
                        if let Kind::Newton(step) = kind { step } else { unreachable!("{mixed}") }
                    },
                ),
            )),
        })
    }
}

impl<S: MechanicalSystem, F: Interpolant<S>, const K: usize> LaneMap<S> for EviLanes<S, F, K> {
    #[inline(always)]
    fn advance<const FUSED: bool>(&mut self, state: &mut LaneState<S>, active: LaneMask) -> LaneMask {
        // Branches on constants, so that a scene has code for one kind.
        match &mut self.0 {
            Kind::Folded(lanes) if FoldedStep::<S, F>::EXISTS => lanes.advance::<FUSED>(state, active),
            Kind::Leapfrog(lanes) if LeapfrogStep::<S>::EXISTS && !FoldedStep::<S, F>::EXISTS => {
                lanes.advance::<FUSED>(state, active)
            }
            Kind::Newton(lanes) if NewtonLanes::<S, K>::EXISTS && !FoldedStep::<S, F>::EXISTS => {
                lanes.advance::<FUSED>(state, active)
            }
            _ => active,
        }
    }

    fn forget(&mut self, lane: usize, mechanics: &Mechanics<S>, state: &State<S>) {
        match &mut self.0 {
            Kind::Folded(lanes) => lanes.forget(lane, mechanics, state),
            Kind::Leapfrog(lanes) => lanes.forget(lane, mechanics, state),
            Kind::Newton(lanes) => lanes.forget(lane, mechanics, state),
        }
    }
}
