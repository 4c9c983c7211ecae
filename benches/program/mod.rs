//! What the programs that measure have in common: names to choose from, files that are replaced as a whole, pages that open offline, a
//! progress bar that Ctrl-C ends.

pub mod files;
pub mod instructions;
pub mod machine;
pub mod progress;

use std::thread;

/// For the largest scenes: a run lives on the stack until it is boxed, and a composition holds a map for each of its stages.
pub const STACK_BYTES: usize = 1 << 28;

/// Does `work` on a thread with a stack of [`STACK_BYTES`]; a panic there is a panic here.
///
/// # Panics
/// Where there is no memory for a thread.
pub fn on_a_large_stack<R: Send + 'static>(work: impl FnOnce() -> R + Send + 'static) -> R {
    let thread = thread::Builder::new().stack_size(STACK_BYTES).spawn(work);
    thread.expect("a thread").join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
}

/// Refuses the first name that is none of `all`.
///
/// # Errors
/// A message with the names that there are.
pub fn check_names(kind: &str, names: &[String], all: &[&str]) -> Result<(), String> {
    match names.iter().find(|name| !all.contains(&name.as_str())) {
        Some(name) => Err(format!("there is no {kind} `{name}`\n       {kind}s: {}", all.join(", "))),
        None => Ok(()),
    }
}

/// Whether a name is among the chosen ones; none chosen stands for all.
pub fn is_chosen(name: &str, chosen: &[String]) -> bool {
    chosen.is_empty() || chosen.iter().any(|other| other == name)
}
