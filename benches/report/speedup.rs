//! What the specialised code of a scene gains over the generic path: the same method on both, with the same steps.

use std::process::Command;
use std::time::Instant;

use evi_benches::comparison::scenes::AnyScene;

use crate::results::{Row, Speedup};

/// Methods by their names on both paths, with the error that each is used for as a fraction of the configuration.
const PAIRS: [([&str; 2], f64); 2] =
    [(["midpoint", "midpoint_generic"], 1e-3), (["galerkin_8", "galerkin_8_generic"], 1e-9)];
const REPETITIONS: usize = 9;
/// For a first look.
const FEW_REPETITIONS: usize = 2;
/// Steps of a counted run; a second one takes twice as many.
const COUNTED_STEPS: u64 = 40;

/// Of every pair of methods, at the step size with about its usual error, of those that both paths have reached the horizon with.
pub(crate) fn speedups(scene: &dyn AnyScene, rows: &[Row], quick: bool) -> Vec<Speedup> {
    PAIRS.iter().filter_map(|&(pair, usual_error)| speedup(scene, rows, pair, usual_error, quick)).collect()
}

fn speedup(
    scene: &dyn AnyScene,
    rows: &[Row],
    [specialised, generic]: [&str; 2],
    usual_error: f64,
    quick: bool,
) -> Option<Speedup> {
    let errors = |method: &str| -> Vec<(f64, f64)> {
        rows.iter()
            .filter(|row| row.method == method)
            .filter_map(|row| row.h.zip(row.position_error))
            .collect()
    };
    let generic_errors = errors(generic);
    let usual = usual_error * scene.facts().size;
    let (h, _) = errors(specialised)
        .into_iter()
        .filter(|(h, _)| generic_errors.iter().any(|(other, _)| other == h))
        .min_by(|a, b| (a.1 / usual).ln().abs().total_cmp(&(b.1 / usual).ln().abs()))?;
    let numbers = [number(scene, specialised)?, number(scene, generic)?];
    let mut fastest = [f64::INFINITY; 2];
    for _ in 0..if quick { FEW_REPETITIONS } else { REPETITIONS } {
        for (fastest, method) in fastest.iter_mut().zip(numbers) {
            let mut solver = scene.start(method, h).ok()?;
            let clock = Instant::now();
            solver.advance_to(scene.facts().horizon).ok()?;
            *fastest = fastest.min(1e9 * clock.elapsed().as_secs_f64() / solver.steps() as f64);
        }
    }
    let name = scene.facts().name;
    let count = |method| if quick { None } else { instructions(name, method, h) };
    Some(Speedup {
        scene: name.into(),
        method: specialised.into(),
        h,
        specialised_ns: fastest[0],
        generic_ns: fastest[1],
        specialised_instructions: count(specialised),
        generic_instructions: count(generic),
    })
}

fn number(scene: &dyn AnyScene, method: &str) -> Option<usize> {
    scene.methods().iter().position(|facts| facts.name == method)
}

/// What this program does when it runs itself under valgrind: so many steps of a method on a scene.
pub(crate) fn take_steps(scene: &dyn AnyScene, method: &str, h: f64, steps: u64) -> Option<f64> {
    let mut solver = scene.start(number(scene, method)?, h).ok()?;
    solver.advance_to(h * steps as f64).ok()?;
    solver.q().first().copied()
}

/// Instructions of one step, counted by valgrind's callgrind as the difference of two runs.
fn instructions(scene: &str, method: &str, h: f64) -> Option<f64> {
    let count = |steps: u64| -> Option<f64> {
        let output = Command::new("valgrind")
            .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
            .arg(std::env::current_exe().ok()?)
            .args(["--counted", scene, method, &h.to_string(), &steps.to_string()])
            .output()
            .ok()?;
        let report = String::from_utf8(output.stderr).ok()?;
        report.split("Collected :").nth(1)?.split_whitespace().next()?.parse().ok()
    };
    Some((count(2 * COUNTED_STEPS)? - count(COUNTED_STEPS)?) / COUNTED_STEPS as f64)
}
