//! Starts, and their projection on the constraints.

use super::*;

#[test]
fn a_run_stands_at_its_start() {
    let Start { q, v } = moving();
    let run = midpoint_run();
    // A consistent position is not touched; a velocity and its momentum are rounded in the projection.
    assert_eq!(run.state().q(), &q);
    check_near(run.state().v(), &v, 4.0 * EPSILON);
    let momentum = [UNEQUAL.m1 * v[0], UNEQUAL.m1 * v[1], UNEQUAL.m2 * v[2], UNEQUAL.m2 * v[3]];
    check_near(run.state().p(), &momentum, 4.0 * EPSILON);
    assert_eq!((run.state().t(), run.steps()), (0.0, 0));
}

#[test]
fn arrays_and_vectors_of_nalgebra_start_a_run() {
    let Start { q, v } = moving();
    let simulation = Simulation::new(UNEQUAL, Evi::midpoint(0.01));
    let array = simulation.start(q, v).expect("consistent");
    let vector =
        simulation.start(SVector::<f64, 4>::from(q), SVector::<f64, 4>::from(v)).expect("consistent");
    assert_eq!(array.state(), vector.state());
}

#[test]
fn a_simulation_starts_as_many_runs_as_one_likes() {
    let Start { q, v } = moving();
    let simulation = Simulation::new(UNEQUAL, Evi::midpoint(0.01));
    let (mut first, mut second) = (simulation.start(q, v).unwrap(), simulation.start_at(3.0, q, v).unwrap());
    assert_eq!((second.state().t(), second.steps()), (3.0, 0));
    first.advance_to(1.0).unwrap();
    second.advance_to(4.0).unwrap();
    // Nothing in this scene depends on time.
    assert_eq!(first.state().q(), second.state().q());
    assert_eq!(simulation.system().m1, 1.3);
}

/// Of the consistent starts, the nearest in the metric of the masses: what was added is a combination of
/// the constraints' gradients over the masses, hence orthogonal to every velocity that the constraints allow.
#[track_caller]
fn check_projection<S, const N: usize>(
    system: S,
    t: f64,
    masses: [f64; N],
    gradients: impl Fn(&[f64; N]) -> Vec<[f64; N]>,
    start: Start<N>,
) where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
{
    let simulation = Simulation::new(system, Evi::midpoint(0.01));
    let inconsistent = simulation.start_at(t, start.q, start.v).err();
    assert!(matches!(inconsistent, Some(StartError::InconsistentPosition { .. })), "nothing to project");
    let run = simulation.start_projected(t, start.q, start.v).expect("the manifold is near");
    let state = run.state();
    assert_eq!(state.t(), t);
    for residual in run.mechanics().constraint_residual(state).as_ref() {
        assert!(residual.abs() <= 8.0 * EPSILON, "{residual:e}");
    }
    for residual in run.mechanics().hidden_constraint_residual(state).as_ref() {
        assert!(*residual <= 4.0 * EPSILON, "{residual:e}");
    }
    let gradients = gradients(state.q());
    let normal = DMatrix::from_fn(N, gradients.len(), |i, c| gradients[c][i] / masses[i].sqrt());
    check_normal(&normal, DVector::from_fn(N, |i, _| masses[i].sqrt() * (state.q()[i] - start.q[i])));
}

/// The part of `displacement` outside the columns of `normal` is round-off.
#[track_caller]
fn check_normal(normal: &DMatrix<f64>, displacement: DVector<f64>) {
    let inside = normal * normal.clone().svd(true, true).solve(&displacement, 0.0).expect("both factors");
    let outside = (&displacement - inside).norm() / displacement.norm();
    assert!(displacement.norm() > 1e-3, "vacuous: {:e}", displacement.norm());
    // A difference of positions of size 2 is off by 2 ε, over its own size of 1e-3 or more; in the metric of
    // masses a factor 1e3 apart, 30 times that: 1.2e-13 measured.
    assert!(outside <= 1e-12, "a part {outside:e} of the displacement lies in the manifold");
}

fn rods(q: &[f64; 4]) -> Vec<[f64; 4]> {
    let rod = [q[2] - q[0], q[3] - q[1]];
    vec![[q[0], q[1], 0.0, 0.0], [-rod[0], -rod[1], rod[0], rod[1]]]
}

#[test]
fn a_start_is_projected_to_the_nearest_consistent_one() {
    let masses = [UNEQUAL.m1, UNEQUAL.m1, UNEQUAL.m2, UNEQUAL.m2];
    let Start { q, v } = moving();
    // A per mille, and a third of the rods.
    for size in [1e-3, 3e-2, 0.3] {
        let q = [q[0] + size, q[1] - 0.6 * size, q[2] + 0.8 * size, q[3] + 1.1 * size];
        check_projection(UNEQUAL, 0.0, masses, rods, Start { q, v });
    }
    // Very different masses: the heavy bob stays, the light one moves.
    let lever = DoublePendulum { m1: 1e-3, m2: 1e3, ..UNEQUAL };
    let masses = [1e-3, 1e-3, 1e3, 1e3];
    check_projection(lever, 0.0, masses, rods, Start { q: [q[0] + 0.1, q[1], q[2], q[3] - 0.1], v });
}

#[test]
fn a_start_is_projected_on_constraints_that_move() {
    let system = KapitzaPendulum::STANDARD;
    let t = 0.4;
    let pivot = system.a * (system.w * t).cos();
    let gradient = |q: &[f64; 2]| vec![[q[0], q[1] - pivot]];
    check_projection(system, t, [1.0; 2], gradient, Start { q: [0.2, pivot + 0.3], v: [0.4, -0.2] });
}

#[test]
fn a_velocity_is_projected_in_the_metric_of_the_masses() {
    let Start { q, v } = moving();
    let thrown = [v[0] + 1.0, v[1] - 0.3, v[2], v[3] + 0.5];
    let simulation = Simulation::new(UNEQUAL, Evi::midpoint(0.01));
    assert!(matches!(simulation.start(q, thrown), Err(StartError::InconsistentVelocity { .. })));
    let run = simulation.start_projected(0.0, q, thrown).expect("a velocity can always be projected");
    // The position satisfied the constraints to round-off.
    check_near(run.state().q(), &q, 4.0 * EPSILON);
    let masses = [UNEQUAL.m1, UNEQUAL.m1, UNEQUAL.m2, UNEQUAL.m2];
    let rods = rods(run.state().q());
    let normal = DMatrix::from_fn(4, 2, |i, c| rods[c][i] / masses[i].sqrt());
    check_normal(&normal, DVector::from_fn(4, |i, _| masses[i].sqrt() * (run.state().v()[i] - thrown[i])));
}

#[test]
fn without_constraints_a_projected_start_is_the_start() {
    let simulation = Simulation::new(Pendulum { m: 1.0, l: 1.0, g: 9.81 }, Evi::midpoint(0.01));
    let run = simulation.start_projected(0.0, [0.3], [0.7]).unwrap();
    assert_eq!((run.state().q(), run.state().v()), (&[0.3], &[0.7]));
}
