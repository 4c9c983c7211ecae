//! Instructions of a step, counted by valgrind's callgrind: a program runs itself.

use std::process::Command;

/// Instructions of one of `steps` steps: the program runs itself under callgrind with the arguments that `arguments` gives for `steps` and for
/// `3 · steps` steps, and the difference is what `2 · steps` steps execute. `None` where valgrind does not run.
pub fn per_step(steps: u64, arguments: impl Fn(u64) -> Vec<String>) -> Option<f64> {
    let count = |steps: u64| -> Option<f64> {
        let output = Command::new("valgrind")
            .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
            .arg(std::env::current_exe().ok()?)
            .args(arguments(steps))
            .output()
            .ok()?;
        let report = String::from_utf8(output.stderr).ok()?;
        report.split("Collected :").nth(1)?.split_whitespace().next()?.parse().ok()
    };
    Some((count(3 * steps)? - count(steps)?) / (2 * steps) as f64)
}
