//! Steps that fail are taken in parts, where that is asked for.

use super::{AssembledScheme, AssembledState, AssembledStep, AssemblyError, PreparedScene};
use crate::integrator::{Rescued, Rescues, StepError, Symmetric, Tally, depends_on_length, n_parts};
use crate::memory::{Memory, memory};

/// The one-step map of a [`Rescued`] scheme; what [`Symmetric::rescued`] says of it holds here.
pub struct AssembledRescued<M> {
    whole: M,
    /// Of `2, 4, …` parts.
    parts: Vec<M>,
    /// The state before the step.
    before: AssembledState,
    rescues: Rescues,
}

impl<M> AssembledRescued<M> {
    /// How many steps were taken in parts, and in how many: `run.map().rescues()`.
    pub const fn rescues(&self) -> Rescues {
        self.rescues
    }
}

impl<B: AssembledScheme + Symmetric, const K: usize> AssembledScheme for Rescued<B, K> {
    type Step = AssembledRescued<B::Step>;

    fn prepare(&self, scene: &mut PreparedScene) -> Result<Self::Step, AssemblyError> {
        let base = self.base();
        let part = |index| base.with_step_size(base.step_size() / n_parts(index) as f64);
        let whole = base.prepare(scene)?;
        let parts = (0..K).map(|index| part(index).prepare(scene)).collect::<Result<_, _>>()?;
        let before = scene.blank_state();
        Ok(AssembledRescued { whole, parts, before, rescues: Rescues::default() })
    }
}

impl<M: AssembledStep> AssembledStep for AssembledRescued<M> {
    fn h(&self) -> f64 {
        self.whole.h()
    }

    fn forget(&mut self) {
        self.whole.forget();
    }

    fn advance(
        &mut self,
        scene: &mut PreparedScene,
        state: &mut AssembledState,
        tally: &mut impl Tally,
    ) -> Result<(), StepError> {
        match self.whole.advance(scene, state, tally) {
            Err(error) if depends_on_length(&error) => self.rescue(error, scene, state, tally),
            taken => taken,
        }
    }
}

impl<M: AssembledStep> AssembledRescued<M> {
    /// Takes the step that has failed with `error` in parts.
    ///
    /// # Errors
    /// `error`, if the parts fail, too, however many; nothing has changed then.
    #[cold]
    fn rescue(
        &mut self,
        error: StepError,
        scene: &mut PreparedScene,
        state: &mut AssembledState,
        tally: &mut impl Tally,
    ) -> Result<(), StepError> {
        let (start, h) = (state.t, self.whole.h());
        self.before.copy_from(state);
        self.whole.forget();
        for (index, map) in self.parts.iter_mut().enumerate() {
            let n = n_parts(index);
            // What they know is of another rescue.
            map.forget();
            let is_taken = (0..n).all(|part| {
                // Not what the parts before have added up: their roundings are felt by constraints that move.
                state.t = start + h * (part as f64 / n as f64);
                map.advance(scene, state, tally).is_ok()
            });
            if is_taken {
                state.t = start + h;
                self.rescues.count(n);
                tally.count_rescue(n);
                return Ok(());
            }
            state.copy_from(&self.before);
            scene.space.is_start_known = false;
        }
        Err(error)
    }
}

// Maps of parts have forgotten what they knew when they are asked again, and the state before a step is overwritten by the next one.
memory!([M: Memory] AssembledRescued<M>, |words| Self { whole, parts: _, before: _, rescues } => {
    words.part(whole);
    words.part(rescues);
});
