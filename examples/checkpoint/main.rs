//! A long run that may be interrupted at any time: it writes a checkpoint every so many steps, and begins from the last one.
//!
//! `cargo run --release --example checkpoint`; interrupt it with Ctrl-C, by a kill or a power cut, and start it again: it ends with the same bits as a
//! run that nothing interrupted.

mod file;

use std::error::Error;
use std::io;
use std::ops::ControlFlow;
use std::path::PathBuf;

use clap::Parser;
use evi_core::prelude::*;
use evi_core::watch::{EnergyDrift, every};
use evi_examples::DoublePendulum;

/// A long run of the double pendulum that goes on where it was interrupted.
#[derive(Parser)]
struct Options {
    /// Number of steps at the end.
    #[arg(long, default_value_t = 10_000_000)]
    steps: u64,
    /// Steps from one checkpoint to the next.
    #[arg(long, default_value_t = 500_000)]
    every: u64,
    /// The file of the checkpoint.
    #[arg(long, default_value = "target/checkpoint.json")]
    file: PathBuf,
}

const H: f64 = 0.01;

fn main() -> Result<(), Box<dyn Error>> {
    let Options { steps, every: interval, file: path } = Options::parse();
    let system = DoublePendulum { m1: 1.0, m2: 0.5, l1: 1.0, l2: 0.8, g: 9.81 };
    let start = system.at_angles(0.1, -0.05);
    let simulation = Simulation::new(system, Evi::midpoint(H).compensated());
    let mut run = match file::read(&path)? {
        Some(checkpoint) => {
            println!("goes on at step {}", checkpoint.steps());
            simulation.resume(&checkpoint)?
        }
        None => simulation.start(start.q, start.v)?,
    };
    let save = |run: &Run<DoublePendulum, _>| -> ControlFlow<io::Error> {
        println!("step {}: H = {:+.15}", run.steps(), run.energy());
        match file::write(&run.checkpoint(), &path) {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => ControlFlow::Break(error),
        }
    };
    let mut watch = (EnergyDrift::of(&run), every(interval, save));
    run.advance_observed(steps as f64 * H, &mut watch)?;
    let (energy, _) = watch;
    if let Some(drift) = energy.drift() {
        println!(
            "slope of the energy since the (re)start: {:+.1e} ± {:.1e} J per step",
            drift.slope, drift.half_width
        );
    }
    let bits: Vec<String> = run.state().q().iter().map(|q| format!("{:016x}", q.to_bits())).collect();
    println!("step {}: q = {:+.6?}, bits {}", run.steps(), run.state().q(), bits.join(" "));
    Ok(())
}
