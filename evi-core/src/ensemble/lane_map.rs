//! Steps of eight members at once, and the schemes that have them.

use super::lane_state::LaneState;
use super::mask::LaneMask;
use crate::integrator::Scheme;
use crate::mechanics::{Mechanics, State};
use crate::scalar::LANES;
use crate::scheme::SchemeError;
use crate::system::MechanicalSystem;

/// A map from the states of eight members at `t` to those at `t + h`, each with its own parameters.
///
/// What a lane holds after a step depends on that lane alone.
pub trait LaneMap<S: MechanicalSystem> {
    /// Overwrites the states of the `active` lanes with those one step later, and returns the lanes among them whose step was not found: their
    /// states have not changed. What becomes of lanes that are not active is not said. Time is the caller's.
    ///
    /// `FUSED` says that the machine has an instruction for products with a sum. Implementations are `#[inline(always)]`.
    fn advance<const FUSED: bool>(&mut self, state: &mut LaneState<S>, active: LaneMask) -> LaneMask;

    /// Drops the past of a lane, whose last step was taken elsewhere and led to `state`.
    fn forget(&mut self, lane: usize, mechanics: &Mechanics<S>, state: &State<S>);
}

/// A scheme whose steps many members of an ensemble may take at once.
pub trait LaneScheme<S: MechanicalSystem>: Scheme<S> {
    /// What a member brings into the map of eight.
    type Member;
    /// The map of eight members.
    type Lanes: LaneMap<S>;

    /// Step size.
    fn h(&self) -> f64;

    /// What the member with these `mechanics` brings; `None` if its steps are taken by itself, with the map of [`Scheme::prepare`].
    ///
    /// # Errors
    /// As for [`Scheme::prepare`].
    fn member(&self, mechanics: &Mechanics<S>, start: &State<S>)
    -> Result<Option<Self::Member>, SchemeError>;

    /// The map of eight members.
    fn join(&self, mechanics: [&Mechanics<S>; LANES], members: [&Self::Member; LANES]) -> Self::Lanes;
}
