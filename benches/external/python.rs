//! Programs in Python, run beside this one: a request as JSON on their standard input, rows of numbers on their standard output.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::str::FromStr;

/// Names the Python that has the packages; without it, `python3`.
const PYTHON: &str = "EVI_PEERS_PYTHON";
/// Exit code of a script for scenes that it has no equations for.
const UNKNOWN_SCENE: i32 = 3;

/// Why there are no rows.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PeerError {
    /// Python cannot import the package.
    #[error("{package} is not installed for `{python}`; `{PYTHON}` names another Python")]
    NotInstalled {
        /// What is missing.
        package: &'static str,
        /// The Python that was asked.
        python: String,
    },
    /// The script has no equations for the scene.
    #[error("no equations of this scene for {package}")]
    UnknownScene {
        /// What was asked.
        package: &'static str,
    },
    /// The program ended early.
    #[error("{package} ended with {status}: {message}")]
    Ended {
        /// What was asked.
        package: &'static str,
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

/// Runs `script` of the folder `peers`, which imports `package`; the rows that it answers, of `columns` numbers each.
///
/// # Errors
/// [`PeerError`]; [`PeerError::NotInstalled`] where there is no such package, which is no failure of a comparison.
pub(super) fn ask(
    package: &'static str,
    script: &str,
    request: &str,
    columns: usize,
) -> Result<Vec<Vec<f64>>, PeerError> {
    let python = std::env::var(PYTHON).unwrap_or_else(|_| "python3".to_owned());
    let import =
        Command::new(&python).args(["-c", &format!("import {package}")]).stderr(Stdio::null()).status();
    if !import.is_ok_and(|status| status.success()) {
        return Err(PeerError::NotInstalled { package, python });
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers").join(script);
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
        Some(0) => {}
        Some(UNKNOWN_SCENE) => return Err(PeerError::UnknownScene { package }),
        _ => {
            let message = String::from_utf8_lossy(&output.stderr).trim().to_owned();
            return Err(PeerError::Ended { package, status: output.status, message });
        }
    }
    String::from_utf8_lossy(&output.stdout).lines().map(|line| row(line, columns)).collect()
}

fn row(line: &str, expected: usize) -> Result<Vec<f64>, PeerError> {
    let numbers: Result<Vec<f64>, _> = line.split(',').map(f64::from_str).collect();
    let numbers = numbers.ok().filter(|numbers| numbers.len() == expected);
    numbers.ok_or_else(|| PeerError::Row { expected, line: line.to_owned() })
}
