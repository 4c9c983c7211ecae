//! Many trajectories at once: nanoseconds per trajectory and step, beside a lane kernel written by hand and heyoka's batch.
//!
//! `cargo run --release --example ensemble -- --out DIR [--quick]`. Out: three tables on the terminal and in files: `tolerances.csv`, summaries of two million
//! double pendulums with tolerances; `ensemble.csv`; and `equal_error.csv`, trajectories per second of the double pendulum to T = 10 at the errors that heyoka's
//! tolerances lead to. With the feature `mpi` an ensemble runs on 1, 2 and 4 processes. Ctrl-C keeps what is finished. Members that are finished are not
//! moved again by the same command; timings of another hour are no part of a table, so that these are all taken anew. Lanes take the vector instructions that the
//! machine has, found at run time; everything else those of the build (`RUSTFLAGS="-C target-cpu=native"` for all of the machine).

mod equal_error;
mod family;
#[cfg(feature = "mpi")]
mod processes;
mod speed;
mod tolerances;
mod watch;

use std::error::Error;
use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use evi_benches::program::files;
use evi_benches::program::machine::Machine;
use evi_benches::program::progress::{Ending, Interruption};

use tolerances::Tolerances;
use watch::Watch;

/// Speed of ensembles.
#[derive(Parser)]
struct Options {
    /// Folder for the tables, made if it is missing.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Fewer and shorter repetitions: figures for a first look.
    #[arg(long)]
    quick: bool,
}

fn main() -> ExitCode {
    match run() {
        Ok(Ending::Complete) => ExitCode::SUCCESS,
        Ok(Ending::Interrupted) => ExitCode::from(130),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

fn run() -> Result<Ending, Box<dyn Error>> {
    #[cfg(feature = "mpi")]
    if std::env::args().any(|argument| argument == processes::AS_PROCESS) {
        return processes::take_part().map(|()| Ending::Complete);
    }
    let Options { out, quick } = Options::parse();
    // Before the minutes of measuring: a folder that cannot be written is told at once.
    out.as_deref().map(files::prepare).transpose()?;
    println!("{}\n", Machine::present().line());
    let interruption = Interruption::listen()?;
    let family = match tolerances::all(quick, out.as_deref(), &interruption)? {
        Tolerances::Complete(family, digest) => {
            println!("{}", tolerances::table(&family, digest));
            family
        }
        Tolerances::Interrupted => return Ok(Ending::Interrupted),
    };
    let watch = Watch::of(speed::rounds(quick) + equal_error::PIECES, interruption);
    #[cfg_attr(not(feature = "mpi"), expect(unused_mut, reason = "rows of processes come with the feature"))]
    let mut rows = speed::all(quick, &watch)?;
    #[cfg(feature = "mpi")]
    rows.extend(processes::all()?);
    let errors = equal_error::all(quick, &watch)?;
    let is_complete = watch.finish();
    print!("{}", speed::table(&rows));
    print!("\n{}", equal_error::table(&errors));
    if let Some(out) = &out {
        let tables = [
            ("tolerances.csv", files::csv(&family)),
            ("ensemble.csv", files::csv(&rows)),
            ("equal_error.csv", files::csv(&errors)),
        ];
        for (name, text) in tables {
            println!("wrote {}", files::replace(&out.join(name), &text)?.display());
        }
    }
    if is_complete && let Some(out) = &out {
        fs::remove_file(tolerances::journal(out))?;
    }
    if !is_complete {
        println!("interrupted: these are the figures that were finished");
        return Ok(Ending::Interrupted);
    }
    Ok(Ending::Complete)
}
