//! Trajectories of the specialised path.

use super::*;

/// Both paths add the same numbers in another order; 100 steps and the motion itself let the rounding errors grow: in ε,
/// 2 (harmonic oscillator) to 36 (stiff spring) measured.
const ALLOWED: f64 = 128.0;

/// Takes 100 steps of both paths side by side; the largest difference of a position, velocity or momentum, in ε of the
/// largest of its kind so far.
fn difference<S, F, const N: usize>(
    system: S,
    (specialised, generic): (F, impl GenericScheme),
    Start { q, v }: Start<N>,
) -> f64
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + GenericSystem + Copy,
    F: Scheme<S>,
{
    const T0: f64 = 0.3;
    let mut specialised =
        Simulation::new(system, specialised).start_projected(T0, q, v).expect("near a consistent start");
    let mut generic = generic.start_projected(system, T0, &q, &v).expect("near a consistent start");
    let start = generic.q().to_vec();
    let (mut largest, mut sizes) = (0.0_f64, [0.0_f64; 3]);
    for step in 0..100 {
        for (k, input) in specialised.inputs_mut().as_mut().iter_mut().enumerate() {
            *input = 0.3 * f64::from(step % 9) - k as f64;
        }
        generic.inputs_mut().copy_from_slice(specialised.state().inputs().as_ref());
        specialised.advance().expect("the step exists");
        generic.advance().expect("the step exists");
        let state = specialised.state();
        let pairs: [(&[f64], &[f64]); 3] =
            [(state.q(), generic.q()), (state.v(), generic.v()), (state.p(), generic.p())];
        for ((a, b), size) in pairs.into_iter().zip(&mut sizes) {
            *size = a.iter().fold(*size, |size, x| size.max(x.abs()));
            let difference = largest_difference(a, b) / *size;
            // A NaN must not pass.
            largest = if difference <= largest { largest } else { difference };
        }
        assert_eq!((generic.t(), generic.steps()), (state.t(), specialised.steps()));
    }
    assert!(largest_difference(&start, generic.q()) > 1e-3, "the run stood still");
    let state = specialised.state();
    let (mechanics, inputs) = (specialised.mechanics(), state.inputs());
    let expected = mechanics.acceleration_with(state.t(), state.q(), state.v(), inputs).expect("determined");
    let found = generic.acceleration().expect("determined");
    let pairs: [(&[f64], &[f64]); 2] = [
        (expected.acceleration.as_ref(), found.acceleration.as_slice()),
        (expected.multipliers.as_ref(), found.multipliers.as_slice()),
    ];
    for (a, b) in pairs {
        // Forces of the stiff spring amplify the difference of the positions a thousandfold.
        let size = a.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
        assert!(largest_difference(a, b) <= 1e-10 * size, "{a:?} and {b:?}");
    }
    let energy = specialised.energy();
    assert!((generic.energy() - energy).abs() <= 1e-9 * energy.abs().max(1.0), "{energy}");
    assert!(generic.constraint_residual().iter().all(|residual| residual.abs() < 1e-14));
    assert!(generic.hidden_constraint_residual().iter().all(|residual| *residual < 1e-14));
    largest / f64::EPSILON
}

/// Compares midpoint, Simpson and Gauss nodes with linear, trigonometric and hyperbolic curves, one for all and one each.
#[track_caller]
fn check<S, const N: usize>(system: S, start: Start<N>)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N], PerCoordinate<Frequency> = [Frequency; N]>
        + GenericSystem
        + Copy,
{
    let (midpoint, simpson) = (Evi::midpoint(H), Evi::simpson(H));
    let (generic_midpoint, generic_simpson) = (GenericEvi::midpoint(H), GenericEvi::simpson(H));
    let gauss = Quadrature::<3>::gauss();
    let each: [Frequency; N] = core::array::from_fn(|i| match i % 3 {
        0 => Frequency::from(OMEGA),
        1 => Frequency::Hyperbolic(1.3),
        _ => Frequency::ZERO,
    });
    let differences = [
        ("midpoint", difference(system, (midpoint, generic_midpoint.clone()), start)),
        ("Simpson", difference(system, (simpson, generic_simpson.clone()), start)),
        ("Gauss", difference(system, (Evi::new(gauss, H), GenericEvi::new(&gauss, H)), start)),
        (
            "midpoint, one frequency",
            difference(system, (midpoint.frequency(OMEGA), generic_midpoint.clone().frequency(OMEGA)), start),
        ),
        (
            "Simpson, one frequency",
            difference(system, (simpson.frequency(OMEGA), generic_simpson.clone().frequency(OMEGA)), start),
        ),
        (
            "midpoint, one frequency each",
            difference(system, (midpoint.frequencies(each), generic_midpoint.frequencies(each)), start),
        ),
        (
            "Simpson, one frequency each",
            difference(system, (simpson.frequencies(each), generic_simpson.frequencies(each)), start),
        ),
    ];
    for (scheme, difference) in differences {
        assert!(difference <= ALLOWED, "{scheme}: {difference:.0} ε, allowed {ALLOWED}");
    }
}

/// Compares Galerkin members on polynomials and on mixed curves, found by other iterations on other matrices.
#[track_caller]
fn check_galerkin<S, const N: usize>(system: S, start: Start<N>)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N], PerCoordinate<Frequency> = [Frequency; N]>
        + GenericSystem
        + Copy,
{
    let h = 4.0 * H;
    let (fourth, third) = (Galerkin::<4>::new(h), Galerkin::<3>::new(h).frequency(OMEGA));
    let (generic_fourth, generic_third) =
        (GenericGalerkin::new(4, h), GenericGalerkin::new(3, h).frequency(OMEGA));
    for (scheme, difference) in [
        ("polynomials", difference(system, (fourth, generic_fourth), start)),
        ("mixed curves", difference(system, (third, generic_third), start)),
    ] {
        println!("{scheme}: {difference:.0} ε");
        assert!(difference <= ALLOWED, "{scheme}: {difference:.0} ε, allowed {ALLOWED}");
    }
}

#[test]
fn galerkin_members_agree_with_constraints_forces_and_a_mass_that_depends_on_positions() {
    let charged = ChargedSphericalPendulum::STANDARD;
    check_galerkin(charged, charged.one_radian());
    check_galerkin(PushedDumbbell::STANDARD, PushedDumbbell::STANDARD.turning());
    check_galerkin(MotorisedDoublePendulum::STANDARD, DoublePendulumInAngles::MODERATE);
}

#[test]
fn pendulum() {
    check(Pendulum { m: 1.3, l: 0.9, g: 9.81 }, Start { q: [1.0], v: [0.5] });
}

#[test]
fn harmonic_oscillator() {
    check(HarmonicOscillator { m: 2.0, k: 3.0 }, Start { q: [1.0], v: [0.5] });
}

#[test]
fn double_pendulum() {
    let pendulum = DoublePendulumInAngles::UNEQUAL;
    let Start { q, v } = DoublePendulumInAngles::MODERATE;
    check(pendulum.constrained(), pendulum.cartesian(q, v));
}

#[test]
fn double_pendulum_from_the_horizontal() {
    check(DoublePendulum::UNIT, DoublePendulum::UNIT.horizontal());
}

#[test]
fn spherical_pendulum() {
    check(SPHERICAL, SPHERICAL.one_radian());
}

#[test]
fn stiff_spring_pendulum() {
    let spring = StiffSpringPendulum::with_stiffness(1e3);
    check(spring, spring.horizontal());
}

#[test]
fn a_mass_matrix_that_depends_on_the_configuration() {
    check(DoublePendulumInAngles::UNEQUAL, DoublePendulumInAngles::MODERATE);
}

#[test]
fn gyroscopic_coupling() {
    check(ChargedParticle { m: 0.8, b: 2.5 }, Start { q: [0.6, -0.4], v: [0.5, 1.0] });
}

#[test]
fn gyroscopic_coupling_and_a_constraint() {
    let pendulum = ChargedSphericalPendulum::STANDARD;
    check(pendulum, pendulum.one_radian());
}

#[test]
fn drag_a_drive_and_a_constraint() {
    check(DrivenPendulum::STANDARD, DrivenPendulum::STANDARD.horizontal());
}

#[test]
fn drag_and_inputs_and_a_constraint() {
    check(PushedDumbbell::STANDARD, PushedDumbbell::STANDARD.turning());
}

#[test]
fn forces_whose_derivatives_are_not_symmetric() {
    check(MotorisedDoublePendulum::STANDARD, DoublePendulumInAngles::MODERATE);
}

#[test]
fn a_damped_oscillator() {
    check(DampedOscillator::STANDARD, Start { q: [1.0], v: [0.5] });
}

#[test]
fn a_potential_that_depends_on_time() {
    check(ModulatedPendulum { g: 9.81, a: 0.4, w: 17.0 }, Start { q: [0.7], v: [0.2] });
}

#[test]
fn a_mass_that_depends_on_time() {
    check(DampedPendulum { g: 9.81, c: 0.7 }, Start { q: [0.7], v: [0.2] });
}

#[test]
fn a_lagrangian_that_is_not_quadratic_in_the_velocity() {
    check(RelativisticBead::STANDARD, RelativisticBead::at_angle(0.9, 2.0));
}

#[test]
fn a_constraint_that_depends_on_time() {
    check(KapitzaPendulum::STANDARD, KapitzaPendulum::STANDARD.near_inverted());
}

#[test]
fn motion_without_forces() {
    check(Dumbbell::STANDARD, Dumbbell::STANDARD.turning());
}
