//! What one step costs: nanoseconds and instructions, path beside path, in one run.
//!
//! `cargo run --release --example step_cost`. Times are the minima of interleaved repetitions. Instructions are those of
//! valgrind's callgrind: the program runs itself with N and with 3N steps, and the difference is what 2N steps execute.
//! Where valgrind is missing the column says so.

use std::process::Command;
use std::time::Instant;

use evi_core::baseline::{Rattle, Rk4};
use evi_core::generic::{GenericEvi, GenericSystem};
use evi_core::prelude::*;
use evi_examples::{DoublePendulum, SphericalPendulum, Start, StiffSpringPendulum};

#[path = "hand_written/double_pendulum.rs"]
mod hand_written;

const H: f64 = 0.01;
/// Steps of a timed repetition.
const TIMED_STEPS: u64 = 100_000;
const REPETITIONS: usize = 7;
/// Steps of the shorter counted run.
const COUNTED_STEPS: u64 = 1_000;

/// One way to take the steps of one scene.
struct Path {
    scene: &'static str,
    name: &'static str,
    /// Takes so many steps from the scene's start and returns a coordinate of the end.
    run: fn(u64) -> f64,
}

const PATHS: [Path; 9] = [
    Path { scene: "double_pendulum", name: "hand_written", run: hand_written_double_pendulum },
    Path { scene: "double_pendulum", name: "evi_midpoint", run: |steps| double(Evi::midpoint(H), steps) },
    Path {
        scene: "double_pendulum",
        name: "evi_simpson_omega",
        run: |steps| double(Evi::simpson(H).frequency(2.397), steps),
    },
    Path { scene: "double_pendulum", name: "rattle", run: |steps| double(Rattle::new(H), steps) },
    Path { scene: "double_pendulum", name: "rk4", run: |steps| double(Rk4::new(H), steps) },
    Path {
        scene: "double_pendulum",
        name: "generic_midpoint",
        run: |steps| generic(DoublePendulum::UNIT, DoublePendulum::UNIT.at_angles(0.1, 0.1), steps),
    },
    Path {
        scene: "spherical_pendulum",
        name: "evi_midpoint",
        run: |steps| {
            let pendulum = SphericalPendulum::UNIT;
            specialised(pendulum, Evi::midpoint(H), pendulum.one_radian(), steps)
        },
    },
    Path {
        scene: "stiff_spring_pendulum",
        name: "evi_midpoint",
        run: |steps| {
            let spring = StiffSpringPendulum::with_stiffness(1e4);
            specialised(spring, Evi::midpoint(H), spring.horizontal(), steps)
        },
    },
    Path {
        scene: "stiff_spring_pendulum",
        name: "generic_midpoint",
        run: |steps| {
            let spring = StiffSpringPendulum::with_stiffness(1e4);
            generic(spring, spring.horizontal(), steps)
        },
    },
];

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if let [_, counted, path, steps] = arguments.as_slice()
        && counted == "--counted"
    {
        // Under valgrind: only the steps.
        let path = &PATHS[path.parse::<usize>().expect("an index of PATHS")];
        println!("{}", (path.run)(steps.parse().expect("a number of steps")));
        return;
    }
    let nanoseconds = nanoseconds_per_step();
    println!("{:<22} {:<18} {:>8} {:>14}", "scene", "path", "ns/step", "instructions");
    for (index, path) in PATHS.iter().enumerate() {
        let instructions = instructions_per_step(index);
        let instructions = instructions.map_or("no valgrind".to_owned(), |count| format!("{count:.0}"));
        println!("{:<22} {:<18} {:>8.1} {:>14}", path.scene, path.name, nanoseconds[index], instructions);
    }
}

/// The minima over repetitions that take turns, so that a slow moment of the machine hits all paths alike.
fn nanoseconds_per_step() -> [f64; PATHS.len()] {
    let mut fastest = [f64::INFINITY; PATHS.len()];
    for _ in 0..REPETITIONS {
        for (path, fastest) in PATHS.iter().zip(&mut fastest) {
            let clock = Instant::now();
            std::hint::black_box((path.run)(TIMED_STEPS));
            *fastest = fastest.min(1e9 * clock.elapsed().as_secs_f64() / TIMED_STEPS as f64);
        }
    }
    fastest
}

/// Instructions of one step, or `None` where valgrind does not run.
fn instructions_per_step(path: usize) -> Option<f64> {
    let count = |steps: u64| -> Option<f64> {
        let output = Command::new("valgrind")
            .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
            .arg(std::env::current_exe().ok()?)
            .args(["--counted", &path.to_string(), &steps.to_string()])
            .output()
            .ok()?;
        let report = String::from_utf8(output.stderr).ok()?;
        report.split("Collected :").nth(1)?.split_whitespace().next()?.parse().ok()
    };
    Some((count(3 * COUNTED_STEPS)? - count(COUNTED_STEPS)?) / (2 * COUNTED_STEPS) as f64)
}

fn double<F: Scheme<DoublePendulum>>(scheme: F, steps: u64) -> f64 {
    specialised(DoublePendulum::UNIT, scheme, DoublePendulum::UNIT.at_angles(0.1, 0.1), steps)
}

fn specialised<const N: usize, S, F>(system: S, scheme: F, start: Start<N>, steps: u64) -> f64
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S>,
{
    let mut run = Simulation::new(system, scheme).start(start.q, start.v).expect("a consistent start");
    for _ in 0..steps {
        run.advance().expect("steps small enough");
    }
    run.state().q()[0]
}

fn generic<const N: usize, S: GenericSystem>(system: S, start: Start<N>, steps: u64) -> f64 {
    let mut run = GenericEvi::midpoint(H).start(system, &start.q, &start.v).expect("a consistent start");
    for _ in 0..steps {
        run.advance().expect("steps small enough");
    }
    run.q()[0]
}

fn hand_written_double_pendulum(steps: u64) -> f64 {
    let pendulum = DoublePendulum::UNIT;
    let mut run = hand_written::HandWritten::new(&pendulum, pendulum.at_angles(0.1, 0.1), H);
    for _ in 0..steps {
        assert!(run.advance(), "steps small enough");
    }
    run.q()[0]
}
