//! The flip-time map of the double pendulum: over all starts at rest, how long it takes until a rod swings over the top.
//!
//! `cargo run --release --example flip_map -- --out flips.png`. The angles of the rods at the start, from −180° to 180° from hanging, are the axes: the
//! inner one to the right, the outer one upwards. Bright starts flip early, dark ones late, as many in every shade; black ones not before the end. Around rest in the middle
//! no start has the energy to flip; the edge of the rest is a fractal (Heyl, The double pendulum fractal, 2008).

mod flips;
mod picture;

use std::error::Error;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use clap::Parser;
use evi_core::ensemble::{ByIndex, Ensemble, Member};
use evi_core::prelude::*;
use evi_core::scalar::InstructionSet;
use evi_examples::DoublePendulum;

use flips::{FlipTimes, Flips};

/// A picture of when double pendulums flip.
#[derive(Parser)]
struct Options {
    /// The picture, a PNG file.
    #[arg(long, value_name = "FILE", default_value = "flip_map.png")]
    out: PathBuf,
    /// Starts along each axis.
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u32).range(2..=20_000))]
    size: u32,
    /// Time to which pendulums are followed.
    #[arg(long, default_value_t = 10.0)]
    to: f64,
    /// Step size.
    #[arg(long, default_value_t = 0.05)]
    step: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let Options { out, size, to, step } = Options::parse();
    let steps = (to / step).round();
    if !(1.0..1e9).contains(&steps) {
        return Err(format!("no number of steps of {step} leads to t = {to}").into());
    }
    let width = size as usize;
    let angle = |place: usize| std::f64::consts::TAU * ((place as f64 + 0.5) / f64::from(size) - 0.5);
    let members = ByIndex::new(width * width, |index| {
        let start = DoublePendulum::UNIT.at_angles(angle(index % width), angle(index / width));
        Member::of(&DoublePendulum::UNIT, start.q, start.v)
    });
    println!("{} starts; lanes in {}", width * width, InstructionSet::detect());
    let begin = Instant::now();
    let shown = AtomicUsize::new(0);
    let outcome = Ensemble::new(Galerkin::<8>::new(step))
        .section(Flips)
        .sampled(1, steps as u64)
        .run_watched(&members, &FlipTimes, None, &|progress| {
            let percent = 100 * progress.finished / progress.members;
            if shown.fetch_max(percent, Ordering::Relaxed) + 9 < percent {
                println!("{percent:>3} % after {:.1} s", begin.elapsed().as_secs_f64());
            }
            ControlFlow::Continue(())
        })?;
    let mut times = vec![f64::NAN; width * width];
    let mut flipped = 0;
    for row in outcome.gathered.rows() {
        times[row[0] as usize] = row[1];
        flipped += 1;
    }
    println!(
        "{flipped} flip before t = {to}; {} came to no end; {:.1} s",
        outcome.failures.len(),
        begin.elapsed().as_secs_f64()
    );
    picture::save(&out, width, &times)?;
    println!("wrote {}", out.display());
    Ok(())
}
