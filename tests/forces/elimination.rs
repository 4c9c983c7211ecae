//! The elimination of a step holds the couplings of forces.

use evi_core::prelude::*;

/// Two cars with a damper between them, and a third that follows one of them by a motor: forces couple coordinates
/// that `L` does not, and only in one direction.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(x, y, z),
    kinetic = 0.5 * m1 * der(x).powi(2) + 0.5 * m2 * der(y).powi(2) + 0.5 * m3 * der(z).powi(2),
    potential = 0.0,
    dissipation = 0.5 * c * (der(x) - der(y)).powi(2),
    force(z: k * (x - z) - c * der(z)),
)]
struct Cars {
    m1: f64,
    m2: f64,
    m3: f64,
    c: f64,
    k: f64,
}

/// The scene's own elimination has the forces' couplings: an elimination without those beside the diagonal would not
/// converge at this damper, for which every step is long.
#[test]
fn holds_the_couplings_of_forces() {
    let cars = Cars { m1: 1.0, m2: 2.0, m3: 0.5, c: 1e4, k: 3e4 };
    let mut run =
        Simulation::new(cars, Evi::midpoint(0.1)).start([0.0, 1.0, 0.3], [3.0, 0.0, -1.0]).expect("a start");
    let mut largest = 0.0_f64;
    for _ in 0..200 {
        run.advance().expect("a step");
        let state = run.state();
        // The centre of the two cars moves uniformly: 2.6e-15 measured.
        let centre = (state.q()[0] + 2.0 * state.q()[1] - 2.0 - 3.0 * state.t()).abs();
        largest = largest.max(centre / (1.0 + state.t()));
        assert!(centre <= 1e-14 * (1.0 + state.t()), "{centre:e} at {}", state.t());
    }
    println!("{largest:e}");
}
