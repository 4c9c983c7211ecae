//! Time of one step, method beside method on one scene: `cargo bench -p evi-benches`.
//!
//! A run goes on through the motion, so that branches and Newton's iterations are those of real runs.

use criterion::{Criterion, criterion_group, criterion_main};
use evi_core::baseline::{Rattle, Rk4};
use evi_core::generic::{GenericEvi, GenericScheme, GenericSystem};
use evi_core::prelude::*;
use evi_examples::{DoublePendulum, SphericalPendulum, Start, StiffSpringPendulum};

const H: f64 = 0.01;

fn steps(criterion: &mut Criterion) {
    let pendulum = DoublePendulum::UNIT;
    let mut group = criterion.benchmark_group("double_pendulum");
    let start = pendulum.at_angles(0.1, 0.1);
    let frequencies = [Frequency::from(3.132), 3.132.into(), 2.397.into(), 2.397.into()];
    measure(&mut group, "evi_midpoint", Simulation::new(pendulum, Evi::midpoint(H)), start);
    measure(&mut group, "evi_simpson", Simulation::new(pendulum, Evi::simpson(H)), start);
    let exponential = Evi::simpson(H).frequency(2.397);
    measure(&mut group, "evi_simpson_omega", Simulation::new(pendulum, exponential), start);
    let per_coordinate = Evi::simpson(H).frequencies(frequencies);
    measure(&mut group, "evi_simpson_omega_per_coordinate", Simulation::new(pendulum, per_coordinate), start);
    measure_generic(&mut group, "generic_midpoint", pendulum, &GenericEvi::midpoint(H), start);
    measure_generic(&mut group, "generic_simpson", pendulum, &GenericEvi::simpson(H), start);
    measure(&mut group, "rattle", Simulation::new(pendulum, Rattle::new(H)), start);
    measure(&mut group, "rk4", Simulation::new(pendulum, Rk4::new(H)), start);
    group.finish();

    let pendulum = SphericalPendulum::UNIT;
    let mut group = criterion.benchmark_group("spherical_pendulum");
    measure(&mut group, "evi_midpoint", Simulation::new(pendulum, Evi::midpoint(H)), pendulum.one_radian());
    measure(&mut group, "rattle", Simulation::new(pendulum, Rattle::new(H)), pendulum.one_radian());
    group.finish();

    let spring = StiffSpringPendulum::with_stiffness(1e4);
    let mut group = criterion.benchmark_group("stiff_spring_pendulum");
    measure(&mut group, "evi_midpoint", Simulation::new(spring, Evi::midpoint(H)), spring.horizontal());
    measure(&mut group, "rk4", Simulation::new(spring, Rk4::new(0.1 * H)), spring.horizontal());
    group.finish();
}

/// Times the steps of a run that goes on between the samples.
fn measure<const N: usize, S, F>(
    group: &mut criterion::BenchmarkGroup<'_, criterion::measurement::WallTime>,
    name: &str,
    simulation: Simulation<S, F>,
    start: Start<N>,
) where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S>,
{
    let mut run = simulation.start(start.q, start.v).expect("the gallery's starts are consistent");
    group.bench_function(name, |bencher| {
        bencher.iter(|| run.advance().map(State::t).expect("the step sizes are small enough"));
    });
}

/// Times the steps of a run of the generic path.
fn measure_generic<const N: usize, S: GenericSystem>(
    group: &mut criterion::BenchmarkGroup<'_, criterion::measurement::WallTime>,
    name: &str,
    system: S,
    scheme: &GenericEvi,
    start: Start<N>,
) {
    let mut run = scheme.start(system, &start.q, &start.v).expect("the gallery's starts are consistent");
    group.bench_function(name, |bencher| {
        bencher.iter(|| run.advance().expect("the step sizes are small enough"));
    });
}

criterion_group!(benches, steps);
criterion_main!(benches);
