//! The Fermi-Pasta-Ulam-Tsingou chain: stiff springs at frequency 50, soft ones between them.
//!
//! The sum of the energies of the stiff springs is an adiabatic invariant. An impulse method follows it at step sizes at which
//! the method of Störmer and Verlet is unstable, except near the resonances `h ω = kπ` (Hairer, Lubich, Wanner, Geometric Numerical
//! Integration, ch. XIII).

use core::f64::consts::PI;

use evi_core::baseline::Rattle;
use evi_core::integrator::{MatrixEvi, Stiffness};
use evi_core::prelude::*;
use evi_examples::FermiPastaUlam;
use evi_tests::distance;
use evi_tests::references::{self, Certified};

const CHAIN: FermiPastaUlam = FermiPastaUlam::STANDARD;

/// The impulse method, with `h ω = phase`.
fn impulse(phase: f64) -> MatrixEvi<2, Stiffness<6>> {
    Evi::trapezoid(phase / CHAIN.omega).stiffness(CHAIN.stiff_springs())
}

/// Largest deviations of the oscillatory energy and of the energy from their start over `t = 0..200`.
#[track_caller]
fn deviations<F: Scheme<FermiPastaUlam>>(scheme: F) -> (f64, f64) {
    let start = CHAIN.one_spring_excited();
    let mut run = Simulation::new(CHAIN, scheme).start(start.q, start.v).expect("a start");
    let oscillatory =
        |state: &State<FermiPastaUlam>| CHAIN.oscillatory_energies(state.q(), state.v()).iter().sum::<f64>();
    let (before, energy_before) = (oscillatory(run.state()), run.energy());
    let (mut largest, mut energy) = (0.0_f64, 0.0_f64);
    while run.state().t() < 200.0 {
        let Ok(state) = run.advance() else { return (f64::INFINITY, f64::INFINITY) };
        largest = largest.max((oscillatory(state) - before).abs());
        energy = energy.max((run.energy() - energy_before).abs());
    }
    (largest, energy)
}

#[test]
fn the_oscillatory_energy_stays_at_large_steps() {
    for phase in [0.5, 1.1, 2.2, 2.8, 4.0] {
        let (oscillatory, energy) = deviations(impulse(phase));
        println!("h ω = {phase}: oscillatory energy {oscillatory:.4}, energy {energy:.4}");
        // The invariant itself oscillates by O(1/ω): 0.066 for the motion at hand.
        assert!(oscillatory <= 4.0 / CHAIN.omega, "{oscillatory} at h ω = {phase}");
        // Of 2; 0.13 measured at the longest step.
        assert!(energy <= 0.15, "{energy} at h ω = {phase}");
    }
}

#[test]
fn without_a_frequency_the_limit_is_2() {
    let verlet = |phase: f64| deviations(Rattle::new(phase / CHAIN.omega)).0;
    assert!(verlet(1.0) < 1.0 && verlet(2.05) == f64::INFINITY, "{}, {}", verlet(1.0), verlet(2.05));
}

#[test]
fn resonances_show_are_reported_and_refused() {
    let (near, beside) = (deviations(impulse(3.25)).0, deviations(impulse(2.8)).0);
    println!("h ω = 3.25: {near}, 2.8: {beside}");
    assert!(near > 1.0 && beside < 0.04);
    let start = CHAIN.one_spring_excited();
    let run = Simulation::new(CHAIN, impulse(3.15)).start(start.q, start.v).expect("a start");
    let conditions = run.map().modes().iter().map(|mode| mode.condition).fold(0.0, f64::max);
    println!("condition at h ω = 3.15: {conditions}");
    assert!(conditions > 100.0);
    for multiple in [1.0, 2.0, 3.0] {
        let refused =
            Simulation::new(CHAIN, impulse(multiple * PI)).start(start.q, start.v).err().expect("refused");
        let StartError::Scheme(SchemeError::ResonantMode { mode, frequency, phase, .. }) = refused else {
            panic!("{refused}")
        };
        assert!(mode >= 3 && (frequency - 50.0).abs() < 1e-12 && (phase - multiple * PI).abs() < 1e-12);
    }
}

#[test]
fn averaged_positions_damp_the_resonance() {
    let plain = deviations(impulse(3.25)).0;
    for mollifier in [Mollifier::ShortAverage, Mollifier::LongAverage, Mollifier::LinearAverage] {
        let damped = deviations(impulse(3.25).mollified(mollifier)).0;
        println!("{mollifier:?}: {damped:.4} for {plain:.4}");
        assert!(damped < 0.2 * plain, "{damped}");
    }
    // The mean over two steps vanishes there: nothing reaches the stiff springs.
    assert!(deviations(impulse(3.15).mollified(Mollifier::LongAverage)).0 < 1e-3);
}

#[test]
fn a_hundred_units_of_time_are_followed() {
    let [_, ten, hundred] = references::FERMI_PASTA_ULAM;
    let start = CHAIN.one_spring_excited();
    for (Certified { t, q, v, .. }, phase, allowed) in [(ten, 0.1, 5e-5), (hundred, 0.02, 0.02)] {
        let mut run = Simulation::new(CHAIN, impulse(phase)).start(start.q, start.v).expect("a start");
        let state = run.advance_to(t).expect("every step");
        let error = distance(state.q(), q).hypot(distance(state.v(), v));
        println!("t = {t}: {error:.1e}");
        assert!(error <= allowed, "{error:e}");
    }
}
