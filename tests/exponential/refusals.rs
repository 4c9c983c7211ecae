//! Every refusal of a matrix frequency, with its numbers.

use core::f64::consts::PI;

use evi_core::prelude::*;
use evi_core::scheme::LinearisationError;
use evi_examples::{DoublePendulum, HarmonicOscillator};
use evi_tests::scenes::{ChargedParticle, DoublePendulumInAngles, KapitzaPendulum};

#[track_caller]
fn error<S: MechanicalSystem, F: Scheme<S>>(system: S, scheme: F) -> SchemeError {
    match scheme.prepare(evi_core::mechanics::Mechanics::new(&system)) {
        Ok(_) => panic!("prepared"),
        Err(error) => error,
    }
}

const UNIT: DoublePendulum = DoublePendulum::UNIT;

#[test]
fn resonant_modes() {
    let oscillator = HarmonicOscillator { m: 1.0, k: 100.0 };
    for (phase, sign) in [(PI, 1.0), (2.0 * PI, -1.0), (5.0 * PI, 1.0)] {
        let refusal = error(oscillator, Evi::trapezoid(sign * phase / 10.0).stiffness([[100.0]]));
        let SchemeError::ResonantMode { mode: 0, frequency, phase: told, sine } = refusal else {
            panic!("{refusal}")
        };
        assert!((frequency - 10.0).abs() < 1e-14 && (told - phase).abs() < 1e-13 && sine.abs() < 1e-13);
        assert!(refusal.to_string().contains("resonant mode 0 of frequency 10"), "{refusal}");
        // Refused within a thousandth, taken beyond.
        let near = |offset: f64| Evi::midpoint((phase + offset) / 10.0).stiffness([[100.0]]);
        assert!(matches!(error(oscillator, near(0.9e-3)), SchemeError::ResonantMode { .. }));
        let beside = Simulation::new(oscillator, near(-1.1e-3)).start([1.0], [0.0]);
        assert!(beside.is_ok());
    }
    // The second of two modes.
    let stiff = [[3.0, 0.0, 0.0, 0.0], [0.0, 3.0, 0.0, 0.0], [0.0, 0.0, 5.0, 0.0], [0.0, 0.0, 0.0, 8.0]];
    let refusal = error(UNIT, Evi::trapezoid(PI / 8.0_f64.sqrt()).stiffness(stiff));
    assert!(matches!(refusal, SchemeError::ResonantMode { mode: 3, .. }), "{refusal}");
}

#[test]
fn modes_beyond_all_numbers() {
    let refusal = error(HarmonicOscillator { m: 1.0, k: 1.0 }, Evi::trapezoid(1.0).stiffness([[-1e6]]));
    assert!(matches!(refusal, SchemeError::ModeOutOfRange { mode: 0, h: 1.0, .. }), "{refusal}");
    assert!(refusal.to_string().contains("grows beyond all numbers"));
}

#[test]
fn matrices_and_references_that_are_none() {
    let mut stiffness = [[0.0; 4]; 4];
    stiffness[2][1] = 1.0;
    let refusal = error(UNIT, Evi::trapezoid(0.1).stiffness(stiffness));
    assert_eq!(refusal, SchemeError::Stiffness { row: 2, col: 1, value: 1.0, mirrored: 0.0 });
    stiffness[1][2] = f64::NAN;
    stiffness[2][1] = f64::NAN;
    assert!(matches!(error(UNIT, Evi::trapezoid(0.1).stiffness(stiffness)), SchemeError::Stiffness { .. }));
    let reference = [0.0, f64::INFINITY, 0.0, 0.0];
    let expected = SchemeError::Reference { coordinate: 1, value: f64::INFINITY };
    assert_eq!(error(UNIT, Evi::trapezoid(0.1).stiffness([[1.0; 4]; 4]).about(reference)), expected);
    assert_eq!(error(UNIT, Evi::simpson(0.1).frequency(1.0).about(reference)), expected);
    assert!(expected.to_string().contains("reference of coordinate 1"));
}

#[test]
fn scenes_without_a_constant_mass() {
    let angles =
        error(DoublePendulumInAngles::UNEQUAL, Evi::trapezoid(0.1).stiffness([[1.0, 0.0], [0.0, 1.0]]));
    assert!(angles.to_string().contains("a constant mass matrix"), "{angles}");
    let charged = error(ChargedParticle { m: 1.0, b: 2.0 }, Evi::midpoint(0.1).linearised_at([0.0; 2]));
    assert!(matches!(charged, SchemeError::UnsupportedStructure { .. }), "{charged}");
    let massless = error(HarmonicOscillator { m: 0.0, k: 1.0 }, Evi::trapezoid(0.1).stiffness([[1.0]]));
    assert!(massless.to_string().contains("positive definite"), "{massless}");
}

#[test]
fn scenes_without_a_linearisation() {
    let kapitza = KapitzaPendulum::STANDARD;
    let time = error(kapitza, Evi::trapezoid(0.01).linearised_at(kapitza.near_inverted().q));
    assert!(
        matches!(time, SchemeError::Linearisation(LinearisationError::UnsupportedStructure { .. })),
        "{time}"
    );
    let crossed = error(UNIT, Evi::trapezoid(0.01).linearised_at([f64::NAN; 4]));
    assert!(matches!(crossed, SchemeError::Linearisation(_)), "{crossed}");
}

#[test]
fn step_sizes_that_are_none() {
    assert_eq!(
        error(UNIT, Evi::trapezoid(0.0).linearised_at([0.0, -1.0, 0.0, -2.0])),
        SchemeError::StepSize { h: 0.0 }
    );
}

#[test]
fn fitted_weights_on_nodes_that_do_not_mirror_each_other() {
    let rule = Quadrature::interpolatory([0.0, 0.3, 1.0]).expect("a rule");
    let refusal = error(UNIT, Evi::new(rule, 0.1).frequency(1.0).fitted());
    assert!(refusal.to_string().contains("three nodes that mirror each other"), "{refusal}");
    // Weights exist up to u = 2.03, where the nodes no longer see the inertia.
    let blind = error(UNIT, Evi::simpson(0.1).frequency(20.2876).fitted());
    assert!(matches!(blind, SchemeError::VanishingInertia { .. }), "{blind}");
}
