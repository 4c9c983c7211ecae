//! The same ensemble on 1, 2 and 4 processes: the same summaries to the last bit.
//!
//! This program starts itself under `mpirun`; a process does its share and the first one says what it has gathered.

use std::error::Error;
use std::process::Command;
use std::time::Instant;

use evi_core::ensemble::{ByIndex, Ensemble, Quantity, Summaries};
use evi_core::memory::{Memory, Record};
use evi_core::prelude::*;
use evi_core::scalar::LANES;
use evi_examples::{DoublePendulum, Scene};

use crate::family::Family;
use crate::speed::Row;

/// Argument that makes this program one of the processes.
pub(crate) const AS_PROCESS: &str = "--as-process";

const TRAJECTORIES: usize = 1024;
const STEPS: u64 = 2_000;
const SAMPLES: usize = 4;

/// The share of one process. The first one prints nanoseconds per trajectory and step, the largest constraint residual, and all words of the
/// summaries.
pub(crate) fn take_part() -> Result<(), Box<dyn Error>> {
    let universe = mpi::initialize().ok_or("MPI does not start")?;
    let height = Quantity::<DoublePendulum>::new("height", |sight| sight.state.q()[3]);
    let gather = Summaries::new(SAMPLES, vec![DoublePendulum::constraint_error(), height]);
    let members = ByIndex::new(TRAJECTORIES, DoublePendulum::member);
    let ensemble =
        Ensemble::new(Evi::midpoint(0.01)).sampled(SAMPLES, STEPS / SAMPLES as u64).chunks_of(64).threads(1);
    let begin = Instant::now();
    let Some(outcome) = ensemble.run_on_processes(&universe.world(), &members, &gather)? else {
        return Ok(());
    };
    let nanoseconds = begin.elapsed().as_secs_f64() * 1e9 / (TRAJECTORIES as f64 * STEPS as f64);
    let largest = outcome.gathered.at(SAMPLES, 0).largest().map_or(f64::NAN, |extreme| extreme.value);
    let mut words = String::new();
    outcome.gathered.record(&mut Record::to(&mut |word| words.push_str(&format!(" {word:x}"))));
    println!("{nanoseconds:?} {largest:?}{words}");
    Ok(())
}

/// A row per number of processes.
///
/// # Errors
/// If there is no `mpirun`, or if summaries differ.
pub(crate) fn all() -> Result<Vec<Row>, Box<dyn Error>> {
    let mut rows: Vec<Row> = Vec::new();
    let mut alone = None;
    for processes in [1, 2, 4] {
        let output = Command::new("mpirun")
            .args(["--allow-run-as-root", "--oversubscribe", "-n", &processes.to_string()])
            .arg(std::env::current_exe()?)
            .arg(AS_PROCESS)
            .output()?;
        let text = String::from_utf8(output.stdout)?;
        let mut numbers = text.trim().splitn(3, ' ');
        let (Some(nanoseconds), Some(error), Some(words)) = (numbers.next(), numbers.next(), numbers.next())
        else {
            return Err(format!("{processes} processes: {}", String::from_utf8_lossy(&output.stderr)).into());
        };
        let alone = alone.get_or_insert_with(|| words.to_owned());
        if alone != words {
            return Err(format!("{processes} processes gather other bits than one").into());
        }
        let nanoseconds: f64 = nanoseconds.parse()?;
        let first = rows.first().map_or(nanoseconds, |row| row.ns_per_trajectory_step);
        rows.push(Row {
            scene: DoublePendulum::NAME,
            method: "midpoint, speed-up over one process".to_owned(),
            lanes: LANES,
            threads: 1,
            processes,
            trajectories: TRAJECTORIES,
            ns_per_trajectory_step: nanoseconds,
            speedup: first / nanoseconds,
            max_constraint_error: error.parse()?,
        });
    }
    println!("1, 2 and 4 processes gather the same bits\n");
    Ok(rows)
}
