//! Are the ends of the gallery's standard motions right?
//!
//! `cargo run --release --example reference`. Every scene is integrated anew in octuple precision, with its own kernels but by a
//! method that the project has nowhere else, with two step sizes; the end is compared with the one that the gallery states. `--digits`
//! prints the ends, to be written into the gallery.

mod extrapolation;
mod index_1;

use std::process::ExitCode;

use clap::Parser;

use evi_benches::octuple::Octuple;
use evi_core::array::Array;
use evi_core::scalar::Scalar;
use evi_examples::{ReferenceOrigin, Scene, Visitor, visit_all};

use index_1::Index1;

/// Ends of the standard motions, computed anew.
#[derive(Parser)]
struct Options {
    /// Only this scene.
    #[arg(long, value_name = "NAME")]
    scene: Option<String>,
    /// Prints the ends as Rust.
    #[arg(long)]
    digits: bool,
}

/// The ends by two step sizes agree to this fraction of the configuration: beyond the digits of `f64`.
const AGREEMENT: f64 = 1e-20;
/// Largest distance from an end that was computed for decimal parameters; the chaotic double pendulum sets it.
const ROUNDED_PARAMETERS: f64 = 1e-13;
/// Most refinements until they agree.
const REFINEMENTS: u32 = 6;

fn main() -> ExitCode {
    let mut check = Check { options: Options::parse(), seen: 0, wrong: 0 };
    println!("{:<24} {:>14} {:>10} {:>11} {:>11}", "scene", "origin", "steps", "off in q", "off in v");
    visit_all(&mut check);
    if check.seen == 0 {
        eprintln!("error: the gallery has no such scene");
        return ExitCode::from(2);
    }
    ExitCode::from(u8::from(check.wrong > 0))
}

struct Check {
    options: Options,
    seen: u32,
    wrong: u32,
}

impl Visitor for Check {
    fn visit<S: Scene>(&mut self) {
        if self.options.scene.as_ref().is_some_and(|name| name != S::NAME) {
            return;
        }
        self.seen += 1;
        let reference = S::reference();
        let Some(End { q, v, steps }) = end::<S>() else {
            println!("{:<24} {:>14} two step sizes do not agree", S::NAME, reference.origin.to_string());
            self.wrong += 1;
            return;
        };
        let off_q = relative_distance(reference.q.as_ref(), &q);
        let off_v = relative_distance(reference.v.as_ref(), &v);
        let allowed = match reference.origin {
            // The last digit is rounded.
            ReferenceOrigin::Octuple => f64::EPSILON,
            // Computed for the parameters as decimals: rounding them to `f64`, as here, moves the end by some roundings.
            ReferenceOrigin::Certified | ReferenceOrigin::ClosedForm => ROUNDED_PARAMETERS,
        };
        // A NaN is wrong.
        let is_right = off_q <= allowed && off_v <= allowed;
        self.wrong += u32::from(!is_right);
        let verdict = if is_right { "" } else { "  wrong" };
        let origin = reference.origin.to_string();
        println!("{:<24} {origin:>14} {steps:>10} {off_q:>11.1e} {off_v:>11.1e}{verdict}", S::NAME);
        if self.options.digits {
            println!("    q: {:?},\n    v: {:?},", rounded(&q), rounded(&v));
        }
    }
}

struct End {
    q: Vec<Octuple>,
    v: Vec<Octuple>,
    steps: u32,
}

/// Doubles the number of steps until the end does not change beyond [`AGREEMENT`].
fn end<S: Scene>() -> Option<End> {
    let mut coarse = integrate::<S>(32);
    for refinement in 0..REFINEMENTS {
        let steps = 64 << refinement;
        let fine = integrate::<S>(steps);
        let size: f64 = norm(fine.iter().copied());
        let change = norm(fine.iter().zip(&coarse).map(|(&a, &b)| a - b));
        if size.is_finite() && change <= AGREEMENT * size {
            let (q, v) = fine.split_at(S::N_COORDINATES);
            return Some(End { q: q.to_vec(), v: v.to_vec(), steps });
        }
        coarse = fine;
    }
    None
}

/// `(q, v)` at the horizon.
fn integrate<S: Scene>(steps: u32) -> Vec<Octuple> {
    let system = S::standard();
    let equations = Index1::<S, Octuple>::new(&system);
    let n = S::N_COORDINATES;
    let slope = |t: Octuple, y: &[Octuple]| -> Vec<Octuple> {
        let (q, v) = (Array::from_fn(|i| y[i]), Array::from_fn(|i| y[n + i]));
        y[n..].iter().copied().chain(equations.acceleration(t, &q, &v)).collect()
    };
    let (q, v) = system.standard_motion();
    let mut y: Vec<Octuple> =
        q.as_ref().iter().chain(v.as_ref()).map(|&value| Scalar::from_f64(value)).collect();
    let count = Octuple::from_f64(f64::from(steps));
    let h = Octuple::from_f64(S::HORIZON) / count;
    for k in 0..steps {
        y = extrapolation::step(&slope, h * Octuple::from_f64(f64::from(k)), &y, h);
    }
    y
}

fn norm(values: impl Iterator<Item = Octuple>) -> f64 {
    values.map(|value| value.rounded().powi(2)).sum::<f64>().sqrt()
}

fn relative_distance(stated: &[f64], computed: &[Octuple]) -> f64 {
    let difference = stated.iter().zip(computed).map(|(&a, &b)| Octuple::from_f64(a) - b);
    norm(difference) / norm(computed.iter().copied())
}

fn rounded(values: &[Octuple]) -> Vec<f64> {
    values.iter().map(|value| value.rounded()).collect()
}
