//! Galerkin integrators: their orders, what they are for one interval, and what they keep.

use evi_core::baseline::Rattle;
use evi_core::generic::GenericSystem;
use evi_core::prelude::*;
use evi_core::scheme::NodalCurves;
use evi_examples::{
    AndrewsSqueezer, CarAxis, DoublePendulum, DrivenPendulum, SliderCrank, SphericalPendulum, Start,
};
use evi_tests::conservation::{angular_momentum, largest_change, largest_residuals, there_and_back};
use evi_tests::convergence::check_orders;
use evi_tests::galerkin::GalerkinAction;
use evi_tests::motions::{
    Motion, charged_spherical_pendulum, damped_pendulum, gentle_double_pendulum, kapitza_pendulum,
    long_charged_spherical_pendulum, long_double_pendulum_in_angles, modulated_pendulum, relativistic_bead,
    slider_crank,
};
use evi_tests::references::{self, Certified};
use evi_tests::scenes::{
    ChargedSphericalPendulum, DoublePendulumInAngles, Dumbbell, KapitzaPendulum, RelativisticBead,
};
use evi_tests::tangent::{TangentSpace, symplectic_defect};
use evi_tests::{distance, largest_difference};

mod certified;
mod frequencies;
mod kept;
mod one_interval;
mod order;

/// The double pendulum of unequal masses and lengths, on a swing of moderate size.
fn swing() -> (DoublePendulum, Start<4>) {
    let angles = DoublePendulumInAngles::UNEQUAL;
    let Start { q, v } = DoublePendulumInAngles::MODERATE;
    (angles.constrained(), angles.cartesian(q, v))
}

#[test]
fn a_step_without_solution_leaves_the_state() {
    let system = DoublePendulum::UNIT;
    let Start { q, v } = system.horizontal();
    let mut run = Simulation::new(system, Galerkin::<3>::new(0.4)).start(q, v).expect("a start");
    let mut last = run.state().clone();
    let failure = loop {
        match run.advance() {
            Ok(state) => last = state.clone(),
            Err(failure) => break failure,
        }
        assert!(run.steps() < 1_000, "vacuous: every step has a solution");
    };
    println!("after {} steps: {failure}", run.steps());
    assert!(matches!(failure, StepError::NoSolution { .. }), "{failure}");
    assert_eq!(*run.state(), last);
    let again = run.advance().expect_err("nothing has changed");
    assert_eq!(again.to_string(), failure.to_string());
}
