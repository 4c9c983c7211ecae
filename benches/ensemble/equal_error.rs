//! Trajectories per second and core at the errors that heyoka's tolerances lead to: double pendulums near the horizontal, to T = 10.

use std::error::Error;
use std::fmt::Write;
use std::time::Instant;

use evi_benches::external::{BatchRow, PeerError, heyoka_batch};
use evi_core::ensemble::{ByIndex, Ends, Ensemble, LaneScheme, Member};
use evi_core::prelude::*;
use evi_examples::DoublePendulum;
use serde::Serialize;

use crate::family::fraction;
use crate::watch::Watch;

/// A row of `equal_error.csv`.
#[derive(Clone, Serialize)]
pub(crate) struct Row {
    method: String,
    /// Tolerance, or step size.
    setting: f64,
    /// To which a step is solved: of heyoka the same, of others 0 for round-off.
    tolerance: f64,
    trajectories: usize,
    /// The median over the trajectories of the largest error of a position at the end.
    median_error: f64,
    trajectories_per_second: f64,
}

const HORIZON: f64 = 10.0;
const TOLERANCES: [f64; 3] = [1e-4, 1e-8, 1e-12];

fn member(index: usize) -> Member<DoublePendulum> {
    let system = DoublePendulum::UNIT;
    let quarter = core::f64::consts::FRAC_PI_2;
    let angle = |salt| quarter + 0.1 * (fraction(index, salt) - 0.5);
    let start = system.at_angles(angle(0.2), angle(0.6));
    Member::of(&system, start.q, start.v)
}

/// Where trajectories have come to.
struct Moved {
    /// Positions at the end, trajectory by trajectory.
    ends: Vec<[f64; 4]>,
    /// What they took.
    seconds: f64,
}

/// Moves `count` trajectories; the seconds are the sum of the shortest times of blocks, whose repetitions are short,
/// so that some of them are not disturbed.
fn moved<F>(scheme: F, steps: u64, count: usize, repetitions: u32) -> Result<Moved, Box<dyn Error>>
where
    F: LaneScheme<DoublePendulum> + Sync,
{
    let ensemble = Ensemble::new(scheme).sampled(1, steps).threads(1);
    let (mut ends, mut seconds) = (Vec::new(), 0.0);
    for first in (0..count).step_by(BLOCK) {
        let members = ByIndex::new(BLOCK.min(count - first), |index| member(first + index));
        let mut shortest = f64::INFINITY;
        let mut gathered = None;
        for _ in 0..repetitions {
            let start = Instant::now();
            let outcome = ensemble.run(&members, &Ends)?;
            shortest = shortest.min(start.elapsed().as_secs_f64());
            if let Some(failure) = outcome.failures.first() {
                return Err(failure.error.clone().into());
            }
            gathered = Some(outcome.gathered);
        }
        seconds += shortest;
        let rows = gathered.iter().flat_map(|table| table.rows());
        ends.extend(rows.map(|row| [row[3], row[4], row[5], row[6]]));
    }
    Ok(Moved { ends, seconds })
}

/// Trajectories that are timed together: groups of eight in turn.
const BLOCK: usize = 32;

/// Pieces of work: heyoka, and every member.
pub(crate) const PIECES: usize = 11;

/// The rows that are finished before somebody interrupts.
pub(crate) fn all(quick: bool, watch: &Watch) -> Result<Vec<Row>, Box<dyn Error>> {
    let (count, repetitions) = if quick { (64, 10) } else { (64, 100) };
    let mut rows = Vec::new();
    if !watch.goes_on("heyoka") {
        return Ok(rows);
    }
    // Sixteenth order far below the errors that are compared, but for the round-off that the motion amplifies.
    let Moved { ends: reference, .. } = moved(Galerkin::<8>::new(0.02), 500, count, 1)?;
    let error = |ends: &[[f64; 4]]| {
        let distance = |(a, b): (&[f64; 4], &[f64; 4])| {
            a.iter().zip(b).fold(0.0_f64, |largest, (a, b)| largest.max((a - b).abs()))
        };
        let mut errors: Vec<f64> = ends.iter().zip(&reference).map(distance).collect();
        errors.sort_by(f64::total_cmp);
        errors[count / 2]
    };
    let starts: Vec<_> = (0..count).map(member).map(|member| (member.q, member.v)).collect();
    match heyoka_batch("double_pendulum", &DoublePendulum::UNIT, &starts, HORIZON, &TOLERANCES, repetitions) {
        Ok(found) => rows.extend(found.iter().map(|BatchRow { tolerance, microseconds, ends, batch }| Row {
            method: format!("heyoka, batches of {batch}"),
            setting: *tolerance,
            tolerance: *tolerance,
            trajectories: count,
            median_error: error(ends),
            trajectories_per_second: count as f64 / (1e-6 * microseconds),
        })),
        Err(error @ PeerError::NotInstalled { .. }) => println!("{error}"),
        Err(error) => return Err(error.into()),
    }
    // Round-off, unless a step may be solved to less.
    const ROUND_OFF: f64 = 0.0;
    let members: [(usize, u64, f64); PIECES - 1] = [
        (3, 125, ROUND_OFF),
        (3, 160, 1e-5),
        (4, 125, ROUND_OFF),
        (4, 125, 1e-6),
        (8, 125, ROUND_OFF),
        (8, 125, 1e-11),
        (8, 160, 1e-11),
        (8, 220, 1e-14),
        (8, 200, ROUND_OFF),
        (8, 250, ROUND_OFF),
    ];
    for (nodes, steps, tolerance) in members {
        let h = HORIZON / steps as f64;
        let method = format!("Galerkin {nodes}, lanes");
        if !watch.goes_on(&format!("{method}, h = {h}")) {
            break;
        }
        let Moved { ends, seconds } = match nodes {
            3 => moved(Galerkin::<3>::new(h).solved_to(tolerance), steps, count, repetitions)?,
            4 => moved(Galerkin::<4>::new(h).solved_to(tolerance), steps, count, repetitions)?,
            _ => moved(Galerkin::<8>::new(h).solved_to(tolerance), steps, count, repetitions)?,
        };
        rows.push(Row {
            method,
            setting: h,
            tolerance,
            trajectories: count,
            median_error: error(&ends),
            trajectories_per_second: count as f64 / seconds,
        });
    }
    Ok(rows)
}

/// The rows as text.
pub(crate) fn table(rows: &[Row]) -> String {
    let mut text = format!(
        "{:<22} {:>9} {:>9} {:>13} {:>20}\n",
        "method", "setting", "solved to", "median error", "trajectories/s/core"
    );
    for row in rows {
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{:<22} {:>9.1e} {:>9} {:>13.1e} {:>20.0}",
            row.method,
            row.setting,
            if row.tolerance > 0.0 { format!("{:.0e}", row.tolerance) } else { "round-off".to_owned() },
            row.median_error,
            row.trajectories_per_second
        );
    }
    text
}
