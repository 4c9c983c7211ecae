//! Why there is no derivative.

use std::string::String;

use crate::integrator::{StartError, StepError};
use crate::linear::SingularMatrix;

/// A derivative of a run that does not exist, or that is not found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DerivativeError {
    /// The run does not start.
    #[error(transparent)]
    Start(#[from] StartError),
    /// A step of the run fails.
    #[error(transparent)]
    Step(#[from] StepError),
    /// The equations of a step do not determine how its end follows its start.
    #[error("the derivative of the step from t = {t} is not determined: {matrix}")]
    Singular {
        /// Time at the start of the step.
        t: f64,
        /// The numbers of the matrix.
        matrix: SingularMatrix,
    },
    /// No equation of the scene uses a parameter of this name.
    #[error("no parameter is called `{name}`; there are {known:?}")]
    UnknownParameter {
        /// The name asked for.
        name: String,
        /// The parameters of the scene.
        known: &'static [&'static str],
    },
    /// The tables of the scheme depend on parameters, which its steps are not differentiated by.
    #[error("{scheme} follows the parameters: derivatives by them need {requirement}")]
    Parameters {
        /// The scheme.
        scheme: &'static str,
        /// What would be needed.
        requirement: &'static str,
    },
    /// Steps of this kind are not differentiated.
    #[error("{scheme} has no derivative here: it needs {requirement}")]
    Unsupported {
        /// The scheme.
        scheme: &'static str,
        /// What would be needed.
        requirement: &'static str,
    },
    /// A direction leaves the numbers, or a start of one is none.
    #[error("a derivative at t = {t} is not finite")]
    NotFinite {
        /// Time.
        t: f64,
    },
    /// Not one list of inputs per step.
    #[error("{found} lists of inputs for {steps} steps: give one for each")]
    InputCount {
        /// Number of steps.
        steps: usize,
        /// Number of lists.
        found: usize,
    },
    /// More exponents or directions than the motion has.
    #[error("{asked} directions are asked for, the motion has {dimension}")]
    Dimension {
        /// Number of directions.
        asked: usize,
        /// Dimension of the phase space on the constraints.
        dimension: usize,
    },
}
