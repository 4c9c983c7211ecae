//! What diagnostics say of steps whose numbers are known.

use std::f64::consts::PI;

use evi_core::integrator::{Diagnostics, Statistics};
use evi_core::prelude::*;
use evi_examples::{DoublePendulum, SphericalPendulum, StiffSpringPendulum};

/// A bead on a spring, in space on the line where two planes meet at a small angle.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(x, y, z),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2) + der(z).powi(2)),
    potential = 0.5 * k * x.powi(2) + m * 9.81 * z,
    constraint(floor: z == 0.0),
    constraint(ramp: z + angle * y == 0.0),
)]
struct Bead {
    m: f64,
    k: f64,
    angle: f64,
}

/// The condition of `G M⁻¹ Gᵀ`, in closed form: of `[1 1; 1 1 + α²]`.
#[track_caller]
fn check_bead(exponent: i32) {
    let angle = 2.0_f64.powi(-exponent);
    let bead = Bead { m: 4.0, k: 30.0, angle };
    let run = Simulation::new(bead, Evi::midpoint(0.01)).start([0.1, 0.0, 0.0], [0.2, 0.0, 0.0]).unwrap();
    let mut run = run.with_tally(Diagnostics::default());
    run.advance_to(0.2).unwrap();
    let (square, worst) = (angle * angle, run.tally().condition().expect("two constraints"));
    let expected = (2.0 + square).powi(2) / square;
    println!(
        "angle 2^-{exponent}: condition {:e}, pivot ratio {:e}",
        worst.value,
        run.tally().pivot_ratio().unwrap().value
    );
    // The elimination of a matrix of that condition: 1 ε times it, at most.
    assert!(
        (worst.value / expected - 1.0).abs() <= f64::EPSILON * expected,
        "{worst:?}, expected {expected:e}"
    );
    // It is the same in every step: the first one is named.
    assert_eq!(worst.step, 0);
    let ratio = run.tally().pivot_ratio().unwrap().value;
    assert!((ratio / square - 1.0).abs() <= 2.0 * square + f64::EPSILON / square, "{ratio:e}");
}

#[test]
fn constraints_at_a_small_angle_show_their_condition() {
    check_bead(2);
    check_bead(6);
    check_bead(12);
}

/// The diagnostics of a run of 200 steps, and that they change none.
#[track_caller]
fn diagnosed<S, F, const N: usize>(system: S, scheme: F, q: [f64; N]) -> Diagnostics
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Clone,
    F: Scheme<S> + Clone,
{
    let simulation = Simulation::new(system, scheme);
    let start = || simulation.start(q, [0.0; N]).expect("a consistent start");
    let (mut watched, mut counted) =
        (start().with_tally(Diagnostics::default()), start().with_tally(Statistics::default()));
    for _ in 0..200 {
        watched.advance().expect("the step exists");
        counted.advance().expect("the step exists");
    }
    assert_eq!(watched.state(), counted.state());
    assert_eq!(watched.tally().counts(), counted.tally());
    // A checkpoint keeps them.
    let resumed = simulation.resume_with(&watched.checkpoint(), Diagnostics::default()).unwrap();
    assert_eq!(resumed.tally(), watched.tally());
    let diagnostics = *watched.tally();
    println!(
        "{:?}\n  {:?}\n  {:?}",
        diagnostics.condition(),
        diagnostics.pivot_ratio(),
        diagnostics.contraction()
    );
    diagnostics
}

#[test]
fn every_kind_of_step_is_seen() {
    let double = DoublePendulum { m1: 1.3, m2: 0.7, l1: 0.9, l2: 1.1, g: 9.81 };
    let folded = diagnosed(double, Evi::midpoint(0.01), double.horizontal().q);
    let condition = folded.condition().unwrap().value;
    assert!(condition > 1.0 && condition < 100.0 && folded.pivot_ratio().unwrap().value > 0.1);
    // Without a past, the first guess is the motion without constraint forces.
    let contraction = folded.contraction().unwrap();
    assert!(contraction.value > 0.0 && contraction.value < 0.5, "{contraction:?}");

    let spring = StiffSpringPendulum::with_stiffness(1e3);
    let general = diagnosed(spring, Evi::simpson(0.01), spring.horizontal().q);
    assert!(general.condition().unwrap().value < 10.0 && general.contraction().unwrap().value < 0.5);

    let galerkin = Galerkin::<3>::new(0.02).by_newton();
    let newton = diagnosed(double, galerkin, double.horizontal().q);
    assert!(newton.pivot_ratio().unwrap().value < folded.pivot_ratio().unwrap().value);
    assert!(newton.contraction().unwrap().value < 0.5 && newton.condition().is_some());
}

#[test]
fn a_scene_in_other_units_has_the_same_condition() {
    let of = |unit: f64| {
        let double = DoublePendulum { m1: 1.3 * unit, m2: 0.7 * unit, l1: 0.9, l2: 1.1, g: 9.81 };
        diagnosed(double, Evi::midpoint(0.01), double.horizontal().q).condition()
    };
    // Powers of four, whose roots are powers of two: to the last bit.
    assert_eq!(of(1.0), of(4.0_f64.powi(20)));
}

#[test]
fn a_prepared_map_tells_how_far_it_is_from_resonance() {
    let spherical = SphericalPendulum::UNIT;
    let frequencies = [Frequency::ZERO, Frequency::from(2.0), Frequency::Hyperbolic(3.0)];
    let scheme = Evi::simpson(0.25).frequencies(frequencies).allow_soft_modes();
    let run = Simulation::new(spherical, scheme.composed(Composition::suzuki_4()))
        .start(spherical.one_radian().q, spherical.one_radian().v)
        .unwrap();
    let near = |x: f64, y: f64| (x - y).abs() < 1e-14;
    for (stage, fraction) in run.map().stages().iter().zip(Composition::suzuki_4().fractions()) {
        let [straight, trigonometric, hyperbolic] = stage.resonances();
        let u = 0.5 * fraction.abs();
        assert!(straight.phase == 0.0 && near(straight.margin(), 2.0 * PI / 3.0));
        assert!(near(trigonometric.phase, u) && near(trigonometric.to_resonance, PI - u));
        assert!(near(trigonometric.margin(), 2.0 * PI / 3.0 - u));
        assert!(near(hyperbolic.phase, 1.5 * u) && hyperbolic.margin() == f64::INFINITY);
    }
    let double = DoublePendulum::UNIT;
    let scheme = Evi::trapezoid(0.5).linearised_at([0.0, -1.0, 0.0, -2.0]);
    let run = Simulation::new(double, scheme).start(double.at_angles(0.1, 0.1).q, [0.0; 4]).unwrap();
    for mode in run.map().modes() {
        println!("{mode:?}, {} from resonance", mode.to_resonance());
        assert!((mode.phase.sin().abs() - mode.to_resonance().sin()).abs() < 1e-14);
    }
}
