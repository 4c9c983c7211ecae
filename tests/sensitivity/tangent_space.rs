//! What the derivative of a step keeps, and that it is the one that dual numbers give.

use evi_core::generic::GenericSystem;
use evi_core::prelude::*;
use evi_core::sensitivity::{Differentiable, Differentiate, Direction};
use evi_examples::Start;
use evi_tests::scenes::{ChargedSphericalPendulum, DoublePendulumInAngles};
use evi_tests::tangent::{Action, DiscreteAction, TangentSpace, symplectic_defect};
use nalgebra::DMatrix;

const H: f64 = 0.05;
const STEPS: u32 = 5;

/// An orthonormal frame of the tangent space at the start, and what five steps make of it.
fn frames<S, F, const N: usize>(simulation: &Simulation<S, F>, start: Start<N>) -> [DMatrix<f64>; 2]
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + GenericSystem,
    F: Scheme<S, Step: Differentiable<S>>,
{
    let run = simulation.start(start.q, start.v).expect("a start");
    let space = TangentSpace::at(simulation.system(), run.state());
    let directions: Vec<Direction<S>> = (0..space.velocity.ncols())
        .map(|column| {
            let part =
                |from: usize| -> [f64; N] { core::array::from_fn(|i| space.velocity[(from + i, column)]) };
            Direction::of_start(part(0), part(N))
        })
        .collect();
    let mut run = simulation.with_tangents(run, &directions).expect("tangents");
    for _ in 0..STEPS {
        run.advance().expect("a step");
    }
    let after = DMatrix::from_fn(2 * N, directions.len(), |row, column| {
        let tangent = &run.tangents()[column];
        if row < N { tangent.q()[row] } else { tangent.p()[row - N] }
    });
    [space.momentum, after]
}

/// Of `‖DΨ‖²`; measured 2.3.
const ROUNDINGS: f64 = 8.0;

#[test]
fn the_symplectic_form_is_kept_on_the_constraint_manifold() {
    let angles = DoublePendulumInAngles::UNEQUAL;
    let start = angles.cartesian([0.9, -0.4], [1.1, 2.3]);
    for [before, after] in [
        frames(&Simulation::new(angles.constrained(), Evi::midpoint(H)), start),
        frames(&Simulation::new(angles.constrained(), Galerkin::<3>::new(H)), start),
    ] {
        assert!(symplectic_defect(&before, &after) <= ROUNDINGS);
    }
    let system = ChargedSphericalPendulum::STANDARD;
    let [before, after] = frames(&Simulation::new(system, Evi::simpson(H)), system.one_radian());
    assert!(symplectic_defect(&before, &after) <= ROUNDINGS);
}

/// The derivative of the step by hyper-dual numbers on the generic copy of the scene, in which no emitted kernel takes part.
#[test]
fn it_is_the_derivative_that_dual_numbers_give() {
    let system = ChargedSphericalPendulum::STANDARD;
    let start = system.one_radian();
    let simulation = Simulation::new(system, Evi::simpson(H));
    let [before, after] = frames(&simulation, start);
    let action = Action::new(&Quadrature::<3>::uniform(), [Frequency::ZERO; 3], H);
    let mut run = simulation.start(start.q, start.v).expect("a start");
    let mut expected = before;
    for _ in 0..STEPS {
        let state = run.state().clone();
        let next = run.advance().expect("a step");
        expected = action.tangent_map(&system, &state, next) * expected;
    }
    let error = (&after - &expected).amax() / expected.amax();
    println!("{error:e}");
    // Differences of momenta of size M q / h in either: measured 3e-15.
    assert!(error <= 1e-14, "off by {error:e}");
}
