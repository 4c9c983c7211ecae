//! Frequencies that a scene gives itself.

use evi_core::prelude::*;

use evi_core::system::HasFrequencies;

/// A trolley on a spring, which carries a pendulum with two frequencies that share an expression; the last
/// coordinate has none.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(x, y, z, s),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2) + der(z).powi(2) + der(s).powi(2)),
    potential = 0.5 * k * x.powi(2) + m * g / l * (y.powi(2) + z.powi(2) + 0.1 * x * y * z),
    let swing = (g / l).sqrt(),
    frequency(y, z: swing),
    frequency(x: (k / m).sqrt()),
)]
struct Trolley {
    m: f64,
    k: f64,
    g: f64,
    l: f64,
}

const TROLLEY: Trolley = Trolley { m: 2.0, k: 5.0, g: 9.81, l: 0.7 };

#[test]
fn are_those_that_the_scene_names() {
    let (along, swing) = ((5.0_f64 / 2.0).sqrt(), (9.81_f64 / 0.7).sqrt());
    let constants = Trolley::constants(&TROLLEY.parameters());
    assert_eq!(Trolley::frequencies(&constants), [along, swing, swing, 0.0]);
    let (q, v) = ([0.3, -0.2, 0.4, 0.0], [0.1, 0.5, -0.3, 1.0]);
    let of_scene = Evi::simpson(0.05).scene_frequencies();
    let by_hand = Evi::simpson(0.05).frequencies([along, swing, swing, 0.0].map(Frequency::from));
    let mut of_scene = Simulation::new(TROLLEY, of_scene).start(q, v).expect("a start");
    let mut by_hand = Simulation::new(TROLLEY, by_hand).start(q, v).expect("a start");
    for _ in 0..100 {
        assert_eq!(of_scene.advance(), by_hand.advance());
    }
    // On a straight curve the free coordinate keeps its momentum.
    assert!((of_scene.state().v()[3] - 1.0).abs() < 1e-14);
}

#[test]
fn that_are_no_frequencies_are_refused_with_their_coordinate() {
    let simulation = Simulation::new(Trolley { l: -0.7, ..TROLLEY }, Evi::midpoint(0.05).scene_frequencies());
    let error = simulation.start([0.1; 4], [0.0; 4]).map(|_| ()).expect_err("the root of a negative number");
    assert!(
        matches!(error, StartError::Scheme(SchemeError::Frequency { coordinate: 1, value }) if value.is_nan()),
        "{error}"
    );
}
