//! Solvers of other projects solve the same problems: certified digits, each of their steps shown, errors with their numbers.

use evi_benches::external::{
    DiffsolError, DiffsolMethod, Dop853Error, PeerError, Tolerances, diffsol, dop853, heyoka,
};
use evi_core::comparison::Solver;
use evi_core::prelude::*;
use evi_examples::{DoublePendulum, Start};
use evi_tests::largest_difference;
use evi_tests::motions::{
    Motion, charged_particle, damped_pendulum, double_pendulum_in_angles, kapitza_pendulum,
    modulated_pendulum,
};
use evi_tests::references::{Certified, DOUBLE_PENDULUM_MILD};

const PENDULUM: DoublePendulum = DoublePendulum::UNIT;

fn mild(tolerance: f64) -> Box<dyn Solver> {
    let Start { q, v } = PENDULUM.at_angles(0.1, 0.1);
    dop853(&PENDULUM, &q, &v, Tolerances::both(tolerance)).expect("a start")
}

#[test]
fn dop853_reaches_certified_digits() {
    for Certified { t, q, v, .. } in DOUBLE_PENDULUM_MILD {
        let mut solver = mild(1e-13);
        solver.advance_to(t).expect("regular");
        assert_eq!(solver.t(), t);
        let distance = largest_difference(solver.q(), q).max(largest_difference(solver.v(), v));
        println!("t = {t}: {distance:.1e} in {} steps", solver.steps());
        assert!(distance <= 1e-10, "{distance:e}");
    }
}

/// Comes within `bound` of the end of a motion.
#[track_caller]
fn check<S: MechanicalSystem + Clone + 'static>(motion: &Motion<S>, tolerance: f64, bound: f64) {
    use evi_core::array::Array;
    let q = S::PerCoordinate::<f64>::from_fn(|i| motion.q0[i]);
    let v = S::PerCoordinate::<f64>::from_fn(|i| motion.v0[i]);
    let mut solver = dop853(&motion.system, &q, &v, Tolerances::both(tolerance)).expect("a start");
    solver.advance_to(motion.t).expect("regular");
    let distance = largest_difference(solver.q(), &motion.q).max(largest_difference(solver.v(), &motion.v));
    println!("{}: {distance:.1e} in {} steps", core::panic::Location::caller(), solver.steps());
    assert!(distance <= bound, "{distance:e}");
}

#[test]
fn dop853_on_every_kind_of_scene() {
    // Local errors of 1e-13 over 50 to 150 steps: up to 7e-13 measured.
    check(&double_pendulum_in_angles(), 1e-13, 1e-12);
    check(&charged_particle(), 1e-13, 1e-12);
    check(&damped_pendulum(), 1e-13, 1e-12);
    // Something depends on time: the constraint, the potential.
    check(&kapitza_pendulum(), 1e-13, 1e-12);
    check(&modulated_pendulum(), 1e-13, 1e-12);
}

#[test]
fn dop853_shows_each_of_its_steps() {
    let (mut one, mut other) = (mild(1e-9), mild(1e-9));
    let mut seen = Vec::new();
    one.advance_visiting(3.0, &mut |solver| seen.push((solver.t(), solver.steps(), solver.q().to_vec())))
        .expect("regular");
    assert!(
        seen.len() > 10 && seen.windows(2).all(|pair| pair[0].0 < pair[1].0 && pair[0].1 + 1 == pair[1].1)
    );
    assert_eq!(seen.last().map(|last| (last.0, last.1)), Some((3.0, one.steps())));
    other.advance_to(3.0).expect("regular");
    assert_eq!((one.q(), one.v(), one.p()), (other.q(), other.v(), other.p()));
    // Unit masses.
    assert_eq!(one.p(), one.v());
    other.advance_to(3.0).expect("nothing to do");
    assert_eq!(other.steps(), one.steps());
    other.advance_to(0.0).expect("back");
    assert!(largest_difference(other.q(), &PENDULUM.at_angles(0.1, 0.1).q) <= 1e-7);
}

#[test]
fn dop853_says_why_it_stopped() {
    let Start { q, v } = PENDULUM.horizontal();
    let refused = |tolerance| dop853(&PENDULUM, &q, &v, Tolerances::both(tolerance)).err();
    assert_eq!(refused(0.0), Some(Dop853Error::Tolerances { relative: 0.0, absolute: 0.0 }));
    let none = dop853(&PENDULUM, &[f64::NAN; 4], &v, Tolerances::both(1e-9)).err();
    assert_eq!(none, Some(Dop853Error::NotFinite { t: 0.0, target: 0.0 }));
    let mut solver = mild(1e-9);
    let error = solver.advance_to(f64::INFINITY).expect_err("far away");
    assert_eq!(error.to_string(), "cannot go from t = 0.0 to t = inf: a number is not finite");
    // The outer bob has no mass: the inner one falls, the outer is not determined.
    let massless = DoublePendulum { m2: 0.0, ..PENDULUM };
    let mut solver = dop853(&massless, &q, &v, Tolerances::both(1e-9)).expect("a start");
    let error = solver.advance_to(1.0).expect_err("singular");
    println!("{error}");
    assert!(error.to_string().starts_with("no accelerations at t = "));
    assert_eq!((solver.t(), solver.q()), (0.0, &q[..]));
}

#[test]
fn heyoka_reaches_certified_digits_where_it_is_installed() {
    let Start { q, v } = PENDULUM.at_angles(0.1, 0.1);
    let end = DOUBLE_PENDULUM_MILD[1];
    match heyoka("double_pendulum", &PENDULUM, (&q, &v), end.t, &[1e-8, 1e-15], 3) {
        Err(error @ PeerError::NotInstalled { .. }) => println!("{error}"),
        Err(error) => panic!("{error}"),
        Ok(rows) => {
            let distances: Vec<f64> = rows.iter().map(|row| largest_difference(&row.q, end.q)).collect();
            println!("{distances:?}, {:?} steps", rows.iter().map(|row| row.steps).collect::<Vec<_>>());
            assert!(rows.len() == 2 && distances[0] <= 1e-6 && distances[1] <= 1e-11);
            let unknown = heyoka("perpetuum_mobile", &PENDULUM, (&q, &v), 1.0, &[1e-8], 1);
            assert!(matches!(unknown, Err(PeerError::UnknownScene { .. })), "{unknown:?}");
        }
    }
}

#[test]
fn diffsol_reaches_digits_where_it_is_built() {
    let Start { q, v } = PENDULUM.at_angles(0.1, 0.1);
    let Certified { t, q: end, .. } = DOUBLE_PENDULUM_MILD[0];
    // Global errors of methods of low order are many times their tolerances; measured, rounded up.
    for (method, tolerance, bound) in [
        (DiffsolMethod::Bdf, 1e-10, 1e-6),
        (DiffsolMethod::TrBdf2, 1e-8, 1e-5),
        (DiffsolMethod::Esdirk34, 1e-8, 1e-5),
    ] {
        let mut solver = match diffsol(&PENDULUM, method, &q, &v, Tolerances::both(tolerance)) {
            Ok(solver) => solver,
            Err(error @ DiffsolError::NotBuilt) if !cfg!(feature = "diffsol") => {
                println!("{error}");
                return;
            }
            Err(error) => panic!("{error}"),
        };
        let mut seen = 0;
        solver.advance_visiting(0.5 * t, &mut |_| seen += 1).expect("regular");
        assert_eq!(seen, solver.steps());
        solver.advance_to(t).expect("regular");
        let distance = largest_difference(solver.q(), end);
        println!("{method:?}: {distance:.1e} in {} steps", solver.steps());
        assert!(solver.t() == t && distance <= bound, "{distance:e}");
    }
}
