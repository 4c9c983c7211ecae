//! No allocation under a step, whatever the scheme and the scene, and none under a step that fails.
//!
//! The allocator of this program counts; the counter is one per thread, so that tests run side by side.

// A global allocator is an unsafe trait: the only way to observe allocations from inside a program. The
// functions below count and hand over to the system's allocator, whose contract is the one that they are
// asked to keep.
#![allow(unsafe_code)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::hint::black_box;
use std::time::Duration;

use evi_core::assembled::{AssembledScheme, AssembledSimulation};
use evi_core::baseline::{GeneralizedAlpha, ImplicitMidpoint, Rattle, Rk4, Shake};
use evi_core::generic::{GenericEvi, GenericGalerkin, GenericScheme, GenericSystem};
use evi_core::integrator::{Diagnostics, OfRank};
use evi_core::prelude::*;
use evi_core::sensitivity::{Differentiable, Differentiate, Direction};
use evi_core::watch::{EnergyDrift, Limits};
use evi_examples::{
    DoublePendulum, DrivenPendulum, FermiPastaUlam, HarmonicOscillator, Pendulum, SphericalPendulum, Start,
    StiffSpringPendulum,
};
use evi_tests::scenes::{DampedOscillator, PushedDumbbell};
use evi_tests::trusses::{Placed, chain, net, ring};

thread_local! {
    // Constant and without destructor: its first use allocates nothing.
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

// SAFETY: every request is passed on unchanged; counting touches no memory of the caller.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract of `dealloc`, and `System` allocated the block.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        count();
        // SAFETY: the caller keeps the contract of `realloc`, and `System` allocated the block.
        unsafe { System.realloc(pointer, layout, new_size) }
    }
}

fn count() {
    ALLOCATIONS.with(|allocations| allocations.set(allocations.get() + 1));
}

/// Allocations of this thread under `work`.
fn allocations(work: impl FnOnce()) -> u64 {
    let before = ALLOCATIONS.with(Cell::get);
    work();
    ALLOCATIONS.with(Cell::get) - before
}

/// Takes 1,000 steps and expects that none allocates.
#[track_caller]
fn check<S, F, const N: usize>(system: S, scheme: F, start: Start<N>)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S>,
{
    let mut run = Simulation::new(system, scheme).start(start.q, start.v).expect("the start is consistent");
    let before = run.state().clone();
    let allocations = allocations(|| {
        for _ in 0..1_000 {
            run.advance().expect("the step exists");
        }
    });
    assert_eq!(allocations, 0);
    assert_ne!(*run.state(), before, "the run stood still");
}

const PENDULUM: Pendulum = Pendulum { m: 1.0, l: 1.0, g: 9.81 };
const SWING: Start<1> = Start { q: [1.0], v: [0.0] };
const OSCILLATOR: HarmonicOscillator = HarmonicOscillator { m: 2.0, k: 3.0 };
const SPRING: StiffSpringPendulum = StiffSpringPendulum::with_stiffness(1e3);
const DOUBLE: DoublePendulum = DoublePendulum::UNIT;
const SPHERICAL: SphericalPendulum = SphericalPendulum::UNIT;
const OMEGA: f64 = 2.4;

fn mild() -> Start<4> {
    DOUBLE.at_angles(0.3, -0.2)
}

/// One frequency per body of the double pendulum.
const PER_BODY: [Frequency; 4] =
    [Frequency::ZERO, Frequency::ZERO, Frequency::Trigonometric(2.4), Frequency::Trigonometric(2.4)];

/// Moves a vector along 200 steps and expects that none allocates.
#[track_caller]
fn check_tangents<S, F, const N: usize>(system: S, scheme: F, start: Start<N>)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S, Step: Differentiable<S>>,
{
    let mut along = [0.0; N];
    along[N - 1] = 1.0;
    let direction = Direction::of_start([0.0; N], along);
    let simulation = Simulation::new(system, scheme);
    let mut run = simulation.start_with_tangents(start.q, start.v, &[direction]).expect("a start");
    let before = *run.tangents()[0].q();
    let allocations = allocations(|| {
        for _ in 0..200 {
            run.advance().expect("the step exists");
        }
    });
    assert_eq!(allocations, 0);
    assert_ne!(*run.tangents()[0].q(), before, "the vector stood still");
}

#[test]
fn no_step_of_a_tangent_map_allocates() {
    check_tangents(DOUBLE, Evi::midpoint(0.01), mild());
    check_tangents(DOUBLE, Evi::trapezoid(0.01).composed(Composition::suzuki_4()), mild());
    check_tangents(DOUBLE, Galerkin::<3>::new(0.02), mild());
    check_tangents(PENDULUM, Gauss::<3>::new(0.02), SWING);
}

#[test]
fn the_counter_counts() {
    assert_eq!(allocations(|| ()), 0);
    assert_eq!(allocations(|| drop(black_box(Box::new(1.0)))), 1);
    let growth = |values: &mut Vec<f64>| values.extend(black_box([0.0; 100]));
    let mut values = Vec::with_capacity(1);
    assert_eq!(allocations(|| growth(&mut values)), 1);
    // What keeps every state asks for memory; the counter sees it through the library too.
    let mut run = Simulation::new(PENDULUM, Evi::midpoint(0.01)).start(SWING.q, SWING.v).unwrap();
    assert!(allocations(|| drop(run.integrate(0.1))) > 0);
}

#[test]
fn no_step_of_an_unconstrained_scene_allocates() {
    check(PENDULUM, Evi::midpoint(0.01), SWING);
    check(PENDULUM, Evi::simpson(0.01), SWING);
    check(PENDULUM, Evi::midpoint(0.01).frequency(3.1), SWING);
    check(PENDULUM, Evi::simpson(0.01).frequencies([Frequency::Hyperbolic(3.1)]), SWING);
    check(OSCILLATOR, Evi::midpoint(0.01).frequency(OSCILLATOR.frequency()), SWING);
    check(SPRING, Evi::midpoint(0.01), SPRING.horizontal());
    check(SPRING, Evi::new(Quadrature::<5>::gauss(), 0.01).frequency(30.0), SPRING.horizontal());
}

#[test]
fn no_step_of_a_constrained_scene_allocates() {
    check(DOUBLE, Evi::midpoint(0.01), mild());
    check(DOUBLE, Evi::simpson(0.01), mild());
    check(DOUBLE, Evi::new(Quadrature::<2>::uniform(), 0.01), mild());
    check(DOUBLE, Evi::new(Quadrature::<7>::lobatto(), 0.01), mild());
    check(SPHERICAL, Evi::midpoint(0.01), SPHERICAL.one_radian());
    check(SPHERICAL, Evi::simpson(0.01), SPHERICAL.one_radian());
}

#[test]
fn no_exponential_step_of_a_constrained_scene_allocates() {
    check(DOUBLE, Evi::midpoint(0.01).frequency(OMEGA), mild());
    check(DOUBLE, Evi::simpson(0.01).frequency(OMEGA), mild());
    check(DOUBLE, Evi::simpson(0.01).frequencies(PER_BODY), mild());
    check(SPHERICAL, Evi::midpoint(0.01).frequency(OMEGA), SPHERICAL.one_radian());
    check(SPHERICAL, Evi::simpson(0.01).frequency(Frequency::Hyperbolic(OMEGA)), SPHERICAL.one_radian());
}

#[test]
fn no_step_with_a_matrix_frequency_allocates() {
    let hanging = [0.0, -1.0, 0.0, -2.0];
    check(DOUBLE, Evi::trapezoid(0.01).linearised_at(hanging), mild());
    check(DOUBLE, Evi::midpoint(0.01).linearised_at(hanging), mild());
    check(DOUBLE, Evi::simpson(0.01).linearised_at(hanging).mollified(Mollifier::LongAverage), mild());
    check(DOUBLE, Evi::trapezoid(0.01).stiffness([[1.0; 4]; 4]).about(hanging), mild());
    let start = SPHERICAL.one_radian();
    check(SPHERICAL, Evi::trapezoid(0.01).linearised_along(start.q, start.v), start);
    let chain = FermiPastaUlam::STANDARD;
    let springs = Evi::trapezoid(0.02).stiffness(chain.stiff_springs());
    check(chain, springs, chain.one_spring_excited());
    check(chain, springs.mollified(Mollifier::ShortAverage), chain.one_spring_excited());
    check(chain, Evi::midpoint(0.02).stiffness(chain.stiff_springs()), chain.one_spring_excited());
}

#[test]
fn no_step_with_fitted_weights_or_a_reference_allocates() {
    check(OSCILLATOR, Evi::simpson(0.01).frequency(OSCILLATOR.frequency()).fitted(), SWING);
    check(PENDULUM, Evi::simpson(0.01).frequency(OMEGA).about([0.1]), SWING);
    let hanging = [0.0, -1.0, 0.0, -2.0];
    check(DOUBLE, Evi::simpson(0.01).frequency(OMEGA).fitted().about(hanging), mild());
    check(DOUBLE, Evi::midpoint(0.01).frequencies(PER_BODY).about(hanging), mild());
}

#[test]
fn no_step_of_a_baseline_allocates() {
    check(DOUBLE, Rattle::new(0.01), mild());
    check(SPHERICAL, Rattle::new(0.01), SPHERICAL.one_radian());
    check(OSCILLATOR, Rattle::new(0.01), SWING);
    check(DOUBLE, Rk4::new(0.01), mild());
    check(SPHERICAL, Rk4::new(0.01), SPHERICAL.one_radian());
    check(SPRING, Rk4::new(0.01), SPRING.horizontal());
    check(DOUBLE, Shake::new(0.01), mild());
    check(OSCILLATOR, Shake::new(0.01), SWING);
    check(DOUBLE, ImplicitMidpoint::new(0.01), mild());
    check(SPRING, ImplicitMidpoint::new(0.01), SPRING.horizontal());
    check(DOUBLE, ImplicitMidpoint::new(0.01).composed(Composition::suzuki_4()), mild());
    check(DOUBLE, GeneralizedAlpha::new(0.01), mild());
    check(SPRING, GeneralizedAlpha::new(0.01), SPRING.horizontal());
    // Steps that need the curvature of the constraints.
    check(DOUBLE, GeneralizedAlpha::new(0.05), DOUBLE.horizontal());
}

#[test]
fn no_step_of_a_composition_allocates() {
    check(DOUBLE, Evi::midpoint(0.01).composed(Composition::kahan_li_8()), mild());
    check(DOUBLE, Evi::simpson(0.01).frequencies(PER_BODY).composed(Composition::suzuki_4()), mild());
    check(SPHERICAL, Rattle::new(0.01).composed(Composition::yoshida_6()), SPHERICAL.one_radian());
    check(PENDULUM, Evi::simpson(0.01).composed(Composition::triple_jump_4()), SWING);
}

#[test]
fn no_step_of_a_galerkin_integrator_allocates() {
    check(DOUBLE, Galerkin::<1>::new(0.01), mild());
    check(DOUBLE, Galerkin::<3>::new(0.01), mild());
    check(DOUBLE, Galerkin::<8>::new(0.01), mild());
    check(DOUBLE, Galerkin::<3>::new(0.01).frequencies(PER_BODY), mild());
    check(SPHERICAL, Galerkin::<2>::new(0.01).frequency(OMEGA), SPHERICAL.one_radian());
    check(SPRING, Galerkin::<4>::new(0.01), SPRING.horizontal());
    check(DOUBLE, Galerkin::<1>::new(0.01).composed(Composition::suzuki_4()), mild());
    check(DOUBLE, Galerkin::<3>::new(0.01).by_newton(), mild());
}

#[test]
fn no_step_of_a_gauss_integrator_allocates() {
    check(SPRING, Gauss::<8>::new(0.01), SPRING.horizontal());
    check(PENDULUM, Gauss::<3>::new(0.01).compensated(), SWING);
    check(PENDULUM, Gauss::<3>::new(0.01).by_newton(), SWING);
}

#[test]
fn no_compensated_step_allocates() {
    check(DOUBLE, Evi::midpoint(0.01).compensated(), mild());
    check(DOUBLE, Evi::midpoint(0.01).composed(Composition::kahan_li_8()).compensated(), mild());
    check(DOUBLE, Galerkin::<3>::new(0.01).compensated(), mild());
    check(SPRING, Evi::simpson(0.01).compensated(), SPRING.horizontal());
}

#[test]
fn no_step_with_forces_allocates() {
    let (driven, start) = (DrivenPendulum::STANDARD, DrivenPendulum::STANDARD.horizontal());
    check(driven, Evi::midpoint(0.01), start);
    check(driven, Evi::simpson(0.01).frequency(OMEGA), start);
    check(driven, Rk4::new(0.01), start);
    check(DampedOscillator::STANDARD, Evi::simpson(0.01).scene_frequencies(), SWING);
    let mut run = Simulation::new(driven, Evi::midpoint(0.01)).start(start.q, start.v).unwrap();
    assert_eq!(allocations(|| assert!(black_box(run.observe())[1].is_finite())), 0);
    run.advance().unwrap();
    let dumbbell = PushedDumbbell::STANDARD;
    let Start { q, v } = dumbbell.turning();
    let mut run = Simulation::new(dumbbell, Evi::simpson(0.01)).start(q, v).unwrap();
    let steps = || {
        for step in 0..1_000 {
            run.set_inputs([f64::from(step % 5), -1.0]);
            run.advance().expect("the step exists");
        }
    };
    assert_eq!(allocations(steps), 0);
}

/// Takes 1,000 steps of the generic path and expects that none allocates.
#[track_caller]
fn check_generic<S: GenericSystem, const N: usize>(system: S, scheme: impl GenericScheme, start: Start<N>) {
    let mut run = scheme.start(system, &start.q, &start.v).expect("the start is consistent");
    assert_eq!(allocations(|| assert!(run.advance_to(10.0).is_ok())), 0);
    assert_eq!(run.steps(), 1_000);
}

#[test]
fn no_step_of_the_generic_path_allocates() {
    check_generic(PENDULUM, GenericEvi::midpoint(0.01), SWING);
    check_generic(DOUBLE, GenericEvi::midpoint(0.01), mild());
    check_generic(DOUBLE, GenericEvi::simpson(0.01).frequencies(PER_BODY), mild());
    check_generic(
        DrivenPendulum::STANDARD,
        GenericEvi::midpoint(0.01),
        DrivenPendulum::STANDARD.horizontal(),
    );
    check_generic(SPHERICAL, GenericEvi::simpson(0.01).frequency(OMEGA), SPHERICAL.one_radian());
    check_generic(DOUBLE, GenericGalerkin::new(3, 0.01), mild());
}

#[test]
fn going_to_a_time_does_not_allocate() {
    let mut run = Simulation::new(DOUBLE, Evi::midpoint(0.01)).start(mild().q, mild().v).unwrap();
    assert_eq!(allocations(|| assert!(run.advance_to(10.0).is_ok())), 0);
    assert_eq!(run.steps(), 1_000);
}

#[test]
fn watching_does_not_allocate() {
    let run = Simulation::new(DOUBLE, Evi::midpoint(0.01)).start(mild().q, mild().v).unwrap();
    let mut run = run.with_tally(Diagnostics::default());
    let limits = Limits::of(&run)
        .energy_change(1.0)
        .constraint(1e-12)
        .hidden_constraint(1e-12)
        .steps(2_000)
        .wall_time(Duration::from_secs(3600));
    let mut watch = (EnergyDrift::of(&run), limits);
    assert_eq!(allocations(|| assert!(run.advance_observed(10.0, &mut watch).is_ok())), 0);
    assert_eq!(run.steps(), 1_000);
    // What is written down asks for memory.
    assert!(allocations(|| drop(run.checkpoint())) > 0);
}

#[test]
fn a_step_that_fails_does_not_allocate() {
    // At this step size and frequency the step equations lose their solution after 2.1 units of time.
    let scheme = Evi::simpson(0.1).frequency(9.81_f64.sqrt());
    let horizontal = DOUBLE.horizontal();
    let mut run = Simulation::new(DOUBLE, scheme).start(horizontal.q, horizontal.v).unwrap();
    let mut failure = None;
    let allocations = allocations(|| failure = run.advance_to(10.0).err());
    assert_eq!(allocations, 0);
    assert!(matches!(failure, Some(StepError::NoSolution { .. })), "{failure:?}");
}

#[test]
fn a_step_that_is_taken_in_parts_does_not_allocate() {
    let scheme = Evi::simpson(0.1).frequency(9.81_f64.sqrt()).rescued::<6>();
    let horizontal = DOUBLE.horizontal();
    let mut run = Simulation::new(DOUBLE, scheme).start(horizontal.q, horizontal.v).unwrap();
    assert_eq!(allocations(|| assert!(run.advance_to(5.0).is_ok())), 0);
    assert!(run.map().rescues().steps > 0);
}

#[test]
fn no_step_on_a_null_space_allocates() {
    check(OfRank::<_, 2>(DOUBLE), Evi::midpoint(0.01), mild());
}

/// Takes 50 steps of an assembled scene and expects that none allocates.
#[track_caller]
fn check_assembled(placed: Placed, scheme: impl AssembledScheme) {
    let Placed { truss, q } = placed;
    let rest = vec![0.0; q.len()];
    let mut run = AssembledSimulation::new(truss, scheme).start(q, rest).expect("the start is consistent");
    let before = run.state().clone();
    let allocations = allocations(|| {
        for _ in 0..50 {
            run.advance().expect("the step exists");
        }
    });
    assert_eq!(allocations, 0);
    assert_ne!(*run.state(), before, "the run stood still");
}

#[test]
fn no_step_of_an_assembled_scene_allocates() {
    check_assembled(chain(20), Evi::midpoint(0.002));
    check_assembled(ring(10), Evi::midpoint(0.01).composed(Composition::suzuki_4()));
    check_assembled(net(3), Evi::midpoint(0.01));
    check_assembled(net(3), Evi::trapezoid(0.01));
    check_assembled(net(3), Galerkin::<8>::new(0.02));
    check_assembled(net(3), Galerkin::<8>::new(0.02).by_newton());
}
