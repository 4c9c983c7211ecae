//! Many members at once: every member moves as by itself, whatever its company, the number of threads, and interruptions.

mod failures;
mod gathering;
mod interruptions;
mod lanes;
mod members;
