//! The lanes of [`Evi`] members: steps that are folded, and those of the trapezoidal rule.

use super::kicks::{FoldedLanes, LeapfrogLanes};
use super::lane_map::{LaneMap, LaneScheme};
use super::lane_state::LaneState;
use super::mask::LaneMask;
use super::multiplier_lanes::MultiplierLanes;
use crate::integrator::{Evi, EviStep, Symmetric};
use crate::mechanics::{FoldedStep, LeapfrogStep, Mechanics, State};
use crate::scalar::LANES;
use crate::scheme::{Interpolant, SchemeError};
use crate::system::MechanicalSystem;

/// A step that is a kick, a drift and a kick, of one kind or the other: `A` of quadratic Lagrangians, `B` of the trapezoidal rule.
pub(super) enum Kind<A, B> {
    /// Folded over its nodes.
    Folded(A),
    /// Of a potential that acts at the ends alone.
    Leapfrog(B),
}

/// The step of one member of an [`Evi`] ensemble.
pub struct EviMember<S: MechanicalSystem, F>(Kind<FoldedStep<S, F>, LeapfrogStep<S>>);

/// The steps of eight members, folded.
type Folded<S, F> = MultiplierLanes<S, FoldedLanes<S, F>>;
/// The steps of eight members by the trapezoidal rule.
type Leapfrog<S> = MultiplierLanes<S, LeapfrogLanes<S>>;

/// The steps of eight members of an [`Evi`] ensemble.
pub struct EviLanes<S: MechanicalSystem, F: Interpolant<S>>(Kind<Folded<S, F>, Leapfrog<S>>);

impl<S: MechanicalSystem, const K: usize, F: Interpolant<S> + Clone> LaneScheme<S> for Evi<K, F> {
    type Member = EviMember<S, F>;
    type Lanes = EviLanes<S, F>;

    fn h(&self) -> f64 {
        self.step_size()
    }

    fn member(
        &self,
        mechanics: &Mechanics<S>,
        _start: &State<S>,
    ) -> Result<Option<EviMember<S, F>>, SchemeError> {
        if !FoldedStep::<S, F>::EXISTS && !EviStep::<S, F, K>::MAY_LEAP {
            return Ok(None);
        }
        let action = self.action(mechanics.clone())?;
        Ok(if FoldedStep::<S, F>::EXISTS {
            FoldedStep::new(&action).ok().map(Kind::Folded)
        } else if action.quadrature().is_trapezoid() {
            LeapfrogStep::new(&action.mechanics, self.step_size()).ok().map(Kind::Leapfrog)
        } else {
            None
        }
        .map(EviMember))
    }

    fn join(&self, mechanics: [&Mechanics<S>; LANES], members: [&EviMember<S, F>; LANES]) -> EviLanes<S, F> {
        let h = self.step_size();
        // Which kind it is the scene and the scheme decide, which members share.
        let mixed = "members of one ensemble have steps of one kind";
        EviLanes(match members[0].0 {
            Kind::Folded(_) => Kind::Folded(MultiplierLanes::new(
                h,
                mechanics,
                members.map(|member| match &member.0 {
                    Kind::Folded(step) => step,
                    Kind::Leapfrog(_) => unreachable!("{mixed}"),
                }),
            )),
            Kind::Leapfrog(_) => Kind::Leapfrog(MultiplierLanes::new(
                h,
                mechanics,
                members.map(|member| match &member.0 {
                    Kind::Leapfrog(step) => step,
                    Kind::Folded(_) => unreachable!("{mixed}"),
                }),
            )),
        })
    }
}

impl<S: MechanicalSystem, F: Interpolant<S>> LaneMap<S> for EviLanes<S, F> {
    #[inline(always)]
    fn advance<const FUSED: bool>(&mut self, state: &mut LaneState<S>, active: LaneMask) -> LaneMask {
        // Branches on constants, so that a scene has code for one kind.
        match &mut self.0 {
            Kind::Folded(lanes) if FoldedStep::<S, F>::EXISTS => lanes.advance::<FUSED>(state, active),
            Kind::Leapfrog(lanes) if LeapfrogStep::<S>::EXISTS && !FoldedStep::<S, F>::EXISTS => {
                lanes.advance::<FUSED>(state, active)
            }
            _ => active,
        }
    }

    fn forget(&mut self, lane: usize, mechanics: &Mechanics<S>, state: &State<S>) {
        match &mut self.0 {
            Kind::Folded(lanes) => lanes.forget(lane, mechanics, state),
            Kind::Leapfrog(lanes) => lanes.forget(lane, mechanics, state),
        }
    }
}
