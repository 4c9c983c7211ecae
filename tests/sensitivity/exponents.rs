//! Lyapunov exponents.

use evi_core::prelude::*;
use evi_core::sensitivity::LyapunovRun;
use evi_examples::{DoublePendulum, HenonHeiles};

const EVERY: u64 = 10;

/// The exponents of a Hamiltonian motion come in pairs of opposite sign, two of them zero, and their sum, by the volume of Liouville, is
/// round-off: `ε ‖DΨ‖² / h` per unit of time.
#[test]
fn the_spectrum_of_the_double_pendulum_adds_up_to_zero() {
    const H: f64 = 0.01;
    const TIME: f64 = 100.0;
    let system = DoublePendulum::UNIT;
    let start = system.at_angles(2.0, 2.5);
    let simulation = Simulation::new(system, Evi::midpoint(H));
    let mut run = LyapunovRun::new(&simulation, start.q, start.v, 4, EVERY).expect("a start");
    run.advance_to(TIME).expect("steps");
    let exponents = run.exponents();
    let rate = run.liouville_rate().expect("an even number of vectors");
    println!("{exponents:?}, sum {rate:e}");
    assert!(exponents[0] > 1.0, "chaotic: {exponents:?}");
    assert!(exponents[1].abs() < 0.2 && exponents[2].abs() < 0.2, "{exponents:?}");
    assert!((exponents[0] + exponents[3]).abs() < 0.1 && (exponents[1] + exponents[2]).abs() < 0.1);
    assert!(rate.abs() <= 2.0 * f64::EPSILON / H, "{rate:e}");
}

/// On a regular motion deviations grow linearly at most: what is called an exponent falls as `ln t / t`. At the energy of escape it does not.
#[test]
fn a_regular_motion_has_none() {
    let largest = |q: [f64; 2], v: [f64; 2]| {
        let simulation = Simulation::new(HenonHeiles::STANDARD, Evi::trapezoid(0.1));
        let mut run = LyapunovRun::new(&simulation, q, v, 1, EVERY).expect("a start");
        run.advance_to(2_000.0).expect("steps");
        assert_eq!(run.liouville_rate(), None, "one vector spans no volume of phase space");
        run.exponents()[0]
    };
    let start = HenonHeiles::STANDARD.regular();
    let (regular, chaotic) = (largest(start.q, start.v), largest([0.0, -0.1], [0.56, 0.1]));
    println!("{regular}, {chaotic}");
    assert!(regular.abs() < 4e-3 && chaotic > 0.1, "{regular}, {chaotic}");
}
