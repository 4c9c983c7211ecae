//! What the steps keep: the way back, constraints, momenta, the symplectic form.

use super::*;

/// 64 roundings of velocities of size 4 (8.9e-16), after 100 steps.
const ROUND_OFF: f64 = 64.0 * 4.0 * f64::EPSILON;

#[track_caller]
fn check_returns<S, F, const N: usize>(system: S, start: Start<N>, scheme: impl Fn(f64) -> F, h: f64)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Clone,
    F: Scheme<S>,
{
    let distance = there_and_back(system, scheme, start, h, 50);
    assert!(distance <= ROUND_OFF, "misses the start by {distance:e}");
}

#[test]
fn a_step_back_undoes_a_step() {
    let (system, start) = swing();
    check_returns(system, start, Galerkin::<2>::new, 0.02);
    check_returns(system, start, Galerkin::<5>::new, 0.02);
    check_returns(system, start, Galerkin::<8>::new, 0.05);
    check_returns(system, start, |h| Galerkin::<1>::new(h).frequency(3.13), 0.02);
    check_returns(system, start, |h| Galerkin::<3>::new(h).frequency(3.13), 0.02);
    let angles = DoublePendulumInAngles::UNEQUAL;
    check_returns(angles, DoublePendulumInAngles::MODERATE, Galerkin::<4>::new, 0.02);
    let charged = ChargedSphericalPendulum::STANDARD;
    check_returns(charged, charged.one_radian(), Galerkin::<3>::new, 0.02);
    let bead = RelativisticBead::STANDARD;
    check_returns(bead, RelativisticBead::at_angle(1.0, -2.0), Galerkin::<3>::new, 0.02);
    let crank = SliderCrank::STANDARD;
    check_returns(crank, crank.stretched_out(5.0), Galerkin::<3>::new, 0.01);
    let moving = KapitzaPendulum::STANDARD;
    check_returns(moving, moving.near_inverted(), Galerkin::<3>::new, 0.002);
}

#[test]
fn constraints_and_angular_momentum() {
    const STEPS: usize = 10_000;
    /// Momenta of size 4 on an arm of 1, rounded at random in each of 10⁴ steps: `ε · 4 · √10⁴`.
    const LONG_ROUND_OFF: f64 = 4.0 * 100.0 * f64::EPSILON;
    let system = SphericalPendulum::UNIT;
    let start = system.one_radian();
    let polynomial = Galerkin::<3>::new(0.05);
    let mixed = Galerkin::<2>::new(0.05).frequency(2.0);
    let angular = |q: &[f64], p: &[f64]| angular_momentum(q, p, 0);
    /// Known limitation: the rounding of the tables of passes is the same in every step, 1.0e-17 of each (docs/design/0007).
    const OF_TABLES: f64 = 1e-17 * STEPS as f64;
    for (change, bound) in [
        (largest_change(system, polynomial, start, STEPS, angular), LONG_ROUND_OFF + OF_TABLES),
        (largest_change(system, polynomial.by_newton(), start, STEPS, angular), LONG_ROUND_OFF),
        (largest_change(system, mixed, start, STEPS, angular), LONG_ROUND_OFF),
    ] {
        assert!(change <= bound, "angular momentum changes by {change:e}");
    }
    let (double, swing) = swing();
    for [constraint, hidden] in [
        largest_residuals(system, polynomial, start, STEPS),
        largest_residuals(system, mixed, start, STEPS),
        largest_residuals(double, polynomial, swing, STEPS),
        largest_residuals(double, Galerkin::<5>::new(0.05), swing, STEPS),
    ] {
        // 5 ε and 0.9 ε measured.
        assert!(constraint <= 8.0 * f64::EPSILON, "φ: {constraint:e}");
        assert!(hidden <= 4.0 * f64::EPSILON, "G v: {hidden:e}");
    }
}

/// Constants are among the curves from two intervals on, whatever the frequency.
#[test]
fn linear_momentum_of_a_free_dumbbell() {
    /// Momenta of size 6, rounded at random in each of 200 steps: `ε · 6 · √200`.
    const ROUND_OFF: f64 = 6.0 * 14.2 * f64::EPSILON;
    #[track_caller]
    fn change<F: Scheme<Dumbbell> + Copy>(scheme: F) -> f64 {
        let system = Dumbbell::STANDARD;
        let along = |i: usize| {
            let momentum = move |_: &[f64], p: &[f64]| p[i] + p[2 + i];
            largest_change(system, scheme, system.turning(), 200, momentum)
        };
        along(0).max(along(1))
    }
    assert!(change(Galerkin::<1>::new(0.05)) <= ROUND_OFF);
    assert!(change(Galerkin::<3>::new(0.05)) <= ROUND_OFF);
    assert!(change(Galerkin::<8>::new(0.05)) <= ROUND_OFF);
    assert!(change(Galerkin::<2>::new(0.05).frequency(3.0)) <= ROUND_OFF);
    assert!(change(Galerkin::<3>::new(0.05).frequency(3.0)) <= ROUND_OFF);
    assert!(change(Galerkin::<4>::new(0.05).frequency(Frequency::Hyperbolic(3.0))) <= ROUND_OFF);
    // Known property of one interval: cos and sin alone contain no constant.
    let lost = change(Galerkin::<1>::new(0.05).frequency(3.0));
    assert!(lost > 0.1, "changes by {lost:e} only");
}

/// One step against an action of the test's own, and the form under its derivative; `P` nodes for `K` intervals.
#[track_caller]
fn check_symplectic<S, F, const K: usize, const P: usize, const N: usize>(
    system: S,
    scheme: Galerkin<K, F>,
    frequencies: [f64; N],
    start: Start<N>,
) where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + GenericSystem + Clone,
    F: NodalCurves<S> + Clone,
{
    let action = GalerkinAction::new::<P, N>(frequencies, scheme.step_size());
    let mut run = Simulation::new(system.clone(), scheme).start(start.q, start.v).expect("a start");
    let before = TangentSpace::at(&system, run.state()).momentum;
    let mut after = before.clone();
    for _ in 0..3 {
        let state = run.state().clone();
        let end = run.advance().expect("a step");
        let step = action.step(&system, &state, end);
        let difference = largest_difference(&step.q, end.q());
        println!("{}: off by {difference:e}", core::panic::Location::caller());
        // Newton's iteration of two programs: 3 ε measured; from the raw functions of three intervals 50 ε.
        assert!(difference <= 128.0 * f64::EPSILON, "{difference:e}");
        after = step.tangent_map * after;
    }
    let roundings = symplectic_defect(&before, &after);
    // 15 measured, where the mass depends on the configuration.
    assert!(roundings <= 32.0, "the form changes by {roundings:.0} roundings");
}

#[test]
fn the_symplectic_form() {
    const H: f64 = 0.05;
    let (system, start) = swing();
    check_symplectic::<_, _, 1, 2, 4>(system, Galerkin::new(H), [0.0; 4], start);
    check_symplectic::<_, _, 2, 3, 4>(system, Galerkin::new(H), [0.0; 4], start);
    check_symplectic::<_, _, 3, 4, 4>(system, Galerkin::new(H), [0.0; 4], start);
    check_symplectic::<_, _, 1, 2, 4>(system, Galerkin::new(H).frequency(3.13), [3.13; 4], start);
    // Phases of about 1: for smaller ones the raw functions of the test lose digits.
    let curves = [20.0, 0.0, 25.0, 30.0];
    let frequencies = curves.map(Frequency::Trigonometric);
    check_symplectic::<_, _, 2, 3, 4>(system, Galerkin::new(H).frequencies(frequencies), curves, start);
    check_symplectic::<_, _, 3, 4, 4>(system, Galerkin::new(H).frequencies(frequencies), curves, start);
    let charged = ChargedSphericalPendulum::STANDARD;
    check_symplectic::<_, _, 2, 3, 3>(charged, Galerkin::new(H), [0.0; 3], charged.one_radian());
    let angles = DoublePendulumInAngles::UNEQUAL;
    let moderate = DoublePendulumInAngles::MODERATE;
    check_symplectic::<_, _, 3, 4, 2>(angles, Galerkin::new(H), [0.0; 2], moderate);
    let crank = SliderCrank::STANDARD;
    check_symplectic::<_, _, 3, 4, 3>(crank, Galerkin::new(0.2 * H), [0.0; 3], crank.stretched_out(5.0));
}
