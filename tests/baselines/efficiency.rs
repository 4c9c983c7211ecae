//! Corrections that a step takes.

use super::*;

/// Mean number of Newton corrections over a motion.
#[track_caller]
fn check<S, F>(motion: &Motion<S>, scheme: impl Fn(f64) -> F, bound: f64)
where
    S: MechanicalSystem + Clone,
    F: Scheme<S>,
{
    let n = motion.steps[2];
    let q = S::PerCoordinate::<f64>::from_fn(|i| motion.q0[i]);
    let v = S::PerCoordinate::<f64>::from_fn(|i| motion.v0[i]);
    let simulation = Simulation::new(motion.system.clone(), scheme(motion.t / f64::from(n)));
    let mut run = simulation.start(q, v).expect("consistent").with_tally(Statistics::default());
    (0..n).for_each(|_| assert!(run.advance().is_ok()));
    let mean = run.tally().corrections as f64 / f64::from(n);
    println!("{}: {mean:.2} in {n} steps", core::panic::Location::caller());
    assert!(mean <= bound, "{mean:.2} corrections per step");
}

#[test]
fn two_or_three_corrections_do() {
    // From 2.0 to 3.0 measured: a wrong or missing derivative would take 5 or more.
    check(&double_pendulum(), Rattle::new, 2.1);
    check(&double_pendulum(), Shake::new, 2.1);
    check(&double_pendulum(), ImplicitMidpoint::new, 2.6);
    check(&charged_spherical_pendulum(), ImplicitMidpoint::new, 3.1);
    check(&relativistic_bead(), ImplicitMidpoint::new, 2.6);
    check(&double_pendulum_in_angles(), ImplicitMidpoint::new, 2.1);
    check(&damped_pendulum(), ImplicitMidpoint::new, 2.1);
    check(&double_pendulum(), GeneralizedAlpha::new, 2.6);
    check(&charged_spherical_pendulum(), GeneralizedAlpha::new, 3.1);
    check(&relativistic_bead(), GeneralizedAlpha::new, 2.6);
    check(&double_pendulum_in_angles(), GeneralizedAlpha::new, 2.1);
    check(&damped_pendulum(), GeneralizedAlpha::new, 2.1);
}
