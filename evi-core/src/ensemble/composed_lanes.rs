//! The lanes of compositions: those of their stages, one after the other.

use super::lane_map::{LaneMap, LaneScheme};
use super::lane_state::{LaneState, blend};
use super::mask::LaneMask;
use crate::integrator::{Composed, Symmetric};
use crate::mechanics::{Mechanics, State};
use crate::scalar::LANES;
use crate::scheme::SchemeError;
use crate::system::MechanicalSystem;

/// The stages of eight members, each with the time from the start of a step to its own.
pub struct ComposedLanes<M> {
    stages: Vec<(M, f64)>,
}

impl<S: MechanicalSystem, B: Symmetric + LaneScheme<S>, const N: usize> LaneScheme<S> for Composed<B, N> {
    /// What it brings into every stage.
    type Member = Vec<B::Member>;
    type Lanes = ComposedLanes<B::Lanes>;

    fn h(&self) -> f64 {
        self.step_size()
    }

    fn member(
        &self,
        mechanics: &Mechanics<S>,
        start: &State<S>,
    ) -> Result<Option<Vec<B::Member>>, SchemeError> {
        self.check_symmetry()?;
        self.stages().map(|(stage, _)| stage.member(mechanics, start)).collect()
    }

    fn join(
        &self,
        mechanics: [&Mechanics<S>; LANES],
        members: [&Vec<B::Member>; LANES],
    ) -> ComposedLanes<B::Lanes> {
        let h = self.step_size();
        let stages = self.stages().enumerate().map(|(place, (stage, start))| {
            (stage.join(mechanics, members.map(|stages| &stages[place])), start * h)
        });
        ComposedLanes { stages: stages.collect() }
    }
}

impl<S: MechanicalSystem, M: LaneMap<S>> LaneMap<S> for ComposedLanes<M> {
    #[inline(always)]
    fn advance<const FUSED: bool>(&mut self, state: &mut LaneState<S>, active: LaneMask) -> LaneMask {
        let before = state.clone();
        let mut failed = LaneMask::NONE;
        for (stage, start) in &mut self.stages {
            // Not what the stages before have added up: their roundings are felt by constraints that move.
            state.t = before.t + *start;
            failed = failed.or(stage.advance::<FUSED>(state, active.without(failed)));
        }
        state.t = before.t;
        if failed.is_any() {
            blend(failed, &before.q, &mut state.q);
            blend(failed, &before.v, &mut state.v);
            blend(failed, &before.p, &mut state.p);
        }
        failed
    }

    fn forget(&mut self, lane: usize, mechanics: &Mechanics<S>, state: &State<S>) {
        for (stage, _) in &mut self.stages {
            stage.forget(lane, mechanics, state);
        }
    }
}
