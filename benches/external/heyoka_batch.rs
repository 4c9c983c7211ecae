//! heyoka's batch: many trajectories in the lanes of the machine's vectors, run as a program beside this one.

use std::str::FromStr;

use evi_core::system::MechanicalSystem;

use super::heyoka::{HeyokaError, answer, named_parameters};

/// A run of heyoka's batch.
#[derive(Clone, Debug, PartialEq)]
pub struct BatchRow<const N: usize> {
    /// Tolerance.
    pub tolerance: f64,
    /// The shortest of the repetitions in microseconds, for all trajectories on one core, without compilation.
    pub microseconds: f64,
    /// Trajectories side by side.
    pub batch: usize,
    /// Configurations at the end, trajectory by trajectory.
    pub ends: Vec<[f64; N]>,
}

/// Runs heyoka's batch on the scene of this name from these starts at time 0 to `t`, once per tolerance; as many starts as fill whole batches.
///
/// # Errors
/// [`HeyokaError`]; [`HeyokaError::NotInstalled`] where there is none, which is no failure of a comparison.
pub fn heyoka_batch<S: MechanicalSystem, const N: usize>(
    scene: &str,
    system: &S,
    starts: &[([f64; N], [f64; N])],
    t: f64,
    tolerances: &[f64],
    repetitions: u32,
) -> Result<Vec<BatchRow<N>>, HeyokaError> {
    let starts_as_lists: Vec<[[f64; N]; 2]> = starts.iter().map(|(q, v)| [*q, *v]).collect();
    let request = format!(
        "{{\"scene\": \"{scene}\", \"parameters\": {}, \"starts\": {starts_as_lists:?}, \"t\": {t:?}, \
         \"tolerances\": {tolerances:?}, \"repetitions\": {repetitions}}}",
        named_parameters(system)
    );
    let answer = answer("peers/heyoka_batch.py", scene, &request)?;
    answer.lines().map(|line| row(line, starts.len())).collect()
}

/// `tolerance,microseconds,batch,q...`.
fn row<const N: usize>(line: &str, trajectories: usize) -> Result<BatchRow<N>, HeyokaError> {
    let expected = 3 + N * trajectories;
    let failure = || HeyokaError::Row { expected, line: line.to_owned() };
    let numbers: Result<Vec<f64>, _> = line.split(',').map(f64::from_str).collect();
    let numbers = numbers.map_err(|_| failure())?;
    match &numbers[..] {
        [tolerance, microseconds, batch, ends @ ..] if ends.len() == N * trajectories => Ok(BatchRow {
            tolerance: *tolerance,
            microseconds: *microseconds,
            batch: *batch as usize,
            ends: ends.as_chunks::<N>().0.to_vec(),
        }),
        _ => Err(failure()),
    }
}
