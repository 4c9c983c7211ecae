//! heyoka, which is compiled for the scene by its own compiler: run as a program beside this one.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::str::FromStr;

use evi_core::system::MechanicalSystem;

/// Names the Python that has heyoka; without it, `python3`.
const PYTHON: &str = "EVI_PEERS_PYTHON";
/// Exit code of the script for scenes that it has no equations for.
const UNKNOWN_SCENE: i32 = 3;

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

/// Why there are no rows.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum HeyokaError {
    /// Python cannot import it.
    #[error("heyoka is not installed for `{python}`; `{PYTHON}` names another Python")]
    NotInstalled {
        /// The Python that was asked.
        python: String,
    },
    /// `benches/peers/heyoka_peer.py` has no equations for the scene.
    #[error("no equations of `{scene}` for heyoka")]
    UnknownScene {
        /// Name of the scene.
        scene: String,
    },
    /// The program ended early.
    #[error("heyoka ended with {status}: {message}")]
    Ended {
        /// How.
        status: std::process::ExitStatus,
        /// What it said.
        message: String,
    },
    /// A line is no row.
    #[error("not a row of {expected} numbers: {line}")]
    Row {
        /// How many numbers there should be.
        expected: usize,
        /// The line.
        line: String,
    },
    /// The program could not be talked to.
    #[error(transparent)]
    Io(#[from] std::io::Error),
}

/// Runs heyoka (F. Biscani, D. Izzo, Mon. Not. R. Astron. Soc. 504 (2021) 2614) on the scene of this name from `(q, v)` at time 0 to `t`,
/// once per tolerance, as the index-1 equations in the scene's coordinates.
///
/// # Errors
/// [`HeyokaError`]; [`HeyokaError::NotInstalled`] where there is none, which is no failure of a comparison.
pub fn heyoka<S: MechanicalSystem>(
    scene: &str,
    system: &S,
    (q, v): (&[f64], &[f64]),
    t: f64,
    tolerances: &[f64],
    repetitions: u32,
) -> Result<Vec<HeyokaRow>, HeyokaError> {
    let request = format!(
        "{{\"scene\": \"{scene}\", \"parameters\": {}, \"q\": {q:?}, \"v\": {v:?}, \"t\": {t:?}, \
         \"tolerances\": {tolerances:?}, \"repetitions\": {repetitions}}}",
        named_parameters(system)
    );
    answer("peers/heyoka_peer.py", scene, &request)?.lines().map(|line| row(line, q.len())).collect()
}

/// The parameters of a scene as a JSON object.
pub(super) fn named_parameters<S: MechanicalSystem>(system: &S) -> String {
    let parameters = system.parameters();
    let named = S::PARAMETERS.iter().zip(parameters.as_ref()).map(|(name, x)| format!("\"{name}\": {x:?}"));
    format!("{{{}}}", named.collect::<Vec<_>>().join(", "))
}

/// What the script answers to a request.
pub(super) fn answer(script: &str, scene: &str, request: &str) -> Result<String, HeyokaError> {
    let python = std::env::var(PYTHON).unwrap_or_else(|_| "python3".to_owned());
    let import = Command::new(&python).args(["-c", "import heyoka"]).stderr(Stdio::null()).status();
    if !import.is_ok_and(|status| status.success()) {
        return Err(HeyokaError::NotInstalled { python });
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join(script);
    let mut program = Command::new(&python)
        .arg(script)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()?;
    // Dropped at once, which ends the script's input.
    program.stdin.take().map_or(Ok(()), |mut input| input.write_all(request.as_bytes()))?;
    let output = program.wait_with_output()?;
    match output.status.code() {
        Some(0) => Ok(String::from_utf8_lossy(&output.stdout).into_owned()),
        Some(UNKNOWN_SCENE) => Err(HeyokaError::UnknownScene { scene: scene.to_owned() }),
        _ => {
            let message = String::from_utf8_lossy(&output.stderr).trim().to_owned();
            Err(HeyokaError::Ended { status: output.status, message })
        }
    }
}

/// `tolerance,microseconds,steps,q...,v...`.
fn row(line: &str, n: usize) -> Result<HeyokaRow, HeyokaError> {
    let expected = 3 + 2 * n;
    let failure = || HeyokaError::Row { expected, line: line.to_owned() };
    let numbers: Result<Vec<f64>, _> = line.split(',').map(f64::from_str).collect();
    let numbers = numbers.map_err(|_| failure())?;
    match numbers[..] {
        [tolerance, microseconds, steps, ref end @ ..] if end.len() == 2 * n => {
            let (q, v) = end.split_at(n);
            Ok(HeyokaRow { tolerance, microseconds, steps: steps as u64, q: q.to_vec(), v: v.to_vec() })
        }
        _ => Err(failure()),
    }
}
