//! Rescue by splitting: a step without solution is taken in parts.

use super::{Compensable, CompensableStep, OneStep, Scheme, StepError, Symmetric, Tally};
use crate::mechanics::{LostDigits, Mechanics, State};
use crate::memory::{Memory, memory};
use crate::scheme::SchemeError;
use crate::system::MechanicalSystem;

/// A scheme whose steps, where they fail, are taken in up to `2^K` parts; made by [`Symmetric::rescued`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rescued<B, const K: usize> {
    base: B,
}

impl<B: Symmetric, const K: usize> Rescued<B, K> {
    pub(super) const fn new(base: B) -> Self {
        const { assert!(0 < K && K < 32, "a step is halved once or more, and its parts have to be counted") };
        Self { base }
    }

    /// The scheme of whole steps.
    #[cfg(feature = "std")]
    pub(crate) const fn base(&self) -> &B {
        &self.base
    }
}

impl<B: Compensable, const K: usize> Compensable for Rescued<B, K> {}

impl<S: MechanicalSystem, B: Symmetric + Scheme<S>, const K: usize> Scheme<S> for Rescued<B, K> {
    type Step = RescuedStep<B::Step, K>;

    /// Prepares one map per number of parts.
    ///
    /// # Errors
    /// What the base says about the whole step or one of its parts.
    fn prepare(&self, mechanics: Mechanics<S>) -> Result<Self::Step, SchemeError> {
        let mut refusal = None;
        let parts: [Option<B::Step>; K] = core::array::from_fn(|halvings| {
            let h = self.base.step_size() / n_parts(halvings) as f64;
            let part = self.base.with_step_size(h).prepare(mechanics.clone());
            part.map_err(|error| refusal = Some(error)).ok()
        });
        let whole = self.base.prepare(mechanics)?;
        match refusal {
            Some(error) => Err(error),
            None => {
                let parts = parts.map(|part| part.expect("a part is prepared or refused"));
                Ok(RescuedStep { whole, parts, rescues: Rescues::default() })
            }
        }
    }
}

/// `2^(k + 1)`, for the map of index `k`.
pub(crate) const fn n_parts(index: usize) -> u64 {
    2 << index
}

/// What has been rescued so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rescues {
    /// Number of steps that were taken in parts.
    pub steps: u64,
    /// Number of their parts, all together.
    pub parts: u64,
}

impl Rescues {
    /// Counts a step that was taken in so many parts.
    pub(crate) const fn count(&mut self, parts: u64) {
        self.steps += 1;
        self.parts += parts;
    }
}

/// The one-step map of a [`Rescued`] scheme.
pub struct RescuedStep<M, const K: usize> {
    whole: M,
    /// Of `2, 4, … 2^K` parts.
    parts: [M; K],
    rescues: Rescues,
}

impl<M, const K: usize> RescuedStep<M, K> {
    /// How many steps were taken in parts, and in how many: `run.map().rescues()`.
    pub const fn rescues(&self) -> Rescues {
        self.rescues
    }

    /// The map of the whole step.
    pub const fn whole(&self) -> &M {
        &self.whole
    }

    /// Takes the step that has failed with `error` in parts: `state` and what `carried` holds beside it.
    ///
    /// # Errors
    /// `error`, if the parts fail, too, however many; nothing has changed then.
    #[cold]
    #[inline(never)]
    fn rescue<S: MechanicalSystem, C: Clone, T: Tally>(
        &mut self,
        error: StepError,
        state: &mut State<S>,
        carried: &mut C,
        tally: &mut T,
        mut take: impl FnMut(&mut M, &mut State<S>, &mut C, &mut T) -> Result<(), StepError>,
    ) -> Result<(), StepError>
    where
        M: OneStep<S>,
    {
        if !depends_on_length(&error) {
            return Err(error);
        }
        let (start, h) = (state.t, self.whole.h());
        for (index, map) in self.parts.iter_mut().enumerate() {
            let (mut reached, mut kept) = (state.clone(), carried.clone());
            let n = n_parts(index);
            let is_taken = (0..n).all(|part| {
                // Not what the parts before have added up: their roundings are felt by constraints that move.
                reached.t = start + h * (part as f64 / n as f64);
                take(map, &mut reached, &mut kept, tally).is_ok()
            });
            if is_taken {
                reached.t = start + h;
                (*state, *carried) = (reached, kept);
                self.rescues.count(n);
                tally.count_rescue(n);
                return Ok(());
            }
        }
        Err(error)
    }
}

/// Whether a shorter step can be free of this error.
pub(crate) const fn depends_on_length(error: &StepError) -> bool {
    matches!(error, StepError::NoSolution { .. } | StepError::Singular { .. } | StepError::Projection { .. })
}

impl<S: MechanicalSystem, M: OneStep<S>, const K: usize> OneStep<S> for RescuedStep<M, K> {
    fn h(&self) -> f64 {
        self.whole.h()
    }

    fn mechanics(&self) -> &Mechanics<S> {
        self.whole.mechanics()
    }

    #[inline]
    fn advance(&mut self, state: &mut State<S>, tally: &mut impl Tally) -> Result<(), StepError> {
        match self.whole.advance(state, tally) {
            Ok(()) => Ok(()),
            Err(error) => self.rescue(error, state, &mut (), tally, |part, reached, (), tally| {
                part.advance(reached, tally)
            }),
        }
    }
}

impl<S: MechanicalSystem, M: CompensableStep<S>, const K: usize> CompensableStep<S> for RescuedStep<M, K> {
    #[inline]
    fn advance_compensated(
        &mut self,
        state: &mut State<S>,
        lost: &mut LostDigits<S>,
        tally: &mut impl Tally,
    ) -> Result<(), StepError> {
        match self.whole.advance_compensated(state, lost, tally) {
            Ok(()) => Ok(()),
            Err(error) => self.rescue(error, state, lost, tally, |part, reached, lost, tally| {
                part.advance_compensated(reached, lost, tally)
            }),
        }
    }
}

memory!([] Rescues, |words| Self { steps, parts } => {
    words.count(steps);
    words.count(parts);
});

memory!([M: Memory, const K: usize] RescuedStep<M, K>, |words| Self { whole, parts, rescues } => {
    words.part(whole);
    for part in parts {
        words.part(part);
    }
    words.part(rescues);
});
