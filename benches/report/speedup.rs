//! What the specialised code of a scene gains over the generic path: the midpoint rule on both, with the same steps.

use std::process::Command;
use std::time::Instant;

use evi_benches::comparison::scenes::AnyScene;

use crate::results::{Row, Speedup};

const SPECIALISED: &str = "midpoint";
const GENERIC: &str = "midpoint_generic";
const REPETITIONS: usize = 9;
/// Steps of a counted run; a second one takes twice as many.
const COUNTED_STEPS: u64 = 40;

/// An error of this fraction of the configuration is what the midpoint rule is used for.
const USUAL_ERROR: f64 = 1e-3;

/// At the step size with about the [usual error](USUAL_ERROR), of those that both paths have reached the horizon with.
pub(crate) fn speedup(scene: &dyn AnyScene, rows: &[Row], quick: bool) -> Option<Speedup> {
    let errors = |method: &str| -> Vec<(f64, f64)> {
        rows.iter()
            .filter(|row| row.method == method)
            .filter_map(|row| row.h.zip(row.position_error))
            .collect()
    };
    let generic = errors(GENERIC);
    let usual = USUAL_ERROR * scene.facts().size;
    let (h, _) = errors(SPECIALISED)
        .into_iter()
        .filter(|(h, _)| generic.iter().any(|(other, _)| other == h))
        .min_by(|a, b| (a.1 / usual).ln().abs().total_cmp(&(b.1 / usual).ln().abs()))?;
    let (specialised, generic) = (number(scene, SPECIALISED)?, number(scene, GENERIC)?);
    let mut fastest = [f64::INFINITY; 2];
    for _ in 0..REPETITIONS {
        for (fastest, method) in fastest.iter_mut().zip([specialised, generic]) {
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
        method: SPECIALISED.into(),
        h,
        specialised_ns: fastest[0],
        generic_ns: fastest[1],
        specialised_instructions: count(SPECIALISED),
        generic_instructions: count(GENERIC),
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
