//! evi-core without the standard library: a static library with its own panic handler builds, and asks for no
//! heap.

use std::path::Path;
use std::process::{Command, Output};

const MANIFEST: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/no_std/Cargo.toml");
/// Inside the target directory of this workspace, so that `cargo clean` finds it.
const TARGET: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/no_std");

/// Runs cargo on the library. The environment of the outer cargo that chooses flags or targets must not leak
/// in.
fn cargo(subcommand: &str, features: &str) -> Output {
    Command::new(env!("CARGO"))
        .args([subcommand, "--manifest-path", MANIFEST, "--target-dir", TARGET, "--features", features])
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env_remove("CARGO_BUILD_TARGET")
        .output()
        .expect("cargo runs")
}

#[track_caller]
fn messages(output: &Output) -> &str {
    std::str::from_utf8(&output.stderr).expect("cargo writes UTF-8")
}

/// Whether the library holds this symbol, by the bytes of its name.
fn names(library: &[u8], symbol: &str) -> bool {
    library.windows(symbol.len()).any(|bytes| bytes == symbol.as_bytes())
}

// One test, since both builds write to one target directory.
#[test]
fn a_static_library_without_std_integrates_a_derived_pendulum() {
    let build = cargo("build", "");
    assert!(build.status.success(), "{}", messages(&build));
    let file = ["libevi_without_std.a", "evi_without_std.lib"]
        .map(|name| Path::new(TARGET).join("debug").join(name))
        .into_iter()
        .find(|path| path.exists())
        .expect("cargo built a static library");
    let library = std::fs::read(file).expect("the library is readable");
    assert!(names(&library, "energy_after_100_steps"), "nothing was integrated");
    assert!(!names(&library, "__rust_alloc"), "something asks for a heap");
    assert!(!names(&library, "rust_oom"), "something may run out of memory");

    // With `std` in the graph the same library has two panic handlers: the build above proves what it is said
    // to.
    let clash = cargo("check", "linked-std");
    assert!(!clash.status.success(), "std and a panic handler of one's own do not clash any more");
    assert!(messages(&clash).contains("panic_impl"), "{}", messages(&clash));
}
