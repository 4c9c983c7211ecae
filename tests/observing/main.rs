//! Watching a run: observers, limits, the drift of the energy, diagnostics of steps. Nobody who watches changes a bit of the motion.

mod diagnostics;
mod limits;
mod observers;
