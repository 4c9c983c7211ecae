//! What a step costs when a scene grows, and what it takes to a given error beside solvers of other projects.
//!
//! `cargo run --release --example scaling -- --out DIR`. Out: tables on the terminal, and with `--out` the files `scaling.csv` and
//! `time_to_solution.csv`. MuJoCo is measured where the Python that `EVI_PEERS_PYTHON` names has it, rapier2d with the feature `rapier`.

mod measure;
mod scenes;
mod solution;
mod specimen;
mod table;

use std::error::Error;
use std::path::PathBuf;

use clap::Parser;
use evi_benches::external::rapier_chain;
use evi_benches::program::files;
use evi_benches::program::machine::Machine;
use evi_benches::program::progress::{self, Interruption};

use measure::Effort;

/// Chains, rings, trees and nets of up to 10,000 bodies: cost of a step, and time to a given error.
#[derive(Parser)]
struct Options {
    /// Folder for the files, made if it is missing.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Fewer and shorter repetitions, at most 1,000 bodies, no solvers of other projects: figures for a first look.
    #[arg(long)]
    quick: bool,
    /// Takes steps of one row and nothing else: what this program runs under valgrind.
    #[arg(long, num_args = 2, value_names = ["ROW", "STEPS"], hide = true)]
    counted: Option<Vec<u64>>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let Options { out, quick, counted } = Options::parse();
    let mut rows = scenes::rows();
    if let Some(counted) = counted {
        let mut run = rows.get(counted[0] as usize).ok_or("no such row")?.start()?;
        run.take(counted[1])?;
        println!("{:?}", run.q().last());
        return Ok(());
    }
    // Before the minutes of measuring: a folder that cannot be written is told at once.
    out.as_deref().map(files::prepare).transpose()?;
    println!("{}\n", Machine::present().line());
    if quick {
        rows.retain(|row| row.bodies <= 1_000);
    }
    let interruption = Interruption::listen()?;
    let effort = if quick { Effort::QUICK } else { Effort::FULL };
    let bar = progress::bar(rows.len() as u64);
    let costs = measure::costs(&rows, effort, &bar, || interruption.is_wanted());
    bar.finish_and_clear();
    println!("{}", table::of_costs(&costs));
    if let Some(out) = &out {
        println!("wrote {}\n", files::replace(&out.join("scaling.csv"), &files::csv(&costs))?.display());
    }
    if quick || interruption.is_wanted() {
        return Ok(());
    }
    for bodies in [20, 100] {
        match rapier_chain(bodies, 0.002, 1_000, 7) {
            Ok(ns) => println!("rapier2d, chain of {bodies}, impulse joints: {ns:.0} ns per step"),
            Err(error) => println!("rapier2d, chain of {bodies}: {error}"),
        }
    }
    let comparisons = solution::all(7)?;
    for comparison in &comparisons {
        println!("\n{}", table::of_solutions(&comparison.title, &comparison.solutions));
        comparison.missing.iter().for_each(|missing| println!("{missing}"));
    }
    if let Some(out) = &out {
        let solutions = comparisons.iter().flat_map(|comparison| &comparison.solutions);
        println!(
            "\nwrote {}",
            files::replace(&out.join("time_to_solution.csv"), &files::csv(solutions))?.display()
        );
    }
    Ok(())
}
