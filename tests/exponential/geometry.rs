//! Symplectic form, symmetry and momentum maps of matrix frequencies.

use evi_core::generic::GenericSystem;
use evi_core::mechanics::Mechanics;
use evi_core::prelude::*;
use evi_examples::{FermiPastaUlam, Start};
use evi_tests::matrix_action::MatrixFrequencyAction;
use evi_tests::scenes::DoublePendulumInAngles;
use evi_tests::tangent::{DiscreteAction, TangentSpace, symplectic_defect};
use evi_tests::{Random, largest_difference};
use nalgebra::DMatrix;

use super::fixtures::{Bead, Molecule};

const H: f64 = 0.05;

/// Steps of `scheme`, against the action as a formula.
#[track_caller]
fn check_symplectic<S, F, const N: usize>(
    system: S,
    scheme: F,
    action: &MatrixFrequencyAction,
    start: Start<N>,
) where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + GenericSystem + Clone,
    F: Scheme<S>,
{
    let mut run = Simulation::new(system.clone(), scheme).start(start.q, start.v).expect("a start");
    let before = TangentSpace::at(&system, run.state()).momentum;
    let mut after = before.clone();
    for _ in 0..5 {
        let state = run.state().clone();
        let next = run.advance().expect("a step");
        after = action.tangent_map(&system, &state, next) * after;
    }
    let roundings = symplectic_defect(&before, &after);
    // Measured 7.6: the second derivatives of the formula are of size M/h, twenty times the norm that they add up to.
    assert!(roundings <= 12.0, "the form changes by {roundings:.0} roundings");
}

fn matrix<const N: usize>(rows: &[[f64; N]; N]) -> DMatrix<f64> {
    DMatrix::from_fn(N, N, |row, col| rows[row][col])
}

#[test]
fn the_shifted_double_pendulum_is_symplectic() {
    let angles = DoublePendulumInAngles::UNEQUAL;
    let system = angles.constrained();
    let hanging = [0.0, -angles.l1, 0.0, -angles.l1 - angles.l2];
    let linearisation = Mechanics::new(&system).linearised_at(&hanging).expect("an equilibrium");
    let masses = [system.m1, system.m1, system.m2, system.m2];
    let mut random = Random::new(3);
    for _ in 0..3 {
        let start = angles.cartesian(random.array(-1.5, 1.5), random.array(-3.0, 3.0));
        check_every_rule(
            system,
            (&masses, matrix(linearisation.stiffness())),
            &linearisation,
            hanging,
            start,
        );
    }
}

#[test]
fn a_constraint_of_varying_curvature_is_symplectic() {
    let bead = Bead::STANDARD;
    let linearisation = Mechanics::new(&bead).linearised_at(&[0.0, 0.8]).expect("an equilibrium");
    let masses = [bead.m; 2];
    let stiffness = matrix(linearisation.stiffness());
    check_every_rule(bead, (&masses, stiffness), &linearisation, [0.0, 0.8], bead.at(0.5, 0.4));
}

#[track_caller]
fn check_every_rule<S, const N: usize>(
    system: S,
    quadratic: (&[f64], DMatrix<f64>),
    linearisation: &evi_core::mechanics::Linearisation<S>,
    near: [f64; N],
    start: Start<N>,
) where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + GenericSystem + Clone,
{
    let (reference, multipliers) = (linearisation.reference(), linearisation.multipliers().as_ref());
    let plain = |_: f64| 1.0;
    let rule = Quadrature::<2>::uniform();
    let action = MatrixFrequencyAction::new(
        &rule,
        (quadratic.0, quadratic.1.clone()),
        reference,
        multipliers,
        plain,
        H,
    );
    check_symplectic(system.clone(), Evi::new(rule, H).linearised_at(near), &action, start);
    let sinc = |u: f64| u.sin() / u;
    let action = MatrixFrequencyAction::new(
        &rule,
        (quadratic.0, quadratic.1.clone()),
        reference,
        multipliers,
        sinc,
        H,
    );
    let mollified = Evi::new(rule, H).linearised_at(near).mollified(Mollifier::LongAverage);
    check_symplectic(system.clone(), mollified, &action, start);
    let rule = Quadrature::midpoint();
    let action = MatrixFrequencyAction::new(
        &rule,
        (quadratic.0, quadratic.1.clone()),
        reference,
        multipliers,
        plain,
        H,
    );
    check_symplectic(system.clone(), Evi::new(rule, H).linearised_at(near), &action, start);
    let rule = Quadrature::<3>::gauss();
    let action =
        MatrixFrequencyAction::new(&rule, (quadratic.0, quadratic.1), reference, multipliers, plain, H);
    check_symplectic(system, Evi::new(rule, H).linearised_at(near), &action, start);
}

#[test]
fn the_chain_of_stiff_springs_is_symplectic_beyond_the_stability_of_verlet() {
    let chain = FermiPastaUlam::STANDARD;
    for phase in [0.7, 2.2, 4.0] {
        let h = phase / chain.omega;
        let stiffness = chain.stiff_springs();
        let action = |filter: &dyn Fn(f64) -> f64| {
            let rule = Quadrature::<2>::uniform();
            MatrixFrequencyAction::new(&rule, (&[1.0; 6], matrix(&stiffness)), &[0.0; 6], &[], filter, h)
        };
        let start = chain.one_spring_excited();
        check_symplectic(chain, Evi::trapezoid(h).stiffness(stiffness), &action(&|_| 1.0), start);
        let mollified = Evi::trapezoid(h).stiffness(stiffness).mollified(Mollifier::ShortAverage);
        check_symplectic(chain, mollified, &action(&|u| (0.5 * u).sin() / (0.5 * u)), start);
    }
}

/// 50 steps there and 50 back.
#[track_caller]
fn check_symmetric<S, F, const N: usize>(system: S, scheme: impl Fn(f64) -> F, start: Start<N>)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Copy,
    F: Scheme<S>,
{
    let mut there = Simulation::new(system, scheme(H)).start(start.q, start.v).expect("a start");
    for _ in 0..50 {
        there.advance().expect("a step");
    }
    let far = there.state();
    assert!(largest_difference(far.q(), &start.q) > 0.05, "vacuous");
    let mut back = Simulation::new(system, scheme(-H)).start(*far.q(), *far.v()).expect("a start");
    for _ in 0..50 {
        back.advance().expect("a step");
    }
    let state = back.state();
    let error = largest_difference(state.q(), &start.q).max(largest_difference(state.v(), &start.v));
    println!("{}: {error:.1e}", core::panic::Location::caller());
    // Round-off of 100 steps: 2.3e-15 measured.
    assert!(error <= 1e-14, "{error:e}");
}

#[test]
fn steps_undo_each_other() {
    let angles = DoublePendulumInAngles::UNEQUAL;
    let start = angles.cartesian([0.8, -0.3], [0.5, 1.1]);
    let hanging = [0.0, -angles.l1, 0.0, -angles.l1 - angles.l2];
    let system = angles.constrained();
    check_symmetric(system, |h| Evi::trapezoid(h).linearised_at(hanging), start);
    check_symmetric(system, |h| Evi::simpson(h).linearised_at(hanging), start);
    check_symmetric(
        system,
        |h| Evi::midpoint(h).linearised_at(hanging).mollified(Mollifier::LinearAverage),
        start,
    );
    let bead = Bead::STANDARD;
    check_symmetric(bead, |h| Evi::midpoint(h).linearised_at([0.0, 0.8]), bead.at(0.5, 0.4));
}

/// Largest change of linear momentum over 2,000 steps.
fn momentum_change<F: Scheme<Molecule>>(scheme: F) -> f64 {
    let system = Molecule::STANDARD;
    let start = system.moving();
    let mut run = Simulation::new(system, scheme).start(start.q, start.v).expect("a start");
    let momentum = |state: &State<Molecule>| {
        let p = state.p();
        [p[0] + p[2] + p[4], p[1] + p[3] + p[5]]
    };
    let before = momentum(run.state());
    let mut largest = 0.0_f64;
    for _ in 0..2_000 {
        largest = largest.max(largest_difference(&momentum(run.advance().expect("a step")), &before));
    }
    assert!((run.state().q()[0] - start.q[0]).abs() > 5.0, "vacuous: it stays");
    largest
}

#[test]
fn translations_in_the_kernel_of_the_stiffness_conserve_momentum() {
    let straight = momentum_change(Evi::trapezoid(0.01));
    let impulse = momentum_change(Evi::trapezoid(0.01).linearised_at(Molecule::REST));
    let midpoint = momentum_change(Evi::midpoint(0.01).linearised_at(Molecule::REST));
    let simpson = momentum_change(Evi::simpson(0.01).linearised_at(Molecule::REST));
    println!(
        "straight {straight:.1e}, impulse {impulse:.1e}, midpoint {midpoint:.1e}, Simpson {simpson:.1e}"
    );
    // Round-off of 2,000 steps, as on straight curves.
    assert!(impulse <= 1e-13, "{impulse:e}");
    // The rows of T add up to a rounding in the place of 0, which a body 10 away from its reference feels at every step:
    // 1.2e-15 a step measured.
    assert!(midpoint <= 1e-11 && simpson <= 1e-11, "{midpoint:e}, {simpson:e}");
    // A frequency for all coordinates knows no translations.
    assert!(momentum_change(Evi::simpson(0.01).frequency(3.0)) > 1e-2);
}
