//! What one step costs: nanoseconds and instructions, path beside path, in one run.
//!
//! `cargo run --release --example step_cost -- --out DIR`. Out: a table on the terminal, and with `--out` the file
//! `step_cost.csv`. A path is a way to take the midpoint step of a scene: written by `hand` for this scene alone;
//! `specialised`, as the derive and evi-core make it; `dense`, with the same kernels but the pivoted dense solve of the whole
//! saddle-point system in every Newton correction; `generic`, with sizes known at run time and derivatives by dual numbers.

mod measure;
mod paths;
mod table;

use std::error::Error;
use std::path::PathBuf;

use clap::Parser;

use measure::Effort;

/// Nanoseconds, instructions and Newton corrections of a step, on several paths.
#[derive(Parser)]
struct Options {
    /// Folder for `step_cost.csv`, made if it is missing.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Fewer and shorter repetitions: figures for a first look.
    #[arg(long)]
    quick: bool,
    /// Takes steps of one path and nothing else: what this program runs under valgrind.
    #[arg(long, num_args = 2, value_names = ["PATH", "STEPS"], hide = true)]
    counted: Option<Vec<u64>>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let Options { out, quick, counted } = Options::parse();
    let paths = paths::all();
    if let Some(counted) = counted {
        let path = paths.get(counted[0] as usize).ok_or("no such path")?;
        println!("{}", (path.take)(counted[1]));
        return Ok(());
    }
    // Before the minutes of measuring: a folder that cannot be written is told at once.
    let csv = out.map(|out| table::create_csv(&out)).transpose()?;
    let costs = measure::all(&paths, if quick { Effort::QUICK } else { Effort::FULL });
    print!("{}", table::of(&costs));
    if let Some(csv) = csv {
        let path = csv.write(&costs)?;
        println!("\nwrote {}", path.display());
    }
    Ok(())
}
