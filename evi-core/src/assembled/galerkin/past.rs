//! What the last steps have found, from which the passes of the next one begin.

use crate::memory::{Memory, memory};
use crate::scalar::Lanes;
use crate::scheme::PAST;

/// What the last steps have found, the last one first. It affects the number of passes and the last bits of a state, nothing else.
pub(super) struct Past<T> {
    found: [T; PAST],
    /// How many of them are known.
    known: usize,
}

impl<T> Past<T> {
    /// Before the first step, with storage for what steps will find.
    pub(super) fn none(blank: impl Fn() -> T) -> Self {
        Self { found: core::array::from_fn(|_| blank()), known: 0 }
    }

    /// Whether it is long enough to continue.
    pub(super) const fn is_known(&self) -> bool {
        self.known == PAST
    }

    /// Drops it: the next step is not predicted from it.
    pub(super) fn forget(&mut self) {
        self.known = 0;
    }

    /// Keeps what a step has found, which leaves storage for the next one.
    pub(super) fn remember(&mut self, found: &mut T) {
        self.found.rotate_right(1);
        std::mem::swap(&mut self.found[0], found);
        self.known = PAST.min(self.known + 1);
    }

    /// The last step, and the one before.
    pub(super) const fn found(&self) -> &[T; PAST] {
        &self.found
    }
}

memory!([T: Memory] Past<T>, |words| Self { found, known } => {
    for found in found {
        words.part(found);
    }
    words.index(known);
});

memory!([] Vec<Lanes>, |words| lanes => {
    words.lane_slice(lanes);
});
