//! Error against run time: the double pendulum from the horizontal, chaotic, over ten units of time.
//!
//! `cargo run --release --example work_precision`. Every member runs with steps that fall by a factor of two; times are the shortest of
//! repetitions, in process and on one thread, the preparation of a run included. Errors are distances in Cartesian `q` at the end from a certified
//! reference. For each member and each error the fastest run that reaches it counts.

use std::time::Instant;

use evi_core::baseline::{Rattle, Rk4};
use evi_core::prelude::*;
use evi_core::scalar::InstructionSet;
use evi_examples::DoublePendulum;
use evi_tests::scenes::DoublePendulumInAngles;

const T: f64 = 10.0;
const ERRORS: [f64; 5] = [1e-2, 1e-4, 1e-6, 1e-9, 1e-12];
const REPETITIONS: usize = 15;
/// `DoublePendulum::UNIT` from `horizontal()` at `T`, in 60 digits by two programs that share nothing; 20 of them agree.
const REFERENCE: [f64; 4] =
    [-0.538_347_239_612_226_4, -0.842_723_115_620_958_9, -1.040_765_783_246_170_5, -1.707_347_662_469_327_4];
/// A run that would take longer is left out.
const MOST_STEPS: f64 = 2e5;

/// The end of a run with steps of the given size, where it has one.
type Solve = fn(f64) -> Option<[f64; 4]>;

const MEMBERS: [(&str, Solve); 12] = [
    ("Rk4 (constraints drift)", |h| end(Rk4::new(h))),
    ("Rattle", |h| end(Rattle::new(h))),
    ("Evi::midpoint", |h| end(Evi::midpoint(h))),
    ("  composed, suzuki_4", |h| end(Evi::midpoint(h).composed(Composition::suzuki_4()))),
    ("  composed, kahan_li_6", |h| end(Evi::midpoint(h).composed(Composition::kahan_li_6()))),
    ("  composed, kahan_li_8", |h| end(Evi::midpoint(h).composed(Composition::kahan_li_8()))),
    ("Galerkin::<2>", |h| end(Galerkin::<2>::new(h))),
    ("Galerkin::<4>", |h| end(Galerkin::<4>::new(h))),
    ("Galerkin::<6>", |h| end(Galerkin::<6>::new(h))),
    ("Galerkin::<8>", |h| end(Galerkin::<8>::new(h))),
    ("  by Newton's iteration", |h| end(Galerkin::<8>::new(h).by_newton())),
    ("Gauss::<8> in angles", end_in_angles),
];

fn main() {
    println!("microseconds to reach an error in q at t = {T}; lanes in {}\n", InstructionSet::detect());
    print!("| member |");
    ERRORS.iter().for_each(|error| print!(" {error:.0e} |"));
    println!("\n|---|{}", "---|".repeat(ERRORS.len()));
    for (name, solve) in MEMBERS {
        let runs: Vec<(f64, f64)> = step_sizes().map_while(|h| measured(solve, h)).collect();
        print!("| {name} |");
        for error in ERRORS {
            let reached = runs.iter().filter(|run| run.0 <= error).map(|run| run.1);
            match reached.min_by(f64::total_cmp) {
                Some(microseconds) => print!(" {microseconds:.0} |"),
                None => print!(" – |"),
            }
        }
        println!();
    }
}

/// Steps from 0.2 on, each `2^(-1/4)` of the one before and a whole fraction of `T`.
fn step_sizes() -> impl Iterator<Item = f64> {
    (0..)
        .map(|k| (50.0 * 2.0_f64.powf(0.25 * f64::from(k))).round())
        .take_while(|n| *n <= MOST_STEPS)
        .map(|n| T / n)
}

/// Error and microseconds of a run; `None` once the error has reached round-off. A step size without a solution has an infinite error.
fn measured(solve: Solve, h: f64) -> Option<(f64, f64)> {
    let mut microseconds = f64::INFINITY;
    let mut error = f64::INFINITY;
    for _ in 0..REPETITIONS {
        let clock = Instant::now();
        let end = std::hint::black_box(solve(h));
        microseconds = microseconds.min(1e6 * clock.elapsed().as_secs_f64());
        error = end.map_or(f64::INFINITY, |q| distance(&q, &REFERENCE));
        // Long runs need no repetition to be told apart.
        if microseconds > 2e4 {
            break;
        }
    }
    (error > 1e-13).then_some((error, microseconds))
}

fn end<F: Scheme<DoublePendulum>>(scheme: F) -> Option<[f64; 4]> {
    let pendulum = DoublePendulum::UNIT;
    let start = pendulum.horizontal();
    let mut run = Simulation::new(pendulum, scheme).start(start.q, start.v).expect("a consistent start");
    run.advance_to(T).ok().map(|state| *state.q())
}

fn end_in_angles(h: f64) -> Option<[f64; 4]> {
    let pendulum = DoublePendulumInAngles { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g: 9.81 };
    let run = Simulation::new(pendulum, Gauss::<8>::new(h));
    let mut run = run.start([core::f64::consts::FRAC_PI_2; 2], [0.0; 2]).expect("a consistent start");
    run.advance_to(T).ok().map(|state| pendulum.cartesian(*state.q(), *state.v()).q)
}

fn distance(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
