//! What is kept of the members of an ensemble while they move.

use core::ops::ControlFlow;

use super::failure::Failure;
use crate::mechanics::{Mechanics, State};
use crate::memory::{Memory, Recall, Record};
use crate::system::MechanicalSystem;

/// A member at a moment.
pub struct Sight<'a, S: MechanicalSystem> {
    /// Index of the member.
    pub member: usize,
    /// Number of the sample, 0 at the start; of a crossing, that of the sample before.
    pub sample: usize,
    /// The mechanics of the scene with the parameters of the member.
    pub mechanics: &'a Mechanics<S>,
    /// Where it is.
    pub state: &'a State<S>,
}

/// What has been gathered of some consecutive members.
///
/// Its [`Memory`] is what a file or another process needs to go on from it to the last bit.
pub trait Part: Memory + Send {
    /// Adds what has been gathered of the members that follow.
    fn absorb(&mut self, later: Self);
}

/// A way to gather. Members are seen in an order that depends on their indices alone.
pub trait Gather<S: MechanicalSystem>: Sync {
    /// What has been gathered.
    type Part: Part;

    /// What is gathered of no member.
    fn blank(&self) -> Self::Part;

    /// Sees a member at a sample.
    fn see(&self, part: &mut Self::Part, sight: &Sight<'_, S>) {
        let _ = (part, sight);
    }

    /// Sees a member where it crosses the section of the ensemble; `Break` ends its motion there.
    fn cross(&self, part: &mut Self::Part, sight: &Sight<'_, S>) -> ControlFlow<()> {
        let _ = (part, sight);
        ControlFlow::Continue(())
    }

    /// Sees a member at the end of its motion.
    fn end(&self, part: &mut Self::Part, end: Result<&Sight<'_, S>, &Failure>) {
        let _ = (part, end);
    }
}

/// Gathers nothing.
impl<S: MechanicalSystem> Gather<S> for () {
    type Part = ();

    fn blank(&self) {}
}

impl Part for () {
    fn absorb(&mut self, _later: Self) {}
}

/// Gathers both; a crossing ends the motion if either says so.
impl<S: MechanicalSystem, A: Gather<S>, B: Gather<S>> Gather<S> for (A, B) {
    type Part = (A::Part, B::Part);

    fn blank(&self) -> Self::Part {
        (self.0.blank(), self.1.blank())
    }

    fn see(&self, part: &mut Self::Part, sight: &Sight<'_, S>) {
        self.0.see(&mut part.0, sight);
        self.1.see(&mut part.1, sight);
    }

    fn cross(&self, part: &mut Self::Part, sight: &Sight<'_, S>) -> ControlFlow<()> {
        let first = self.0.cross(&mut part.0, sight);
        let second = self.1.cross(&mut part.1, sight);
        if first.is_break() { first } else { second }
    }

    fn end(&self, part: &mut Self::Part, end: Result<&Sight<'_, S>, &Failure>) {
        self.0.end(&mut part.0, end);
        self.1.end(&mut part.1, end);
    }
}

impl<A: Memory, B: Memory> Memory for (A, B) {
    fn record(&self, words: &mut Record<'_>) {
        words.part(&self.0);
        words.part(&self.1);
    }

    fn recall(&mut self, words: &mut Recall<'_>) {
        words.part(&mut self.0);
        words.part(&mut self.1);
    }
}

impl<A: Part, B: Part> Part for (A, B) {
    fn absorb(&mut self, later: Self) {
        self.0.absorb(later.0);
        self.1.absorb(later.1);
    }
}
