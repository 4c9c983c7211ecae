//! What every solver can be asked, whatever it is made of: for comparisons only.

use crate::integrator::StepError;

/// A solver of a mechanical system at a state. Object-safe; the typed world lies below it.
pub trait Solver {
    /// Time.
    fn t(&self) -> f64;
    /// Configuration.
    fn q(&self) -> &[f64];
    /// Velocity.
    fn v(&self) -> &[f64];
    /// Momentum.
    fn p(&self) -> &[f64];
    /// Number of steps taken.
    fn steps(&self) -> u64;
    /// Moves to the step nearest to time `t`.
    ///
    /// # Errors
    /// [`StepError`] of the first step that fails; the solver stands before it.
    fn advance_to(&mut self, t: f64) -> Result<(), StepError>;
}
