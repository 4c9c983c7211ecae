//! With what the numbers were measured.

use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

use evi_core::scalar::InstructionSet;
use serde::{Deserialize, Serialize};

/// Processor, compiler and source of a measurement.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    processor: String,
    cores: usize,
    system: String,
    compiler: String,
    /// Flags of the compiler beside those of the release profile.
    flags: String,
    /// Vector instructions that node-per-lane steps use here, and those of everything else.
    vector_instructions: String,
    revision: String,
    /// Seconds since 1970-01-01 UTC at which the measurement began.
    date: u64,
}

impl Machine {
    /// This machine, this build, now.
    pub fn present() -> Self {
        Self {
            processor: processor().unwrap_or_else(|| std::env::consts::ARCH.to_owned()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            system: std::env::consts::OS.to_owned(),
            compiler: env!("EVI_BENCHES_COMPILER").to_owned(),
            flags: env!("EVI_BENCHES_FLAGS").to_owned(),
            vector_instructions: format!(
                "lanes {}, else {}",
                InstructionSet::detect(),
                compiled_instructions()
            ),
            revision: revision().unwrap_or_else(|| "unknown".to_owned()),
            date: SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_secs()),
        }
    }

    /// Whether measurements of both belong together: all but the date.
    pub fn is_like(&self, other: &Self) -> bool {
        Self { date: 0, ..self.clone() } == Self { date: 0, ..other.clone() }
    }

    /// One line.
    pub fn line(&self) -> String {
        let Self { processor, cores, system, compiler, flags, vector_instructions, revision, .. } = self;
        let flags = if flags.is_empty() { "none" } else { flags };
        format!(
            "{processor}, {cores} cores, {system}; {compiler}, flags: {flags}, {vector_instructions}; \
             revision {revision}"
        )
    }
}

fn processor() -> Option<String> {
    let info = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = info.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split(':').nth(1)?.trim().to_owned())
}

/// What the whole program is compiled for.
const fn compiled_instructions() -> &'static str {
    if cfg!(target_feature = "avx512f") {
        "AVX-512"
    } else if cfg!(target_feature = "avx2") {
        "AVX2"
    } else if cfg!(target_feature = "sse2") {
        "SSE2"
    } else if cfg!(target_feature = "neon") {
        "NEON"
    } else {
        "none"
    }
}

/// Short hash of the checked-out commit, marked where files differ from it.
fn revision() -> Option<String> {
    let output = Command::new("git")
        .args(["describe", "--always", "--dirty"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .ok()?;
    let revision = String::from_utf8(output.stdout).ok()?.trim().to_owned();
    (output.status.success() && !revision.is_empty()).then_some(revision)
}
