//! Units do not matter.

use evi_core::prelude::*;
use evi_examples::{DoublePendulum, FermiPastaUlam};
use evi_tests::largest_difference;

use super::fixtures::Molecule;

/// The end of a run of 100 steps, with lengths, masses and times in other units, brought back to the first.
fn pendulum(length: f64, mass: f64, time: f64) -> Vec<f64> {
    let DoublePendulum { m1, m2, l1, l2, g } = DoublePendulum { m1: 1.3, m2: 0.7, l1: 0.9, l2: 1.1, g: 9.81 };
    let system = DoublePendulum {
        m1: m1 * mass,
        m2: m2 * mass,
        l1: l1 * length,
        l2: l2 * length,
        g: g * length / (time * time),
    };
    let start = system.at_angles(0.5, -0.2);
    let hanging = [0.0, -system.l1, 0.0, -system.l1 - system.l2];
    let scheme = Evi::trapezoid(0.02 * time).linearised_at(hanging);
    let mut run = Simulation::new(system, scheme).start(start.q, start.v).expect("a start");
    for _ in 0..100 {
        run.advance().expect("a step");
    }
    let state = run.state();
    let (q, v) = (state.q().map(|q| q / length), state.v().map(|v| v * time / length));
    [q, v].concat()
}

#[test]
fn powers_of_four_change_no_bit() {
    let one = pendulum(1.0, 1.0, 1.0);
    assert_eq!(one, pendulum(16.0, 1.0, 1.0));
    assert_eq!(one, pendulum(1.0, 4.0_f64.powi(10), 1.0));
    assert_eq!(one, pendulum(1.0, 1.0, 0.25));
    assert_eq!(one, pendulum(4.0_f64.powi(-8), 4.0_f64.powi(6), 4.0_f64.powi(3)));
}

#[test]
fn other_units_change_round_off_alone() {
    let one = pendulum(1.0, 1.0, 1.0);
    for (length, mass, time) in [
        (1e-6, 1.0, 1.0),
        (1.0, 1e6, 1.0),
        (1.0, 1.0, 1e-3),
        (300.0, 1e-5, 7.0),
        (1.0, 1e300, 1.0),
        (1.0, 1e-300, 1.0),
    ] {
        let difference = largest_difference(&pendulum(length, mass, time), &one);
        println!("{difference:.1e}");
        // Round-off of 100 steps.
        assert!(difference <= 1e-12, "{difference:e} in units {length}, {mass}, {time}");
    }
}

/// A molecule that has been moved, reference and all, moves alike.
#[test]
fn a_translation_of_scene_and_reference_changes_round_off_alone() {
    let system = Molecule::STANDARD;
    let end = |shift: f64| {
        let start = system.moving();
        let scheme = Evi::midpoint(0.02).linearised_at(Molecule::REST.map(|q| q + shift));
        let mut run =
            Simulation::new(system, scheme).start(start.q.map(|q| q + shift), start.v).expect("a start");
        run.advance_to(2.0).expect("every step").q().map(|q| q - shift)
    };
    let difference = largest_difference(&end(0.0), &end(50.0));
    println!("{difference:.1e}");
    // Round-off of positions of size 50.
    assert!(difference <= 1e-11, "{difference:e}");
}

/// Modes that are coupled by nothing stay so to the last bit.
#[test]
fn a_spring_that_nothing_excites_stays_at_rest() {
    let chain = FermiPastaUlam { omega: 50.0 };
    let scheme = Evi::trapezoid(0.03).stiffness(chain.stiff_springs());
    let mut run = Simulation::new(chain, scheme).start([0.0; 6], [0.0; 6]).expect("a start");
    for _ in 0..100 {
        run.advance().expect("a step");
    }
    assert_eq!(*run.state().q(), [0.0; 6]);
}
