//! BDF and diagonally implicit Runge-Kutta methods of the crate `diffsol`, with the feature of that name.

#[cfg(feature = "diffsol")]
mod run;

use evi_core::comparison::Solver;
use evi_core::linear::SingularMatrix;
use evi_core::system::MechanicalSystem;

use super::Tolerances;

/// A method of `diffsol`, each with its own choice of steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DiffsolMethod {
    /// Backward differentiation of variable order 1 to 5.
    Bdf,
    /// TR-BDF2, of order 2.
    TrBdf2,
    /// ESDIRK34, of order 3.
    Esdirk34,
}

/// A run of `diffsol` that did not start or ended early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DiffsolError {
    /// This program has been built without the feature.
    #[error("not built: `--features diffsol` compares with diffsol")]
    NotBuilt,
    /// A tolerance is not a positive number.
    #[error("tolerances must be finite and positive, got {relative:e} relative and {absolute:e} absolute")]
    Tolerances {
        /// Relative tolerance.
        relative: f64,
        /// Absolute tolerance.
        absolute: f64,
    },
    /// The time to move to, or a number of the start, is not finite.
    #[error("cannot go from t = {t:?} to t = {target:?}: a number is not finite")]
    NotFinite {
        /// Where the solver stands.
        t: f64,
        /// Where it should go.
        target: f64,
    },
    /// Mass matrix and constraints do not determine the accelerations.
    #[error("no accelerations at t = {t:?}: {matrix}")]
    Singular {
        /// Time of the evaluation.
        t: f64,
        /// The numbers of the matrix.
        matrix: SingularMatrix,
    },
    /// The crate gave up.
    #[error("stopped at t = {t:?}: {message}")]
    Stopped {
        /// Time reached.
        t: f64,
        /// What it said.
        message: String,
    },
}

/// A method of `diffsol` on the index-1 equations from `(q, v)` at time 0. Products with the Jacobian are central difference quotients
/// of the scene's accelerations: the modified Newton iteration needs few of their digits. Every call begins anew, at order 1 where
/// the order varies.
///
/// # Errors
/// [`DiffsolError::NotBuilt`] without the feature `diffsol`; else tolerances and starts that are no numbers.
pub fn diffsol<S: MechanicalSystem + 'static>(
    system: &S,
    method: DiffsolMethod,
    q: &S::PerCoordinate<f64>,
    v: &S::PerCoordinate<f64>,
    tolerances: Tolerances,
) -> Result<Box<dyn Solver>, DiffsolError> {
    let Tolerances { relative, absolute } = tolerances;
    if !tolerances.are_sound() {
        return Err(DiffsolError::Tolerances { relative, absolute });
    }
    if !q.as_ref().iter().chain(v.as_ref()).all(|x| x.is_finite()) {
        return Err(DiffsolError::NotFinite { t: 0.0, target: 0.0 });
    }
    #[cfg(feature = "diffsol")]
    return Ok(Box::new(run::Run::new(system, method, q, v, tolerances)));
    #[cfg(not(feature = "diffsol"))]
    {
        let _ = (system, method);
        Err(DiffsolError::NotBuilt)
    }
}
