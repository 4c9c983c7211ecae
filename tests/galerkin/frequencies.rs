//! Mixed curves: small frequencies, and those that define no step.

use super::*;

/// The distance to the polynomial result is `c u²`, from `u = 0.01` down to where round-off hides it: a table with 0/0 in it
/// would show as noise.
#[track_caller]
fn check_continuity<const K: usize>(frequency: fn(f64) -> Frequency) {
    const H: f64 = 0.1;
    let (system, start) = swing();
    let end = |omega: f64| {
        let scheme = Galerkin::<K>::new(H).frequency(frequency(omega));
        let mut run = Simulation::new(system, scheme).start(start.q, start.v).expect("a start");
        let state = run.advance_to(1.0).expect("every step");
        [*state.q(), *state.v()].concat()
    };
    let mut run = Simulation::new(system, Galerkin::<K>::new(H)).start(start.q, start.v).expect("a start");
    let state = run.advance_to(1.0).expect("every step");
    let limit = [*state.q(), *state.v()].concat();
    let constant = distance(&end(1e-2 / H), &limit) / 1e-4;
    println!("K = {K}: {constant:e} u²");
    assert!(constant > 1e-7, "vacuous: the frequency has no effect");
    for exponent in 2..=12 {
        let u = 10.0_f64.powi(-exponent);
        let deviation = (distance(&end(u / H), &limit) - constant * u * u).abs();
        // The term of order u⁴, and the round-off of two runs.
        let allowed = 0.01 * constant * u * u + 3e-14;
        assert!(deviation <= allowed, "at u = {u:e} off by {deviation:e}");
    }
}

#[test]
fn small_frequencies_tend_to_polynomials_without_noise() {
    check_continuity::<1>(Frequency::Trigonometric);
    check_continuity::<2>(Frequency::Trigonometric);
    check_continuity::<3>(Frequency::Trigonometric);
    check_continuity::<3>(Frequency::Hyperbolic);
}

fn refusal<const K: usize>(scheme: Galerkin<K, Frequency>) -> SchemeError {
    let (system, start) = swing();
    match Simulation::new(system, scheme).start(start.q, start.v) {
        Err(StartError::Scheme(error)) => error,
        Err(error) => panic!("{error}"),
        Ok(_) => panic!("accepted"),
    }
}

#[test]
fn that_define_no_step_are_refused() {
    const PI: f64 = core::f64::consts::PI;
    let scheme = |u: f64| Galerkin::<1>::new(0.1).frequency(u / 0.1);
    for (u, name) in
        [(PI, "determinant"), (0.5 * PI, "inertia"), (6.0, "limit"), (-1.0, "sign"), (f64::NAN, "NaN")]
    {
        let error = refusal(scheme(u));
        println!("{error}");
        let expected = match name {
            "determinant" => {
                matches!(error, SchemeError::IndeterminateCurve { coordinate: 0, determinant, .. } if determinant.abs() < 1e-15)
            }
            "inertia" => {
                matches!(error, SchemeError::VanishingInertia { kinetic_coefficient, .. } if kinetic_coefficient.abs() < 1e-15)
            }
            "limit" => matches!(error, SchemeError::UnresolvedFrequency { .. }),
            _ => matches!(error, SchemeError::Frequency { .. }),
        };
        assert!(expected, "{name}: {error}");
    }
    // With inner points the same frequencies define steps.
    let (system, start) = swing();
    for u in [0.5 * PI, PI] {
        let scheme = Galerkin::<3>::new(0.1).frequency(u / 0.1);
        assert!(Simulation::new(system, scheme).start(start.q, start.v).is_ok());
    }
}
