//! Steps cannot panic: in an optimised program no path to a panic is left in them.

use std::path::Path;
use std::process::{Command, Output};

const MANIFEST: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/no_panic/Cargo.toml");
/// Inside the target directory of this workspace, so that `cargo clean` finds it.
const TARGET: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/no_panic");

/// Builds a program. The environment of the outer cargo that chooses flags or targets must not leak in.
fn build(program: &str, features: &str) -> Output {
    Command::new(env!("CARGO"))
        .args(["build", "--release", "--manifest-path", MANIFEST, "--target-dir", TARGET])
        .args(["--bin", program, "--features", features])
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env_remove("CARGO_BUILD_TARGET")
        .output()
        .expect("cargo runs")
}

// One test, since both builds write to one target directory.
#[test]
fn no_path_to_a_panic_is_left_in_a_step() {
    let steps = build("steps", "");
    assert!(steps.status.success(), "{}", String::from_utf8_lossy(&steps.stderr));
    let taken = Command::new(Path::new(TARGET).join("release").join("steps")).output().expect("it runs");
    let lines = String::from_utf8_lossy(&taken.stdout);
    assert!(taken.status.success(), "{}", String::from_utf8_lossy(&taken.stderr));
    assert!(lines.lines().count() > 10 && lines.lines().all(|line| line == "true"), "steps fail: {lines}");
    // The link fails where a path is left: the build above proves what it is said to.
    let control = build("can-panic", "can-panic");
    let messages = String::from_utf8_lossy(&control.stderr);
    assert!(!control.status.success(), "a function that can panic links");
    assert!(messages.contains("detected panic in function `can_panic`"), "{messages}");
}
