//! heyoka's batch: many trajectories in the lanes of the machine's vectors, run as a program beside this one.

use evi_core::system::MechanicalSystem;

use super::heyoka::named_parameters;
use super::python::{self, PeerError};

/// A run of heyoka's batch.
#[derive(Clone, Debug, PartialEq)]
pub struct BatchRow<const N: usize> {
    /// Tolerance.
    pub tolerance: f64,
    /// Microseconds for all trajectories on one core, without compilation: the sum over the batches of their shortest repetitions.
    pub microseconds: f64,
    /// Trajectories side by side.
    pub batch: usize,
    /// Configurations at the end, trajectory by trajectory.
    pub ends: Vec<[f64; N]>,
}

/// Runs heyoka's batch on the scene of this name from these starts at time 0 to `t`, once per tolerance; as many starts as fill whole batches.
///
/// # Errors
/// [`PeerError`]; [`PeerError::NotInstalled`] where there is none, which is no failure of a comparison.
pub fn heyoka_batch<S: MechanicalSystem, const N: usize>(
    scene: &str,
    system: &S,
    starts: &[([f64; N], [f64; N])],
    t: f64,
    tolerances: &[f64],
    repetitions: u32,
) -> Result<Vec<BatchRow<N>>, PeerError> {
    let starts_as_lists: Vec<[[f64; N]; 2]> = starts.iter().map(|(q, v)| [*q, *v]).collect();
    let request = format!(
        "{{\"scene\": \"{scene}\", \"parameters\": {}, \"starts\": {starts_as_lists:?}, \"t\": {t:?}, \
         \"tolerances\": {tolerances:?}, \"repetitions\": {repetitions}}}",
        named_parameters(system)
    );
    let rows = python::ask("heyoka", "heyoka_batch.py", &request, 3 + N * starts.len())?;
    let row = |row: Vec<f64>| BatchRow {
        tolerance: row[0],
        microseconds: row[1],
        batch: row[2] as usize,
        ends: row[3..].as_chunks::<N>().0.to_vec(),
    };
    Ok(rows.into_iter().map(row).collect())
}
