//! What every solver can be asked, whatever it is made of: for comparisons only.

use std::error::Error;

/// Why a solver stopped: the typed error of the method, such as [`StepError`](crate::integrator::StepError).
pub type Failure = Box<dyn Error + Send + Sync>;

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

    /// Moves to time `t`: to the step nearest to it where steps have a fixed size, to `t` itself where the solver chooses them.
    ///
    /// # Errors
    /// The error of the first step that fails; the solver stands before it.
    fn advance_to(&mut self, t: f64) -> Result<(), Failure>;

    /// Moves to time `t` as [`advance_to`](Self::advance_to) does, by the same steps, and shows the solver after each of them.
    ///
    /// # Errors
    /// As for [`advance_to`](Self::advance_to).
    fn advance_visiting(&mut self, t: f64, visit: &mut dyn FnMut(&dyn Solver)) -> Result<(), Failure>;
}
