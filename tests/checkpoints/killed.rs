//! A process that is killed in the middle of a run, and another one that goes on.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use evi_core::prelude::*;
use evi_examples::DoublePendulum;

use crate::file;

const DOUBLE: DoublePendulum = DoublePendulum { m1: 1.3, m2: 0.7, l1: 0.9, l2: 1.1, g: 9.81 };
/// Steps from one checkpoint to the next.
const EVERY: u64 = 500;
/// Tells the process that is killed where to write.
const FILE: &str = "EVI_CHECKPOINT_FILE";
/// Checkpoints before the process is killed.
const AWAITED: u64 = 5;

type Scheme = evi_core::integrator::Compensated<evi_core::integrator::Composed<Evi<1>, 5>>;

fn simulation() -> Simulation<DoublePendulum, Scheme> {
    Simulation::new(DOUBLE, Evi::midpoint(0.02).composed(Composition::suzuki_4()).compensated())
}

fn start() -> Run<DoublePendulum, <Scheme as evi_core::prelude::Scheme<DoublePendulum>>::Step> {
    let start = DOUBLE.horizontal();
    simulation().start(start.q, start.v).expect("a consistent start")
}

#[test]
#[ignore = "runs until it is killed, by the other test"]
fn a_run_without_end() {
    let Some(path) = std::env::var_os(FILE).map(PathBuf::from) else { return };
    let mut run = start();
    // Not for ever, should nobody kill it.
    let deadline = Instant::now() + Duration::from_secs(60);
    while Instant::now() < deadline {
        for _ in 0..EVERY {
            run.advance().expect("the step exists");
        }
        file::write(&run.checkpoint(), &path).expect("the file can be written");
    }
}

/// Kills its process when it goes, however.
struct Killed(Child);

impl Drop for Killed {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Runs the test above in a process of its own, and kills that after a few checkpoints.
fn run_and_kill(path: &Path) {
    let child = Command::new(std::env::current_exe().expect("this program"))
        .args(["--exact", "killed::a_run_without_end", "--ignored", "--test-threads=1"])
        .env(FILE, path)
        .stdout(Stdio::null())
        .spawn()
        .expect("this program runs");
    let mut process = Killed(child);
    let deadline = Instant::now() + Duration::from_secs(60);
    loop {
        assert!(Instant::now() < deadline, "no checkpoint was written");
        assert!(process.0.try_wait().expect("a child").is_none(), "the run ended by itself");
        // Read while it is written: never half of it.
        if file::read(path)
            .expect("a whole file")
            .is_some_and(|checkpoint| checkpoint.steps() >= AWAITED * EVERY)
        {
            break;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    // On Unix SIGKILL: nothing of the process runs after it.
    process.0.kill().expect("the process runs");
}

#[test]
fn a_killed_run_goes_on_to_the_same_bits() {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("killed_{}.json", std::process::id()));
    let _ = std::fs::remove_file(&path);
    run_and_kill(&path);
    let checkpoint = file::read(&path).expect("a whole file").expect("it was there");
    println!("killed at or after step {}", checkpoint.steps());
    let end = checkpoint.steps() + 2 * EVERY;

    let mut resumed = simulation().resume(&checkpoint).expect("its own checkpoint");
    let mut uninterrupted = start();
    for run in [&mut resumed, &mut uninterrupted] {
        while run.steps() < end {
            run.advance().expect("the step exists");
        }
    }
    assert_eq!(resumed.checkpoint(), uninterrupted.checkpoint());
    let _ = std::fs::remove_file(&path);
    let _ = std::fs::remove_file(path.with_extension("next"));
}
