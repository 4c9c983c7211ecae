//! Schemes, prepared for an assembled scene.

use super::curves::Curves;
use super::implicit::ImplicitStep;
use super::kicked::KickedStep;
use super::nodes::Nodes;
use super::{AssembledCurves, AssembledState, AssemblyError, PreparedScene};
use crate::integrator::{Composed, Evi, StepError, Symmetric, Tally};
use crate::memory::{Memory, memory};
use crate::scheme::checked_step_size;

/// A scheme that integrates assembled scenes: [`Evi`] on straight curves and on those of [frequencies](AssembledCurves), [`Galerkin`](crate::integrator::Galerkin) on polynomials, their symmetric
/// compositions, and all of these rescued.
#[diagnostic::on_unimplemented(
    message = "`{Self}` takes no steps of scenes whose sums and families stay loops",
    label = "no scheme of `AssembledSimulation`",
    note = "`Evi` on straight curves, with `.frequency(..)` or `.scene_frequencies()`, `Galerkin` on polynomials, compositions of them, and these `.rescued()` do",
    note = "compensated summation and Galerkin steps with a frequency are for scenes whose sizes are small numbers"
)]
pub trait AssembledScheme {
    /// Its one-step map.
    type Step: AssembledStep;

    /// Folds everything that is constant for a run into the one-step map.
    ///
    /// # Errors
    /// [`AssemblyError`] for a scheme that defines no step for this scene.
    fn prepare(&self, scene: &mut PreparedScene) -> Result<Self::Step, AssemblyError>;
}

/// A map from the state at `t` to the state at `t + h`.
pub trait AssembledStep: Memory {
    /// Step size; negative for a map that goes back in time.
    fn h(&self) -> f64;

    /// Drops what the last steps let expect of the next one, which does not begin where they have ended.
    fn forget(&mut self);

    /// Overwrites `state` with the state one step later, and tells `tally` what has happened on the way.
    ///
    /// # Errors
    /// [`StepError`] when there is no such state or it is not found; `state` has not changed then.
    fn advance(
        &mut self,
        scene: &mut PreparedScene,
        state: &mut AssembledState,
        tally: &mut impl Tally,
    ) -> Result<(), StepError>;
}

/// The one-step map of an [`Evi`].
pub struct AssembledEvi {
    h: f64,
    kind: Kind,
}

/// How the equations of a step are solved.
enum Kind {
    /// For multipliers alone.
    Kicked(KickedStep),
    /// For positions and multipliers together.
    Implicit(ImplicitStep),
}

impl<const K: usize, F: AssembledCurves + Clone> AssembledScheme for Evi<K, F> {
    type Step = AssembledEvi;

    fn prepare(&self, scene: &mut PreparedScene) -> Result<AssembledEvi, AssemblyError> {
        let h = checked_step_size(self.step_size())?;
        let nodes = Nodes::of(self.quadrature());
        let frequencies = self.interpolant().frequencies(scene)?;
        let curves = Curves::new(frequencies, (self.quadrature(), h), scene, self.allows_soft_modes())?;
        // Ends of curved ways depend on forces all along them.
        let kicked = if curves.is_none() { KickedStep::new(scene, &nodes, h) } else { None };
        let kind = match kicked {
            Some(kicked) => Kind::Kicked(kicked),
            None => {
                scene.prepare_saddle()?;
                Kind::Implicit(ImplicitStep::new(scene, &nodes, curves, h))
            }
        };
        Ok(AssembledEvi { h, kind })
    }
}

impl AssembledStep for AssembledEvi {
    fn h(&self) -> f64 {
        self.h
    }

    fn forget(&mut self) {
        match &mut self.kind {
            Kind::Kicked(step) => step.forget(),
            Kind::Implicit(step) => step.forget(),
        }
    }

    fn advance(
        &mut self,
        scene: &mut PreparedScene,
        state: &mut AssembledState,
        tally: &mut impl Tally,
    ) -> Result<(), StepError> {
        match &mut self.kind {
            Kind::Kicked(step) => step.advance(scene, state, tally),
            Kind::Implicit(step) => step.advance(scene, state, tally),
        }
    }
}

memory!([] AssembledEvi, |words| Self { h, kind } => {
    words.fixed(*h);
    // Which of them follows from the scene and the nodes.
    match kind {
        Kind::Kicked(step) => words.part(step),
        Kind::Implicit(step) => words.part(step),
    }
});

/// The one-step map of a composition.
pub struct AssembledComposed<M> {
    /// The maps of the stages, each with the time from the start of the step to its own.
    stages: Vec<(f64, M)>,
    h: f64,
    /// The state before the step, in case that a stage fails.
    before: AssembledState,
}

impl<B: AssembledScheme + Symmetric, const N: usize> AssembledScheme for Composed<B, N> {
    type Step = AssembledComposed<B::Step>;

    fn prepare(&self, scene: &mut PreparedScene) -> Result<Self::Step, AssemblyError> {
        self.check_symmetry()?;
        let h = self.step_size();
        let mut stages = Vec::with_capacity(N);
        for (stage, start) in self.stages() {
            stages.push((start * h, stage.prepare(scene)?));
        }
        Ok(AssembledComposed { stages, h, before: scene.blank_state() })
    }
}

impl<M: AssembledStep> AssembledStep for AssembledComposed<M> {
    fn h(&self) -> f64 {
        self.h
    }

    fn forget(&mut self) {
        self.stages.iter_mut().for_each(|(_, stage)| stage.forget());
    }

    fn advance(
        &mut self,
        scene: &mut PreparedScene,
        state: &mut AssembledState,
        tally: &mut impl Tally,
    ) -> Result<(), StepError> {
        let before = &mut self.before;
        before.copy_from(state);
        for (start, stage) in &mut self.stages {
            // Not what the stages before have added up: their roundings are felt by constraints that move.
            state.t = before.t + *start;
            if let Err(error) = stage.advance(scene, state, tally) {
                scene.space.is_start_known = false;
                std::mem::swap(state, before);
                return Err(error);
            }
        }
        state.t = before.t + self.h;
        Ok(())
    }
}

// The state before a step is overwritten by the next one.
memory!([M: Memory] AssembledComposed<M>, |words| Self { stages, h, before: _ } => {
    words.fixed(*h);
    for (start, stage) in stages {
        words.fixed(*start);
        words.part(stage);
    }
});
