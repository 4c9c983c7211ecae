//! The generic path: the specialised path's trajectories to round-off, systems of run-time size, errors.

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

// Trajectories of the specialised path.

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

// Systems of run-time size.

/// A plane chain of point masses on massless rods, y upwards; as many as `links` has entries.
#[derive(Clone)]
struct Chain {
    /// Mass and length of each link.
    links: Vec<(f64, f64)>,
    g: f64,
}

impl Chain {
    fn alternating(n_links: usize) -> Self {
        Self {
            links: (0..n_links).map(|i| if i % 2 == 0 { (1.0, 0.5) } else { (0.3, 0.8) }).collect(),
            g: 9.81,
        }
    }

    /// At rest, every link at `angle` from the downward vertical.
    fn at_angle(&self, angle: f64) -> Vec<f64> {
        let mut end = (0.0, 0.0);
        let mut q = vec![];
        for (_, length) in &self.links {
            end = (end.0 + length * angle.sin(), end.1 - length * angle.cos());
            q.extend([end.0, end.1]);
        }
        q
    }

    fn run(&self, scheme: &GenericEvi) -> GenericRun<Self> {
        let q = self.at_angle(0.4);
        scheme.start(self.clone(), &q, &vec![0.0; q.len()]).expect("the start is consistent")
    }
}

impl GenericSystem for Chain {
    fn n_coordinates(&self) -> usize {
        2 * self.links.len()
    }

    fn n_constraints(&self) -> usize {
        self.links.len()
    }

    fn lagrangian<T: Scalar>(&self, _t: T, q: &[T], v: &[T]) -> T {
        let mut lagrangian = T::from_f64(0.0);
        for (i, &(mass, _)) in self.links.iter().enumerate() {
            let kinetic = T::from_f64(0.5 * mass) * (v[2 * i].powi(2) + v[2 * i + 1].powi(2));
            lagrangian = lagrangian + kinetic - T::from_f64(mass * self.g) * q[2 * i + 1];
        }
        lagrangian
    }

    fn constraints<T: Scalar>(&self, _t: T, q: &[T], residuals: &mut [T]) {
        let mut start = [T::from_f64(0.0); 2];
        for (i, &(_, length)) in self.links.iter().enumerate() {
            let end = [q[2 * i], q[2 * i + 1]];
            let (dx, dy) = (end[0] - start[0], end[1] - start[1]);
            residuals[i] = dx.powi(2) + dy.powi(2) - T::from_f64(length * length);
            start = end;
        }
    }
}

#[test]
fn a_chain_of_any_length_keeps_its_rods_and_its_energy() {
    for n_links in [1, 2, 3, 5, 8] {
        let chain = Chain::alternating(n_links);
        let mut run = chain.run(&GenericEvi::midpoint(0.005));
        let energy = run.energy();
        let (mut early, mut late) = (0.0_f64, 0.0_f64);
        for step in 0..4_000 {
            run.advance().expect("the step exists");
            let error = (run.energy() - energy).abs();
            if step < 1_000 {
                early = early.max(error)
            } else {
                late = late.max(error)
            }
            // Three terms of the size of the squared coordinates, up to 5² for the longest chain.
            let residual = largest_difference(&run.constraint_residual(), &vec![0.0; n_links]);
            assert!(residual <= 64.0 * f64::EPSILON, "{n_links} links, step {step}: {residual:e}");
            let hidden = largest_difference(&run.hidden_constraint_residual(), &vec![0.0; n_links]);
            assert!(hidden <= 64.0 * f64::EPSILON, "{n_links} links, step {step}: {hidden:e}");
        }
        assert!(early > 1e-6 && late < 3.0 * early, "{n_links} links: {early:e}, later {late:e}");
    }
}

#[test]
fn a_chain_of_two_links_is_the_double_pendulum() {
    let [(m1, l1), (m2, l2)] = Chain::alternating(2).links[..] else { panic!("two links") };
    let derived = DoublePendulum { m1, m2, l1, l2, g: 9.81 };
    let mut chain = Chain::alternating(2).run(&GenericEvi::simpson(H).frequency(OMEGA));
    let mut run = Simulation::new(derived, Evi::simpson(H).frequency(OMEGA))
        .start(derived.at_angles(0.4, 0.4).q, [0.0; 4])
        .expect("the start is consistent");
    chain.advance_to(1.0).expect("the steps exist");
    run.advance_to(1.0).expect("the steps exist");
    let difference = largest_difference(chain.q(), run.state().q());
    assert!(difference <= 1e3 * f64::EPSILON, "{difference:e}");
}

#[test]
fn steps_back_return_to_the_start() {
    let chain = Chain::alternating(6);
    let mut there = chain.run(&GenericEvi::simpson(H));
    let start = there.q().to_vec();
    there.advance_to(0.5).expect("the steps exist");
    assert!(largest_difference(there.q(), &start) > 0.1, "the chain stood still");
    let mut back = GenericEvi::simpson(-H)
        .start_at(chain, there.t(), there.q(), there.v())
        .expect("a state is consistent");
    back.advance_to(0.0).expect("the steps exist");
    let difference = largest_difference(back.q(), &start);
    assert!(difference <= 1e4 * f64::EPSILON && back.t().abs() < 1e-15, "{difference:e}");
}

#[test]
fn solvers_of_both_paths_stand_in_one_list() {
    let Start { q, v } = SPHERICAL.one_radian();
    let specialised = Simulation::new(SPHERICAL, Evi::midpoint(H)).start(q, v).expect("consistent");
    let generic = GenericEvi::midpoint(H).start(SPHERICAL, &q, &v).expect("consistent");
    let mut solvers: Vec<Box<dyn Solver>> = vec![Box::new(specialised), Box::new(generic)];
    for solver in &mut solvers {
        solver.advance_to(0.5).expect("the steps exist");
    }
    let [a, b] = &solvers[..] else { panic!("two solvers") };
    assert_eq!((a.t(), a.steps()), (b.t(), b.steps()));
    assert_ne!(a.q(), q);
    for (a, b) in [(a.q(), b.q()), (a.v(), b.v()), (a.p(), b.p())] {
        assert!(largest_difference(a, b) <= 1e3 * f64::EPSILON, "{a:?} and {b:?}");
    }
}

// Errors.

/// The error of a start that must fail.
#[track_caller]
fn start_error<S: GenericSystem>(scheme: GenericEvi, system: S, q: &[f64], v: &[f64]) -> StartError {
    match scheme.start(system, q, v) {
        Ok(run) => panic!("started at {:?}", run.q()),
        Err(error) => error,
    }
}

#[test]
fn vectors_of_another_length_are_refused() {
    let error = start_error(GenericEvi::midpoint(H), SPHERICAL, &[0.0; 2], &[0.0; 3]);
    assert_eq!(error, StartError::Length { quantity: "position", expected: 3, found: 2 });
    let error = start_error(GenericEvi::midpoint(H), SPHERICAL, &[0.0, 0.0, -1.0], &[0.0; 4]);
    assert_eq!(error, StartError::Length { quantity: "velocity", expected: 3, found: 4 });
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    let error = start_error(GenericEvi::midpoint(H), SPHERICAL, &[0.0, f64::NAN, -1.0], &[0.0; 3]);
    assert!(matches!(error, StartError::NotFinite { quantity: "position", index: 1, .. }), "{error:?}");
    let error = start_error(GenericEvi::midpoint(H), SPHERICAL, &[0.0, 0.0, -1.0], &[0.0, 0.0, 1e200]);
    assert!(matches!(error, StartError::NotFinite { quantity: "energy", .. }), "{error:?}");
}

#[test]
fn an_inconsistent_start_is_refused_by_the_place_of_its_constraint() {
    let chain = Chain::alternating(3);
    let mut q = chain.at_angle(0.2);
    let mut v = [0.0; 6];
    v[4] = 1.0;
    let error = start_error(GenericEvi::midpoint(H), chain.clone(), &q, &v);
    let StartError::InconsistentVelocity { constraint, residual, allowed } = error else {
        panic!("{error:?}")
    };
    // The last rod's gradient is (−sin, cos, sin, −cos) by the two ends.
    assert_eq!(constraint, ConstraintLabel::Index(2));
    assert!((residual - 0.2_f64.sin() / 2.0_f64.sqrt()).abs() < 1e-14 && allowed < 1e-10, "{residual}");
    assert!(error.to_string().contains("leaves constraint 2: "), "{error}");
    q[5] -= 0.1;
    let error = start_error(GenericEvi::midpoint(H), chain.clone(), &q, &[0.0; 6]);
    let StartError::InconsistentPosition { constraint, residual, .. } = error else { panic!("{error:?}") };
    assert_eq!(constraint, ConstraintLabel::Index(2));
    assert!(residual > 0.01);
    let run = GenericEvi::midpoint(H).start_projected(chain, 0.0, &q, &v).expect("near the chain");
    assert!(run.constraint_residual().iter().all(|residual| residual.abs() < 1e-15));
    assert!(run.hidden_constraint_residual().iter().all(|residual| *residual < 1e-15));
}

#[test]
fn schemes_that_define_no_step_are_refused() {
    let refused = |scheme: GenericEvi| {
        let Start { q, v } = SPHERICAL.one_radian();
        match start_error(scheme, SPHERICAL, &q, &v) {
            StartError::Scheme(error) => error,
            error => panic!("not the scheme is refused: {error:?}"),
        }
    };
    assert_eq!(refused(GenericEvi::midpoint(0.0)), SchemeError::StepSize { h: 0.0 });
    let negative = refused(GenericEvi::midpoint(H).frequency(-1.0));
    assert_eq!(negative, SchemeError::Frequency { coordinate: 0, value: -1.0 });
    let frequencies = [OMEGA, OMEGA, core::f64::consts::PI / H].map(Frequency::from);
    let resonant = refused(GenericEvi::midpoint(H).frequencies(frequencies));
    assert!(matches!(resonant, SchemeError::ResonantFrequency { coordinate: 2, .. }), "{resonant:?}");
    let blind = refused(GenericEvi::simpson(H).frequency(2.0 * core::f64::consts::FRAC_PI_3 / H));
    assert!(matches!(blind, SchemeError::VanishingInertia { coordinate: 0, .. }), "{blind:?}");
    let few = refused(GenericEvi::midpoint(H).frequencies([Frequency::ZERO; 2]));
    assert_eq!(few, SchemeError::FrequencyCount { frequencies: 2, coordinates: 3 });
    assert!(few.to_string().contains("2 frequencies for 3 coordinates"));
}

/// A mass that is gone at time `end`, on a circle whose squared radius shrinks at unit rate when `held`.
#[derive(Clone, Copy)]
struct Vanishing {
    end: f64,
    held: bool,
}

impl GenericSystem for Vanishing {
    fn n_coordinates(&self) -> usize {
        2
    }

    fn n_constraints(&self) -> usize {
        usize::from(self.held)
    }

    fn lagrangian<T: Scalar>(&self, t: T, _q: &[T], v: &[T]) -> T {
        (T::from_f64(self.end) - t) * (v[0].powi(2) + v[1].powi(2))
    }

    fn constraints<T: Scalar>(&self, t: T, q: &[T], residuals: &mut [T]) {
        if self.held {
            residuals[0] = q[0].powi(2) + q[1].powi(2) - (T::from_f64(1.0) - t);
        }
    }
}

/// The error of the first step that fails, at most `steps` from the start; it fails twice alike and changes nothing.
#[track_caller]
fn step_error<S: GenericSystem>(mut run: GenericRun<S>, steps: u64) -> StepError {
    loop {
        assert!(run.steps() < steps, "no step failed");
        let numbers = |run: &GenericRun<S>| {
            (run.t(), run.steps(), [run.q(), run.v(), run.p()].concat(), run.hidden_constraint_residual())
        };
        let before = numbers(&run);
        if let Err(error) = run.advance() {
            // Equality of every bit.
            assert_eq!(numbers(&run), before);
            let again = run.advance().expect_err("the same step fails again");
            assert_eq!(format!("{again:?}"), format!("{error:?}"));
            assert_eq!(numbers(&run), before);
            return error;
        }
    }
}

#[test]
fn a_step_without_a_solution_leaves_the_run_where_it_stands() {
    let shrinking = Vanishing { end: 10.0, held: true };
    let run = GenericEvi::midpoint(0.03).start(shrinking, &[1.0, 0.0], &[-0.5, 0.2]).expect("consistent");
    let error = step_error(run, 34);
    let StepError::NoSolution { t, constraint_residual, .. } = error else { panic!("{error:?}") };
    assert!(t < 1.0 && t > 0.9 && constraint_residual > 1e-3, "{error:?}");
}

#[test]
fn a_step_without_mass_is_singular() {
    let massless_at_the_node = Vanishing { end: 0.5 * H, held: false };
    let run = GenericEvi::midpoint(H).start(massless_at_the_node, &[1.0, 0.0], &[0.1, 0.2]).expect("free");
    let error = step_error(run, 1);
    assert!(matches!(error, StepError::Singular { t: 0.0, correction: 1, .. }), "{error:?}");
}

#[test]
fn an_end_without_mass_cannot_be_projected() {
    let massless_at_the_end = Vanishing { end: H, held: false };
    let run = GenericEvi::midpoint(H).start(massless_at_the_end, &[1.0, 0.0], &[0.1, 0.2]).expect("free");
    let error = step_error(run, 1);
    let StepError::Projection { t, cause: ProjectionError::Singular(matrix) } = error else {
        panic!("{error:?}")
    };
    assert_eq!((t, matrix.pivot_ratio), (H, 0.0));
}

#[test]
fn a_start_where_nothing_determines_the_motion_is_refused() {
    let error =
        start_error(GenericEvi::midpoint(H), Vanishing { end: 0.0, held: false }, &[1.0, 0.0], &[0.0; 2]);
    assert!(matches!(error, StartError::Projection(ProjectionError::Singular(_))), "{error:?}");
}

#[test]
fn a_time_that_is_no_number_of_steps_away_is_refused_before_any_step() {
    let mut run = Chain::alternating(2).run(&GenericEvi::midpoint(H));
    for target in [f64::NAN, f64::INFINITY, 1e30] {
        let error = run.advance_to(target).expect_err("unreachable");
        assert!(matches!(error, StepError::UnreachableTime { h: H, .. }), "{error:?}");
        assert_eq!(run.steps(), 0);
    }
}
