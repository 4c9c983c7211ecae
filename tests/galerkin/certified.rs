//! Positions and velocities against certified digits, on the two scenes of the test set.

use super::*;

#[track_caller]
fn check<S, F, const N: usize>(system: S, start: Start<N>, end: Certified, scheme: F, bound: f64)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S>,
{
    let mut run = Simulation::new(system, scheme).start_projected(0.0, start.q, start.v).expect("a start");
    let state = run.advance_to(end.t).expect("every step").clone();
    let at_end = run.mechanics().acceleration(end.t, state.q(), state.v()).expect("a regular end");
    let [constraint, hidden] =
        [run.mechanics().constraint_residual(&state), run.mechanics().hidden_constraint_residual(&state)]
            .map(|residuals| residuals.as_ref().iter().fold(0.0_f64, |largest, x| largest.max(x.abs())));
    let relative = |x: &[f64], exact: &[f64]| distance(x, exact) / distance(exact, &vec![0.0; exact.len()]);
    let errors = [
        relative(state.q(), end.q),
        relative(state.v(), end.v),
        relative(at_end.multipliers.as_ref(), end.multipliers),
    ];
    println!(
        "{}: after {}: {errors:?}, φ {constraint:e}, G v {hidden:e}",
        core::panic::Location::caller(),
        end.t
    );
    assert!(errors.iter().all(|error| *error <= bound), "{errors:?}");
    // Squares of coordinates of size 1: 2 ε measured. The hidden constraints of the car axis feel a rounding of the time at the
    // end, 2 ε, times the accelerations of its road, where the stages of a composition end beside it: 9 ε measured.
    assert!(constraint <= 4.0 * f64::EPSILON && hidden <= 16.0 * f64::EPSILON, "{constraint:e}, {hidden:e}");
}

#[test]
fn car_axis() {
    let (system, start) = (CarAxis::STANDARD, CarAxis::STANDARD.standard_start());
    for end in references::CAR_AXIS {
        check(system, start, end, Galerkin::<3>::new(0.0025), 1e-9);
        check(system, start, end, Galerkin::<5>::new(0.01), 1e-9);
        check(system, start, end, Evi::midpoint(0.005).composed(Composition::kahan_li_8()), 1e-9);
    }
}

#[test]
fn andrews_squeezer() {
    let (system, start) = (AndrewsSqueezer::STANDARD, AndrewsSqueezer::STANDARD.standard_start());
    for end in references::ANDREWS_SQUEEZER {
        check(system, start, end, Galerkin::<4>::new(5e-5), 1e-12);
        check(system, start, end, Evi::midpoint(5e-5).composed(Composition::kahan_li_8()), 1e-12);
    }
}
