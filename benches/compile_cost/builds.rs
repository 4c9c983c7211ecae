//! The throw-away crate, and cargo on it.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::Instant;

/// Name of the throw-away crate.
const CRATE: &str = "evi_scene";

/// The profiles of a new crate.
#[derive(Clone, Copy)]
pub(crate) enum Profile {
    Debug,
    Release,
}

impl Profile {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Debug => "debug",
            Self::Release => "release",
        }
    }

    fn arguments(self) -> &'static [&'static str] {
        match self {
            Self::Debug => &[],
            Self::Release => &["--release"],
        }
    }
}

/// A crate in a temporary folder, which is removed with it.
pub(crate) struct Bench {
    folder: PathBuf,
}

impl Bench {
    /// The crate, with its dependencies built.
    pub(crate) fn new() -> Result<Self, Box<dyn Error>> {
        let folder = std::env::temp_dir().join(format!("evi-compile-cost-{}", std::process::id()));
        let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize()?;
        std::fs::create_dir_all(folder.join("src"))?;
        let bench = Self { folder };
        let manifest = format!(
            "[package]\nname = \"{CRATE}\"\nversion = \"0.0.0\"\nedition = \"2024\"\n\n[workspace]\n\n[dependencies]\n\
             evi-core = {{ path = {:?}, features = [\"generic\"] }}\n",
            workspace.join("evi-core")
        );
        std::fs::write(bench.folder.join("Cargo.toml"), manifest)?;
        // The versions that this program was built with: they are there already.
        std::fs::copy(workspace.join("Cargo.lock"), bench.folder.join("Cargo.lock"))?;
        for profile in [Profile::Debug, Profile::Release] {
            bench.build(profile, "fn main() {}")?;
        }
        Ok(bench)
    }

    /// Seconds that `cargo build` takes with this source, dependencies built.
    pub(crate) fn build(&self, profile: Profile, source: &str) -> Result<f64, Box<dyn Error>> {
        self.write(source)?;
        let start = Instant::now();
        self.cargo("build", profile, &[])?;
        Ok(start.elapsed().as_secs_f64())
    }

    /// Seconds of rustc's pass that expands the macros of this source, parsing of the result included; `None` where rustc
    /// does not tell. `-Z time-passes` is unstable, and allowed for this crate alone.
    pub(crate) fn expansion(&self, profile: Profile, source: &str) -> Result<Option<f64>, Box<dyn Error>> {
        self.write(source)?;
        let passes = self.cargo("rustc", profile, &["--", "-Ztime-passes"])?;
        let report = String::from_utf8_lossy(&passes.stderr) + String::from_utf8_lossy(&passes.stdout);
        let pass = report.lines().find(|line| line.trim_end().ends_with("macro_expand_crate"));
        let seconds =
            pass.and_then(|line| line.split_whitespace().nth(1)?.trim_end_matches(';').parse().ok());
        Ok(seconds)
    }

    /// The numbers that the program prints.
    pub(crate) fn numbers<const N: usize>(&self, profile: Profile) -> Result<[f64; N], Box<dyn Error>> {
        let program = self.folder.join("target").join(profile.name()).join(CRATE);
        let output = Command::new(program.with_extension(std::env::consts::EXE_EXTENSION)).output()?;
        let text = String::from_utf8(output.stdout)?;
        let numbers: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse).collect();
        let numbers = numbers.ok().and_then(|numbers| numbers.try_into().ok());
        numbers.ok_or_else(|| {
            format!("the scene printed {text:?}, and {}", String::from_utf8_lossy(&output.stderr)).into()
        })
    }

    fn write(&self, source: &str) -> std::io::Result<()> {
        std::fs::write(self.folder.join("src").join("main.rs"), source)
    }

    fn cargo(
        &self,
        subcommand: &str,
        profile: Profile,
        arguments: &[&str],
    ) -> Result<Output, Box<dyn Error>> {
        let output = Command::new(env!("CARGO"))
            .args([subcommand, "--offline", "--target-dir", "target"])
            .args(profile.arguments())
            .args(arguments)
            .current_dir(&self.folder)
            // The same for every call, or dependencies would be built again.
            .env("RUSTC_BOOTSTRAP", CRATE)
            .env("CARGO_INCREMENTAL", "0")
            .env_remove("RUSTFLAGS")
            .env_remove("CARGO_ENCODED_RUSTFLAGS")
            .env_remove("CARGO_BUILD_TARGET")
            .output()?;
        if output.status.success() {
            return Ok(output);
        }
        Err(format!("cargo {subcommand} failed:\n{}", String::from_utf8_lossy(&output.stderr)).into())
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        // A folder that stays behind in the temporary one harms nobody.
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}
