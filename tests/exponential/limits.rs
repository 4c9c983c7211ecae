//! Frequencies that vanish, modes that grow, coordinates that nothing holds.

use evi_core::baseline::Rattle;
use evi_core::integrator::{OneStep, Statistics};
use evi_core::prelude::*;
use evi_core::scheme::growth_rate;
use evi_examples::{DoublePendulum, FermiPastaUlam, GRAVITY, HarmonicOscillator, Start};
use evi_tests::{largest_difference, observed_order};

use super::fixtures::{Bowl, ThreeRods};

const UNIT: DoublePendulum = DoublePendulum::UNIT;

/// The state after one unit of time, positions then velocities.
fn end<F: Scheme<DoublePendulum>>(scheme: F) -> Vec<f64> {
    let start = UNIT.at_angles(0.7, -0.4);
    let mut run = Simulation::new(UNIT, scheme).start(start.q, [0.0; 4]).expect("a start");
    let state = run.advance_to(1.0).expect("every step");
    [state.q().as_slice(), state.v().as_slice()].concat()
}

/// The difference to straight curves falls like `ω²`, down to round-off and not below it.
#[track_caller]
fn check_continuity<F: Scheme<DoublePendulum>>(straight: &[f64], scheme: impl Fn(f64) -> F) {
    let omegas = [1.0, 0.3, 0.1, 0.03, 0.01, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-12];
    let differences = omegas.map(|omega| largest_difference(&end(scheme(omega)), straight));
    println!("{}: {differences:?}", core::panic::Location::caller());
    // At ω = 1 the next term shows.
    let slope = observed_order(&omegas[1..5], &differences[1..5]);
    assert!((slope - 2.0).abs() < 0.02, "{slope}");
    // Round-off of a hundred steps, magnified by the motion: 3e-14 measured.
    assert!(differences[7..].iter().all(|difference| *difference <= 1e-13), "noise");
}

#[test]
fn frequencies_go_to_zero_without_noise() {
    let h = 0.01;
    let straight = end(Evi::simpson(h));
    check_continuity(&straight, |omega| Evi::simpson(h).frequency(omega));
    check_continuity(&straight, |omega| Evi::simpson(h).frequency(Frequency::Hyperbolic(omega)));
    check_continuity(&straight, |omega| Evi::simpson(h).frequency(omega).fitted());
    check_continuity(&straight, |omega| Evi::simpson(h).frequency(omega).about([0.0, -1.0, 0.0, -2.0]));
}

#[test]
fn a_stiffness_goes_to_zero_without_noise_and_through_it() {
    let h = 0.01;
    let straight = end(Evi::trapezoid(h));
    let stiffness =
        |k: f64| core::array::from_fn(|row| core::array::from_fn(|col| if row == col { k } else { 0.2 * k }));
    check_continuity(&straight, |omega| Evi::trapezoid(h).stiffness(stiffness(omega * omega)));
    check_continuity(&straight, |omega| Evi::midpoint(h).stiffness(stiffness(omega * omega)));
    check_continuity(&straight, |omega| Evi::trapezoid(h).stiffness(stiffness(-omega * omega)));
    // Without any stiffness, the trapezoidal member itself.
    assert!(largest_difference(&end(Evi::trapezoid(h).stiffness([[0.0; 4]; 4])), &straight) <= 1e-13);
}

/// The growth of a mode, measured as the largest exponent of a step's matrix.
fn measured_growth<const K: usize>(rule: Quadrature<K>, frequency: Frequency, h: f64, k: f64) -> f64 {
    let column = |q: f64, v: f64| {
        let scheme = Evi::new(rule, h).frequency(frequency);
        let mut run =
            Simulation::new(HarmonicOscillator { m: 1.0, k }, scheme).start([q], [v]).expect("a start");
        let state = run.advance().expect("a step");
        (state.q()[0], state.p()[0])
    };
    let half_trace = 0.5 * (column(1.0, 0.0).0 + column(0.0, 1.0).1);
    if half_trace.abs() > 1.0 { half_trace.abs().acosh() / h.abs() } else { 0.0 }
}

#[test]
fn the_growth_of_modes_is_foretold() {
    let mut grew = 0;
    let mut check = |measured: f64, foretold: f64, what: String| {
        grew += usize::from(measured > 0.0);
        // The trace near 1 has half the digits of its distance from 1.
        assert!((measured - foretold).abs() <= 1e-6 * (1.0 + foretold), "{what}: {measured} for {foretold}");
    };
    for h in [0.1, -0.3] {
        for omega in [0.5, 2.0, 3.1] {
            for frequency in [Frequency::Trigonometric(omega), Frequency::Hyperbolic(omega)] {
                for k in [0.0, 0.3, 4.0, 60.0, 800.0, -1.0] {
                    let what = format!("h {h}, {frequency:?}, k {k}");
                    let rule = Quadrature::<3>::uniform();
                    check(
                        measured_growth(rule, frequency, h, k),
                        growth_rate(frequency, &rule, h, k),
                        what.clone(),
                    );
                    let rule = Quadrature::<2>::gauss();
                    check(
                        measured_growth(rule, frequency, h, k),
                        growth_rate(frequency, &rule, h, k),
                        what.clone(),
                    );
                    let rule = Quadrature::midpoint();
                    check(measured_growth(rule, frequency, h, k), growth_rate(frequency, &rule, h, k), what);
                }
            }
        }
    }
    assert!(grew > 30, "vacuous: {grew}");
}

/// A cart without a spring under a pendulum: the position of the cart stands nowhere in the equations.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(x, theta),
    kinetic = 0.5 * (m1 + m2) * der(x).powi(2) + 0.5 * m2 * der(theta).powi(2) + m2 * der(x) * der(theta) * theta.cos(),
    potential = -m2 * g * theta.cos(),
)]
struct Cart {
    m1: f64,
    m2: f64,
    g: f64,
}

const CART: Cart = Cart { m1: 2.0, m2: 0.7, g: 9.81 };

fn refused<F: Scheme<Cart>>(scheme: F) -> Option<SchemeError> {
    match Simulation::new(CART, scheme).start([0.0, 0.4], [0.3, 0.0]) {
        Ok(_) => None,
        Err(StartError::Scheme(error)) => Some(error),
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn a_free_coordinate_with_a_frequency_is_refused_where_it_would_grow() {
    let error = refused(Evi::simpson(0.01).frequency(3.0)).expect("refused");
    let SchemeError::SoftCoordinate { coordinate, frequency, growth_rate } = error else { panic!("{error}") };
    assert_eq!((coordinate, frequency), ("x", 3.0));
    assert!((growth_rate / (9.0 * 0.01 / 12.0_f64.sqrt()) - 1.0).abs() < 1e-3, "{growth_rate}");
    let text = error.to_string();
    assert!(
        ["`x`", "Frequency::ZERO", "midpoint", "allow_soft_modes"].iter().all(|part| text.contains(part)),
        "{text}"
    );

    let hyperbolic = Evi::trapezoid(0.01).frequency(Frequency::Hyperbolic(2.0));
    assert!(matches!(refused(hyperbolic), Some(SchemeError::SoftCoordinate { .. })));
    let left = Evi::new(Quadrature::interpolatory([0.0]).expect("a rule"), 0.01).frequency(2.0);
    assert!(matches!(refused(left), Some(SchemeError::SoftCoordinate { .. })));
    let fitted = Evi::simpson(0.01).frequency(3.0).fitted();
    assert!(matches!(refused(fitted), Some(SchemeError::SoftCoordinate { .. })));
    assert!(matches!(refused(fitted.about([0.0; 2])), Some(SchemeError::SoftCoordinate { .. })));
}

#[test]
fn what_does_not_grow_is_taken() {
    assert_eq!(refused(Evi::midpoint(0.01).frequency(3.0)), None);
    assert_eq!(refused(Evi::simpson(0.01).frequencies([Frequency::ZERO, 3.0.into()])), None);
    assert_eq!(refused(Evi::simpson(0.01).frequency(0.0)), None);
    assert_eq!(refused(Evi::simpson(0.01).frequency(3.0).allow_soft_modes()), None);
    // Constraints hold every coordinate of the double pendulum.
    let start = UNIT.at_angles(0.1, 0.1);
    assert!(Simulation::new(UNIT, Evi::simpson(0.01).frequency(3.0)).start(start.q, start.v).is_ok());
}

#[test]
fn what_is_allowed_grows_as_foretold() {
    #[derive(MechanicalSystem, Clone, Copy)]
    #[evi(coordinates(x), kinetic = 0.5 * m * der(x).powi(2), potential = 0.0)]
    struct Particle {
        m: f64,
    }
    let scheme = Evi::simpson(0.1).frequency(3.0);
    let particle = Particle { m: 1.7 };
    let error = Simulation::new(particle, scheme).start([1.0], [0.0]).err().expect("refused");
    let StartError::Scheme(SchemeError::SoftCoordinate { growth_rate, .. }) = error else {
        panic!("{error}")
    };
    let mut run = Simulation::new(particle, scheme.allow_soft_modes()).start([1.0], [0.0]).expect("a start");
    let grown = run.advance_to(10.0).expect("every step").q()[0];
    println!("{grown} for {}", (10.0 * growth_rate).cosh());
    assert!(grown > 5.0 && (grown / (10.0 * growth_rate).cosh() - 1.0).abs() < 1e-12, "{grown}");
}

/// Newton's corrections over a few steps.
fn corrections<S, F, const N: usize>(system: S, scheme: F, start: Start<N>) -> u64
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S>,
{
    let run = Simulation::new(system, scheme).start(start.q, start.v).expect("a start");
    let mut run = run.with_tally(Statistics::default());
    run.advance_to(0.5).expect("every step");
    run.tally().corrections
}

/// On the ends of a step the equations are explicit but for the constraints.
#[test]
fn the_impulse_member_solves_for_multipliers_alone() {
    let chain = FermiPastaUlam::STANDARD;
    let (start, springs) = (chain.one_spring_excited(), chain.stiff_springs());
    assert_eq!(corrections(chain, Evi::trapezoid(0.02).stiffness(springs), start), 0);
    assert!(corrections(chain, Evi::midpoint(0.02).stiffness(springs), start) > 25);
    let hanging = [0.0, -1.0, 0.0, -2.0];
    let pendulum = |scheme| corrections(UNIT, scheme, UNIT.at_angles(0.3, 0.2));
    let steps = pendulum(Evi::trapezoid(0.02).linearised_at(hanging));
    println!("{steps} corrections in 25 steps");
    assert!((50..75).contains(&steps));
}

/// Between constraints in units that differ, the elimination exchanges rows.
#[test]
fn the_units_of_coupled_constraints_change_no_motion() {
    let end = |scale: f64| {
        let rods = ThreeRods { g: GRAVITY, scale };
        let scheme = Evi::trapezoid(0.01).linearised_at(ThreeRods::HANGING);
        let Start { q, v } = rods.deflected();
        let run = Simulation::new(rods, scheme).start(q, v).expect("a start");
        let mut run = run.with_tally(Statistics::default());
        run.advance_to(1.0).expect("every step");
        let corrections = run.tally().corrections;
        println!("scale {scale:e}: {corrections} corrections in 100 steps");
        assert!(corrections <= 210, "{corrections}");
        *run.state().q()
    };
    let difference = largest_difference(&end(1.0), &end(30.0));
    println!("difference {difference:e}");
    // Round-off of 100 steps: 2.9e-15 measured.
    assert!(difference <= 1e-14, "{difference:e}");
}

#[test]
fn a_step_tells_how_near_its_modes_are_to_resonance() {
    let k = 100.0_f64;
    let scheme = |phase: f64| Evi::trapezoid(phase / 10.0).stiffness([[k]]);
    let condition = |phase: f64| {
        let run = Simulation::new(HarmonicOscillator { m: 1.0, k }, scheme(phase))
            .start([1.0], [0.0])
            .expect("a start");
        let mode = run.map().modes()[0];
        assert!((mode.phase - phase).abs() < 1e-14 && (mode.squared_frequency - k).abs() < 1e-12);
        assert_eq!(run.map().h(), phase / 10.0);
        mode.condition
    };
    assert_eq!(condition(1.0), 1.0);
    assert!((condition(3.1) - 1.0 / 3.1_f64.sin()).abs() < 1e-10);
    assert!((condition(6.2) - 1.0 / 6.2_f64.sin().abs()).abs() < 1e-10);
}

/// The round-off of the constraint, `ε l²`, is no part of coordinates that vanish: nothing that a step knows is as large.
#[track_caller]
fn check_rest_at_the_origin<F: Scheme<Bowl>>(step_sizes: &[f64], scheme: impl Fn(f64) -> F) {
    for l in [0.7, 0.37, 1.3, 0.9] {
        let system = Bowl { m: 1.3, l, g: GRAVITY };
        for &h in step_sizes {
            let mut run = Simulation::new(system, scheme(h)).start([0.0; 2], [0.0; 2]).expect("a start");
            for _ in 0..1000 {
                let [x, y] = *run.advance().unwrap_or_else(|error| panic!("l = {l}, h = {h}: {error}")).q();
                // Roundings of the constraint: `ε l² / 2l`.
                assert!(x.abs().max(y.abs()) <= f64::EPSILON, "l = {l}, h = {h}: {x:e}, {y:e}");
            }
        }
    }
}

#[test]
fn a_bead_at_rest_at_the_origin_stays_there() {
    check_rest_at_the_origin(&[1e-1, 1e-2, 1e-3, 1e-4], |h| Evi::trapezoid(h).linearised_at([0.0, 0.0]));
    // Judged against the way of a step, of which the round-off is too large a part in shorter ones.
    check_rest_at_the_origin(&[1e-1, 1e-2], Rattle::new);
}
