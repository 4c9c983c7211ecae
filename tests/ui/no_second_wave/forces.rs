//! Mistakes in forces, frequencies and observed quantities: code that uses them has no errors of its own.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * (der(x).powi(2) + der(y).powi(2)),
    potential = 0.0,
    input(u, w),
    force(x: u + unknown),
    force(y: w),
    frequency(x: y),
    observe(height: x^2),
    observe(power: u * der(x)),
)]
struct Mistaken;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let simulation = Simulation::new(Mistaken, Evi::simpson(0.1).scene_frequencies());
    let mut run = simulation.start([0.0; 2], [1.0; 2])?;
    run.set_inputs([1.0, 2.0]);
    let trajectory = run.integrate(1.0)?;
    let [height, power]: [f64; 2] = run.observe();
    println!("{height} {power} {:?} {:?}", trajectory.series("power").map(|power| power.len()), Mistaken::INPUTS);
    Ok(())
}
