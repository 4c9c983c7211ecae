//! MuJoCo on a hanging chain: run as a program beside this one.

use super::python::{self, PeerError};

/// A run of MuJoCo.
#[derive(Clone, Debug, PartialEq)]
pub struct MujocoRow {
    /// The shortest of the repetitions in microseconds, from the prepared model to the end.
    pub microseconds: f64,
    /// Number of steps.
    pub steps: u64,
    /// The places of the point masses at the end: `x₁, y₁, x₂, …`.
    pub q: Vec<f64>,
}

/// Runs MuJoCo (E. Todorov, T. Erez, Y. Tassa, IROS 2012, 5026) with its Runge-Kutta method of order 4 on a chain of `bodies` point masses `1/bodies`
/// on rods `1/bodies`, at rest from the horizontal to `t`, once per number of steps.
///
/// # Errors
/// [`PeerError`].
pub fn mujoco_chain(
    bodies: usize,
    gravity: f64,
    t: f64,
    steps: &[u64],
    repetitions: u32,
) -> Result<Vec<MujocoRow>, PeerError> {
    let share = 1.0 / bodies as f64;
    let request = format!(
        "{{\"bodies\": {bodies}, \"mass\": {share:?}, \"length\": {share:?}, \"gravity\": {gravity:?}, \"t\": {t:?}, \
         \"steps\": {steps:?}, \"repetitions\": {repetitions}}}"
    );
    let rows = python::ask("mujoco", "mujoco_peer.py", &request, 2 + 2 * bodies)?;
    let row = |row: Vec<f64>| MujocoRow { microseconds: row[0], steps: row[1] as u64, q: row[2..].to_vec() };
    Ok(rows.into_iter().map(row).collect())
}
