//! How far a program is, and its interruption.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use indicatif::{ProgressBar, ProgressStyle};

/// Whether the work is complete.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// It is.
    Complete,
    /// Ctrl-C ended it; what was finished is kept.
    Interrupted,
}

/// Whether Ctrl-C has been pressed.
#[derive(Clone, Default)]
pub struct Interruption(Arc<AtomicBool>);

impl Interruption {
    /// Listens to Ctrl-C from here on. The second one ends the program at once.
    ///
    /// # Errors
    /// Where the system admits no handler.
    pub fn listen() -> Result<Self, ctrlc::Error> {
        let interruption = Self::default();
        let flag = Arc::clone(&interruption.0);
        ctrlc::set_handler(move || {
            // Who asks twice does not want to wait.
            if flag.swap(true, Ordering::Relaxed) {
                std::process::exit(130);
            }
        })?;
        Ok(interruption)
    }

    /// Whether it has.
    pub fn is_wanted(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// A bar with what is done and the time that is left.
///
/// # Panics
/// Never: its template is without mistakes.
pub fn bar(length: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len}  {msg}  about {eta} left");
    ProgressBar::new(length).with_style(style.expect("a template without mistakes"))
}
