//! How well do exponential variational integrators keep energy and constraints of the double pendulum?
//!
//! In: nothing but a folder. Out: tables on the terminal, `double_pendulum.csv`, and three figures: largest energy
//! error and largest constraint error over 100 steps for three step sizes (the two measurements of O. T. Kosmas, "The
//! stability of exponential variational integrators as key role tool in studying multibody dynamics", figures 2 and 3),
//! and the energy error over 20,000 steps.

mod experiment;
mod figures;
mod table;

use std::error::Error;
use std::path::PathBuf;

use clap::Parser;

use experiment::{Measurement, long_runs, short_runs};

/// Energy and constraint errors of exponential variational integrators, RK4 and RATTLE on the double pendulum.
#[derive(Parser)]
struct Options {
    /// Folder for the table and the figures.
    #[arg(long, value_name = "DIR", default_value = "target/double_pendulum")]
    out: PathBuf,
}

fn main() -> Result<(), Box<dyn Error>> {
    let Options { out } = Options::parse();
    std::fs::create_dir_all(&out).map_err(|error| format!("cannot create {}: {error}", out.display()))?;

    let short: Vec<Measurement> = short_runs();
    println!("Largest errors over 100 steps\n\n{}", table::of(&short));
    let long: Vec<Measurement> = long_runs();
    println!("Largest errors over 20,000 steps\n\n{}", table::of(&long));

    let csv = out.join("double_pendulum.csv");
    table::write_csv(&csv, short.iter().chain(&long))
        .map_err(|error| format!("cannot write {}: {error}", csv.display()))?;
    for path in [
        figures::energy_over_step_size(&short, &out)?,
        figures::constraints_over_step_size(&short, &out)?,
        figures::energy_over_time(&long, &out)?,
        csv,
    ] {
        println!("wrote {}", path.display());
    }
    Ok(())
}
