//! What tolerances make of a mechanism: double pendulums whose masses, lengths and starts are a tenth apart, summed up over time.
//!
//! What is finished lies in a journal beside the tables until the program is through: Ctrl-C, a kill or a full disk lose the members under way, and the
//! same command goes on from there, to the same bits.

use std::error::Error;
use std::fmt::Write;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use evi_benches::program::progress::{self, Interruption};
use evi_core::ensemble::{ByIndex, Ensemble, Journal, Outcome, Quantity, Summaries, SummaryPart};
use evi_core::memory::{Memory, Record};
use evi_core::prelude::*;
use evi_examples::DoublePendulum;
use serde::Serialize;

use crate::family::Family;

/// A row of `tolerances.csv`: a quantity over all members at one time.
#[derive(Serialize)]
pub(crate) struct Row {
    t: f64,
    quantity: &'static str,
    members: u64,
    mean: f64,
    deviation: f64,
    smallest: f64,
    lower_quartile: f64,
    median: f64,
    upper_quartile: f64,
    largest: f64,
}

/// What has become of the members.
pub(crate) enum Tolerances {
    /// Their summaries, with a digest of every bit of them.
    Complete(Vec<Row>, u64),
    /// Somebody has interrupted; what is finished is in the journal.
    Interrupted,
}

const QUANTITIES: [&str; 2] = ["constraint error", "height"];
const H: f64 = 0.01;
const SAMPLES: usize = 10;
const STEPS: u64 = 1_000;

/// The journal in a folder.
pub(crate) fn journal(out: &Path) -> PathBuf {
    out.join("ensemble.journal")
}

/// Moves the members, those that are in the journal of the folder `out` aside.
pub(crate) fn all(
    quick: bool,
    out: Option<&Path>,
    interruption: &Interruption,
) -> Result<Tolerances, Box<dyn Error>> {
    let count = if quick { 4_096 } else { 2_000_000 };
    let name = format!("tolerances {count} {H:?} {SAMPLES} {STEPS}");
    let journal = out.map(|out| Journal::open(journal(out), &name)).transpose()?;
    let height = Quantity::<DoublePendulum>::new(QUANTITIES[1], |sight| sight.state.q()[3]);
    let gather = Summaries::new(SAMPLES, vec![DoublePendulum::constraint_error(), height]);
    let members = ByIndex::new(count, DoublePendulum::member);
    let bar = progress::bar(count as u64).with_message("members");
    let outcome = Ensemble::new(Evi::midpoint(H)).sampled(SAMPLES, STEPS / SAMPLES as u64).run_watched(
        &members,
        &gather,
        journal.as_ref(),
        &|progress| {
            bar.set_position(progress.finished as u64);
            if interruption.is_wanted() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        },
    )?;
    bar.finish_and_clear();
    if !outcome.is_complete() {
        let Outcome { finished, .. } = outcome;
        match out.map(self::journal) {
            Some(path) => println!(
                "interrupted: {finished} of {count} members are kept in {}; the same command goes on from here",
                path.display()
            ),
            None => {
                println!("interrupted at {finished} of {count} members; --out DIR keeps what is finished")
            }
        }
        return Ok(Tolerances::Interrupted);
    }
    if let Some(failure) = outcome.failures.first() {
        println!(
            "{} members came to no end; number {}: {}",
            outcome.failures.len(),
            failure.member,
            failure.error
        );
    }
    Ok(Tolerances::Complete(rows(&outcome.gathered), digest(&outcome.gathered)))
}

fn rows(summaries: &SummaryPart) -> Vec<Row> {
    let times = (0..=SAMPLES)
        .flat_map(|sample| QUANTITIES.iter().enumerate().map(move |(k, name)| (sample, k, *name)));
    times
        .map(|(sample, k, quantity)| {
            let summary = summaries.at(sample, k);
            let quantile = |p| summary.quantile(p).unwrap_or(f64::NAN);
            Row {
                t: H * (sample as u64 * (STEPS / SAMPLES as u64)) as f64,
                quantity,
                members: summary.count(),
                mean: summary.mean(),
                deviation: summary.variance().sqrt(),
                smallest: summary.smallest().map_or(f64::NAN, |extreme| extreme.value),
                lower_quartile: quantile(0.25),
                median: quantile(0.5),
                upper_quartile: quantile(0.75),
                largest: summary.largest().map_or(f64::NAN, |extreme| extreme.value),
            }
        })
        .collect()
}

/// Of all words that the summaries consist of (FNV-1a; Fowler, Noll, Vo).
fn digest(summaries: &SummaryPart) -> u64 {
    let mut digest = 0xcbf2_9ce4_8422_2325_u64;
    summaries.record(&mut Record::to(&mut |word| {
        for byte in word.to_le_bytes() {
            digest = (digest ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }));
    digest
}

/// The rows as text.
pub(crate) fn table(rows: &[Row], digest: u64) -> String {
    let mut text = format!(
        "{:>5} {:<16} {:>9} {:>10} {:>10} {:>10} {:>10} {:>10}\n",
        "t", "quantity", "members", "mean", "deviation", "quartile", "median", "quartile"
    );
    for row in rows {
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{:>5} {:<16} {:>9} {:>10.2e} {:>10.2e} {:>10.2e} {:>10.2e} {:>10.2e}",
            row.t,
            row.quantity,
            row.members,
            row.mean,
            row.deviation,
            row.lower_quartile,
            row.median,
            row.upper_quartile
        );
    }
    let _ = writeln!(text, "every bit of it: {digest:016x}");
    text
}
