//! Steps, times, recordings.

use super::*;

#[test]
fn time_is_the_start_plus_a_number_of_steps() {
    let Start { q, v } = moving();
    for (start, h) in [(0.0, 0.01), (17.3, 0.01), (17.3, -0.01)] {
        let mut run = Simulation::new(UNEQUAL, Evi::midpoint(h)).start_at(start, q, v).unwrap();
        for k in 1..=1_000 {
            // Equality of bits: one rounding of the product, one of the sum, however many steps.
            assert_eq!(run.advance().unwrap().t(), start + f64::from(k) * h);
            assert_eq!(run.steps(), k as u64);
        }
    }
}

#[test]
fn a_run_goes_to_the_step_nearest_to_a_time() {
    let mut run = midpoint_run();
    for (t, steps) in [(0.996, 100), (1.004, 100), (1.0, 100), (0.992, 100), (1.006, 101)] {
        run.advance_to(t).unwrap();
        assert_eq!(run.steps(), steps, "to {t}");
    }
    for t in [0.5, -3.0] {
        assert!(run.advance_to(t).is_err(), "{t} is behind");
        assert_eq!(run.steps(), 101);
    }
}

#[test]
fn a_run_with_negative_steps_goes_back_in_time() {
    let Start { q, v } = moving();
    let mut run = Simulation::new(UNEQUAL, Evi::midpoint(-0.01)).start_at(2.0, q, v).unwrap();
    assert!(run.advance_to(2.5).is_err(), "ahead");
    assert_eq!(run.steps(), 0);
    run.advance_to(1.0).unwrap();
    assert_eq!((run.steps(), run.state().t()), (100, 1.0));
}

/// 100 steps there and back again.
#[track_caller]
fn check_return<S, F, const N: usize>(system: S, there: F, back: F, start: Start<N>)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Copy,
    F: Scheme<S>,
{
    let mut run = Simulation::new(system, there).start(start.q, start.v).unwrap();
    let end = run.advance_to(1.0).unwrap();
    assert!(largest_difference(end.q(), &start.q) > 1e-2, "the run stood still");
    let (t, q, v) = (end.t(), *end.q(), *end.v());
    let mut run = Simulation::new(system, back).start_at(t, q, v).expect("the end is consistent");
    let end = run.advance_to(0.0).unwrap();
    assert_eq!(end.t(), 0.0);
    // Round-off of 200 steps, which the motion amplifies little in one unit of time: 10 ε measured.
    check_near(end.q(), &start.q, 64.0 * EPSILON);
}

#[test]
fn symmetric_schemes_come_back() {
    check_return(UNEQUAL, Evi::midpoint(0.01), Evi::midpoint(-0.01), moving());
    check_return(UNEQUAL, Evi::simpson(0.01).frequency(2.0), Evi::simpson(-0.01).frequency(2.0), moving());
    check_return(UNEQUAL, Rattle::new(0.01), Rattle::new(-0.01), moving());
    let kapitza = KapitzaPendulum::STANDARD;
    check_return(kapitza, Evi::midpoint(0.01), Evi::midpoint(-0.01), kapitza.near_inverted());
}

#[test]
fn a_recording_keeps_every_state() {
    let mut run = midpoint_run();
    let mut other = midpoint_run();
    let trajectory = run.integrate(0.5).unwrap();
    assert_eq!(trajectory.states().len(), 51);
    assert_eq!(&trajectory.states()[0], other.state());
    for state in &trajectory.states()[1..] {
        assert_eq!(state, other.advance().unwrap());
    }
    assert_eq!(trajectory.last(), run.state());
    // The next recording begins where this one ended.
    let next = run.integrate(0.1).unwrap();
    assert_eq!((&next.states()[0], next.states().len()), (trajectory.last(), 11));
    assert_eq!(run.integrate(0.0).unwrap().states().len(), 1);
    assert_eq!(run.integrate(-1.0).unwrap_err().trajectory.states().len(), 1);
}
