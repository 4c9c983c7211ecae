//! Step errors of a scene that is prepared.

use crate::integrator::StepError;
use crate::linear::SingularMatrix;

/// A matrix that does not determine the step from `t`.
pub(super) fn singular(t: f64, matrix: SingularMatrix) -> StepError {
    StepError::Singular { t, correction: 0, matrix }
}
