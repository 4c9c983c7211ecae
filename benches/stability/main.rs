//! Stiff and extreme: which method fails where, how, and whether theory says so.
//!
//! `cargo run --release --example stability`. A row per case and method: a verdict with the numbers behind it and the first step at which it
//! shows ([`verdict`] has the criteria), what theory says, and an independent check of every accepted step ([`check`]). Out: a table on the
//! terminal, and in the folder `--out` the files `stability.csv` and `stability.html` (opens offline). Ends with 1 if a row has a fault: a step
//! that does not satisfy its equations, a verdict or number that theory does not admit, a panic, a hang.

mod action;
mod brouwer;
mod cases;
mod check;
mod existence;
mod files;
mod inner_points;
mod markdown;
mod measurement;
mod methods;
mod observation;
mod rows;
mod scenes;
mod series;
mod specimen;
mod table;
mod tangent;
mod theory;
mod verdict;

use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;

use evi_benches::program::files::prepare;
use evi_benches::program::progress::Ending;
use evi_benches::program::{check_names, is_chosen};

use rows::{Effort, Planned, Row};

/// Methods on stiff and extreme cases.
#[derive(Parser)]
struct Options {
    /// Only these cases, such as stiffness.
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    case: Vec<String>,
    /// Only these methods, such as midpoint.
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    method: Vec<String>,
    /// Every third value of each sweep, and short long runs.
    #[arg(long)]
    quick: bool,
    /// Folder for the results, made if it is missing.
    #[arg(long, value_name = "DIR", default_value = "target/stability")]
    out: PathBuf,
    /// Writes the matrix of cases and methods as Markdown, too.
    #[arg(long, value_name = "FILE")]
    markdown: Option<PathBuf>,
}

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok((Ending::Interrupted, _)) => ExitCode::from(130),
        Ok((Ending::Complete, 0)) => ExitCode::SUCCESS,
        Ok((Ending::Complete, _)) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

/// How it ended, and how many rows have faults.
fn run(options: &Options) -> Result<(Ending, usize), Box<dyn Error>> {
    let planned = plan(options)?;
    prepare(&options.out)?;
    let (rows, ending) = measurement::run(planned)?;
    table::print(&rows);
    println!();
    for path in files::write(&rows, options.quick, &options.out)? {
        println!("wrote {}", path.display());
    }
    if let Some(path) = &options.markdown {
        println!("wrote {}", markdown::write(&rows, path)?.display());
    }
    if ending == Ending::Interrupted {
        println!("interrupted: {} rows are finished", rows.len());
    }
    Ok((ending, table::print_faults(&rows)))
}

/// The rows of the chosen cases and methods.
fn plan(options: &Options) -> Result<Vec<Planned>, String> {
    let effort = Effort { quick: options.quick };
    let names: Vec<&str> = cases::ALL.iter().map(|case| case.name).collect();
    check_names("case", &options.case, &names)?;
    let all: Vec<Planned> = cases::ALL.iter().flat_map(|case| (case.rows)(effort)).collect();
    let mut methods: Vec<&str> = all.iter().map(|row| row.method).collect();
    methods.sort_unstable();
    methods.dedup();
    check_names("method", &options.method, &methods)?;
    let is_wanted =
        |row: &Planned| is_chosen(row.case, &options.case) && is_chosen(row.method, &options.method);
    Ok(all.into_iter().filter(is_wanted).collect())
}

/// A row is at fault, and the program with it.
fn has_fault(row: &Row) -> bool {
    !row.finding.faults.is_empty()
}
