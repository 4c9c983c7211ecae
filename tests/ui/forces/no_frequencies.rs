//! A scheme that asks for frequencies of a scene that gives none.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), lagrangian = 0.5 * der(x).powi(2) - 0.5 * x.powi(2))]
struct Oscillator;

fn main() {
    let _ = Simulation::new(Oscillator, Evi::simpson(0.1).scene_frequencies());
}
