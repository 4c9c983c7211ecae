//! heyoka, which is compiled for the scene by its own compiler: run as a program beside this one.

use evi_core::system::MechanicalSystem;

use super::python::{self, PeerError};

/// A run of heyoka.
#[derive(Clone, Debug, PartialEq)]
pub struct HeyokaRow {
    /// Tolerance.
    pub tolerance: f64,
    /// The shortest of the repetitions in microseconds, without compilation.
    pub microseconds: f64,
    /// Number of steps.
    pub steps: u64,
    /// Configuration at the end.
    pub q: Vec<f64>,
    /// Velocity at the end.
    pub v: Vec<f64>,
}

/// Runs heyoka (F. Biscani, D. Izzo, Mon. Not. R. Astron. Soc. 504 (2021) 2614) on the scene of this name from `(q, v)` at time 0 to `t`,
/// once per tolerance, as the index-1 equations in the scene's coordinates.
///
/// # Errors
/// [`PeerError`].
pub fn heyoka<S: MechanicalSystem>(
    scene: &str,
    system: &S,
    (q, v): (&[f64], &[f64]),
    t: f64,
    tolerances: &[f64],
    repetitions: u32,
) -> Result<Vec<HeyokaRow>, PeerError> {
    let request = format!(
        "{{\"scene\": \"{scene}\", \"parameters\": {}, \"q\": {q:?}, \"v\": {v:?}, \"t\": {t:?}, \
         \"tolerances\": {tolerances:?}, \"repetitions\": {repetitions}}}",
        named_parameters(system)
    );
    let rows = python::ask("heyoka", "heyoka_peer.py", &request, 3 + 2 * q.len())?;
    let row = |row: Vec<f64>| {
        let (q, v) = row[3..].split_at(q.len());
        HeyokaRow {
            tolerance: row[0],
            microseconds: row[1],
            steps: row[2] as u64,
            q: q.to_vec(),
            v: v.to_vec(),
        }
    };
    Ok(rows.into_iter().map(row).collect())
}

/// The parameters of a scene as a JSON object.
pub(super) fn named_parameters<S: MechanicalSystem>(system: &S) -> String {
    let parameters = system.parameters();
    let named = S::PARAMETERS.iter().zip(parameters.as_ref()).map(|(name, x)| format!("\"{name}\": {x:?}"));
    format!("{{{}}}", named.collect::<Vec<_>>().join(", "))
}
