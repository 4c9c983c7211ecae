//! The heavy top of the gallery: a cone that spins on its tip, nods and precesses. Its configuration is the three directors of the body.

use std::error::Error;
use std::f64::consts::TAU;

use evi_core::prelude::*;
use evi_examples::HeavyTop;

use crate::svg::{Line, animation};

const HEIGHT: f64 = 0.1;
const RADIUS: f64 = 0.05;
const H: f64 = 0.004;
const STEPS: usize = 500;
const STEPS_PER_FRAME: usize = 2;
/// The eye does not follow a spin of twenty turns per second.
const SLOWER: f64 = 5.0;

/// The cone and the way of its axis, seen from the side and a little from above.
pub(crate) fn animated() -> Result<String, Box<dyn Error>> {
    let top = HeavyTop::cone(0.7, HEIGHT, RADIUS);
    let start = top.tilted(120.0);
    let mut run = Simulation::new(top, Galerkin::<8>::new(H)).start(start.q, start.v)?;
    let energy = run.energy();
    let mut places = vec![*run.state().q()];
    for _ in 0..STEPS {
        places.push(*run.advance()?.q());
    }
    let of_every =
        |line: fn(&[f64; 9]) -> Vec<[f64; 2]>| places.iter().step_by(STEPS_PER_FRAME).map(line).collect();
    let trail = places.iter().map(|place| seen(at(place, 0.0, 0.0, 1.0))).collect();
    let vertical = vec![vec![seen([0.0; 3]), seen([0.0, 0.0, HEIGHT])]];
    let lines = [
        Line { class: "frame", frames: vertical },
        Line { class: "trail", frames: vec![trail] },
        Line { class: "solid", frames: of_every(rim) },
        Line { class: "body", frames: of_every(marks) },
    ];
    let drift = run.energy() - energy;
    println!(
        "heavy top: {} steps to t = {:.1} s, energy off by {drift:+.1e} J",
        run.steps(),
        run.state().t()
    );
    Ok(animation("A cone that spins on its tip, nods and precesses", &lines, SLOWER * run.state().t()))
}

/// The point `radius · (cos φ d₁ + sin φ d₂) + height · d₃`, in units of the cone.
fn at(directors: &[f64; 9], radius: f64, angle: f64, height: f64) -> [f64; 3] {
    let [along1, along2, along3] =
        [RADIUS * radius * angle.cos(), RADIUS * radius * angle.sin(), HEIGHT * height];
    core::array::from_fn(|i| along1 * directors[i] + along2 * directors[3 + i] + along3 * directors[6 + i])
}

/// The rim of the base.
fn rim(directors: &[f64; 9]) -> Vec<[f64; 2]> {
    (0..=36).map(|k| seen(at(directors, 1.0, TAU * f64::from(k) / 36.0, 1.0))).collect()
}

/// From the tip to three points of the rim: what shows the spin.
fn marks(directors: &[f64; 9]) -> Vec<[f64; 2]> {
    let ends = |k: i32| [seen([0.0; 3]), seen(at(directors, 1.0, TAU * f64::from(k) / 3.0, 1.0))];
    (0..3).flat_map(ends).chain([seen([0.0; 3])]).collect()
}

/// Parallel projection along a direction 20° below the horizontal.
fn seen([x, y, z]: [f64; 3]) -> [f64; 2] {
    const TILT: f64 = 20.0 * TAU / 360.0;
    [x, z * TILT.cos() + y * TILT.sin()]
}
