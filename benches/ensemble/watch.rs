//! How far the program is, and whether it goes on.

use evi_benches::program::progress::{self, Interruption};
use indicatif::ProgressBar;

/// A bar with the time that is left, and Ctrl-C.
pub(crate) struct Watch {
    bar: ProgressBar,
    interruption: Interruption,
}

impl Watch {
    /// Of so many pieces of work.
    pub(crate) fn of(pieces: usize, interruption: Interruption) -> Self {
        Self { bar: progress::bar(pieces as u64), interruption }
    }

    /// Shows what is done next; whether it is wanted.
    pub(crate) fn goes_on(&self, piece: &str) -> bool {
        if self.interruption.is_wanted() {
            return false;
        }
        self.bar.set_message(piece.to_owned());
        self.bar.inc(1);
        true
    }

    /// Takes the bar away; whether everything is done.
    pub(crate) fn finish(self) -> bool {
        self.bar.finish_and_clear();
        !self.interruption.is_wanted()
    }
}
