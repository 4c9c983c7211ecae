//! How runs of the generic path begin, whatever the integrator.

use super::GenericSystem;
use super::run::GenericRun;
use super::step::Equations;
use crate::integrator::StartError;
use crate::scheme::{Frequency, SchemeError};

/// An integrator for systems of run-time size: [`GenericEvi`](super::GenericEvi) or [`GenericGalerkin`](super::GenericGalerkin).
pub trait GenericScheme {
    /// Step size.
    fn step_size(&self) -> f64;

    /// The equations of a step for `system`.
    #[doc(hidden)]
    fn prepare(&self, system: &impl GenericSystem) -> Result<Equations, SchemeError>;

    /// A run of `system` from positions and velocities at time 0 that satisfy the constraints.
    ///
    /// # Errors
    /// [`StartError`] for vectors of another length than `n`, numbers that are not finite, an inconsistent start, a
    /// scheme that defines no step, or a configuration where mass matrix and constraints do not determine the motion.
    fn start<S: GenericSystem>(&self, system: S, q: &[f64], v: &[f64]) -> Result<GenericRun<S>, StartError> {
        self.start_at(system, 0.0, q, v)
    }

    /// A run from a consistent start at time `t`.
    ///
    /// # Errors
    /// As for [`start`](Self::start).
    fn start_at<S: GenericSystem>(
        &self,
        system: S,
        t: f64,
        q: &[f64],
        v: &[f64],
    ) -> Result<GenericRun<S>, StartError> {
        GenericRun::start_consistent(self, system, (t, q, v))
    }

    /// A run from the consistent start nearest to `(q, v)` in the metric of the mass matrix, at time `t`.
    ///
    /// # Errors
    /// As for [`start`](Self::start), except for inconsistency, which is mended.
    fn start_projected<S: GenericSystem>(
        &self,
        system: S,
        t: f64,
        q: &[f64],
        v: &[f64],
    ) -> Result<GenericRun<S>, StartError> {
        GenericRun::start_projected(self, system, (t, q, v))
    }
}

/// The frequencies of a scheme, for a number of coordinates that is still to be known.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Frequencies {
    Uniform(Frequency),
    PerCoordinate(Vec<Frequency>),
}

impl Frequencies {
    /// Refuses another number of frequencies than of coordinates.
    pub(super) fn check(&self, coordinates: usize) -> Result<(), SchemeError> {
        match self {
            Self::PerCoordinate(frequencies) if frequencies.len() != coordinates => {
                Err(SchemeError::FrequencyCount { frequencies: frequencies.len(), coordinates })
            }
            _ => Ok(()),
        }
    }

    /// The frequency of a coordinate.
    pub(super) fn of(&self, coordinate: usize) -> Frequency {
        match self {
            Self::Uniform(frequency) => *frequency,
            Self::PerCoordinate(frequencies) => frequencies[coordinate],
        }
    }
}
