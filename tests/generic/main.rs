//! The generic path: the specialised path's trajectories to round-off, systems of run-time size, errors.

mod agreement;
mod chain;
mod errors;
mod run_time_size;

use chain::Chain;
use evi_core::comparison::Solver;
use evi_core::generic::{GenericEvi, GenericGalerkin, GenericRun, GenericScheme, GenericSystem};
use evi_core::integrator::ConstraintLabel;
use evi_core::mechanics::ProjectionError;
use evi_core::prelude::*;
use evi_core::scalar::Scalar;
use evi_examples::{
    DoublePendulum, DrivenPendulum, HarmonicOscillator, Pendulum, SphericalPendulum, Start,
    StiffSpringPendulum,
};
use evi_tests::largest_difference;
use evi_tests::scenes::{
    ChargedParticle, ChargedSphericalPendulum, DampedOscillator, DampedPendulum, DoublePendulumInAngles,
    Dumbbell, KapitzaPendulum, ModulatedPendulum, MotorisedDoublePendulum, PushedDumbbell, RelativisticBead,
};

const H: f64 = 0.01;
const OMEGA: f64 = 2.4;
const SPHERICAL: SphericalPendulum = SphericalPendulum::UNIT;
