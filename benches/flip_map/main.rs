//! The flip-time map of the double pendulum: over all starts at rest, how long it takes until a rod swings over the top.
//!
//! `cargo run --release --example flip_map -- --out flips.png`. The angles of the rods at the start, from −180° to 180° from hanging, are the axes: the
//! inner one to the right, the outer one upwards. Bright starts flip early, dark ones late, as many in every shade; black ones not before the end. Around rest in the middle
//! no start has the energy to flip; the edge of the rest is a fractal (Heyl, The double pendulum fractal, 2008).
//!
//! What is finished lies in a journal beside the picture until that is drawn: Ctrl-C, a kill or a full disk lose the starts under way, and the same
//! command goes on from there, to the same picture.

mod flips;
mod picture;

use std::error::Error;
use std::fs;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use evi_benches::program::files;
use evi_benches::program::progress::{self, Ending, Interruption};
use evi_core::ensemble::{ByIndex, Ensemble, Journal, Member};
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

/// Starts that are followed at a time: what an interruption loses is no more per thread.
const CHUNK: usize = 256;

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(Ending::Complete) => ExitCode::SUCCESS,
        Ok(Ending::Interrupted) => ExitCode::from(130),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(Options { out, size, to, step }: &Options) -> Result<Ending, Box<dyn Error>> {
    let steps = (to / step).round();
    if !(1.0..1e9).contains(&steps) {
        return Err(format!("no number of steps of {step} leads to t = {to}").into());
    }
    let width = *size as usize;
    let count = width * width;
    let angle = |place: usize| std::f64::consts::TAU * ((place as f64 + 0.5) / width as f64 - 0.5);
    let members = ByIndex::new(count, |index| {
        let start = DoublePendulum::UNIT.at_angles(angle(index % width), angle(index / width));
        Member::of(&DoublePendulum::UNIT, start.q, start.v)
    });
    let journal_path = out.with_extension("journal");
    let journal = Journal::open(&journal_path, &format!("flip map {size} {to:?} {step:?} {CHUNK}"))?;
    println!("{count} starts; lanes in {}", InstructionSet::detect());
    let interruption = Interruption::listen()?;
    let bar = progress::bar(count as u64);
    bar.set_position(count.min(CHUNK * journal.finished_chunks()) as u64);
    bar.reset_eta();
    let begin = Instant::now();
    let outcome = Ensemble::new(Galerkin::<8>::new(*step))
        .section(Flips)
        .sampled(1, steps as u64)
        .chunks_of(CHUNK)
        .run_watched(&members, &FlipTimes, Some(&journal), &|progress| {
            bar.set_position(progress.finished as u64);
            if interruption.is_wanted() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
    bar.finish_and_clear();
    if !outcome.is_complete() {
        println!(
            "interrupted: {} of {count} starts are kept in {}; the same command goes on from here",
            outcome.finished,
            journal_path.display()
        );
        return Ok(Ending::Interrupted);
    }
    let mut times = vec![f64::NAN; count];
    for row in outcome.gathered.rows() {
        times[row[0] as usize] = row[1];
    }
    println!(
        "{} flip before t = {to}; {} came to no end; {:.1} s",
        outcome.gathered.rows().len(),
        outcome.failures.len(),
        begin.elapsed().as_secs_f64()
    );
    println!("wrote {}", files::replace(out, &picture::png(width, &times)?)?.display());
    fs::remove_file(journal_path)?;
    Ok(Ending::Complete)
}
