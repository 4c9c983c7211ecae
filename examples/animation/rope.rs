//! A rope of 1,000 links, hung at both ends and let go from a curve that is not its rest.

use std::convert::Infallible;
use std::error::Error;
use std::ops::ControlFlow;

use evi_core::assembled::{AssembledRun, AssembledSimulation};
use evi_core::prelude::*;
use evi_core::watch::every;
use evi_examples::GRAVITY;
use indicatif::{ProgressBar, ProgressStyle};

use crate::svg::{Line, animation};

/// Joints between the links.
const N: usize = 999;

/// Equal point masses on equal rods between two hooks, y upwards; SI units.
#[derive(MechanicalSystem, Clone, Debug)]
#[evi(
    coordinates(p: [N, 2]),
    kinetic = 0.5 * m * sum(0..N, |i| der(p[i]).norm_squared()),
    potential = m * g * sum(0..N, |i| p[i][1]),
    constraint(first: p[0].norm_squared() == l.powi(2)),
    constraint(link[i in 1..N]: (p[i] - p[i - 1]).norm_squared() == l.powi(2)),
    constraint(last: (p[N - 1] - hook).norm_squared() == l.powi(2)),
)]
struct Rope {
    /// Mass of every joint.
    m: f64,
    /// Length of every link.
    l: f64,
    /// The second hook; the first is at the origin.
    hook: [f64; 2],
    /// Gravitational acceleration.
    g: f64,
}

const LENGTH: f64 = 3.0;
const H: f64 = 5e-4;
const SECONDS: f64 = 6.0;
const STEPS_PER_FRAME: u64 = 60;
/// Of the joints, those that are drawn.
const DRAWN: usize = 9;

/// The rope from second to second.
pub(crate) fn animated() -> Result<String, Box<dyn Error>> {
    let l = LENGTH / (N + 1) as f64;
    // The links turn from steeply downwards to upwards, faster at the end: the rope sags on the left.
    let slope = |k: usize| -1.4 + 2.6 * (k as f64 / N as f64).powf(1.7);
    let mut place = [0.0; 2];
    let ends = (0..=N).map(|k| {
        place = [place[0] + l * slope(k).cos(), place[1] + l * slope(k).sin()];
        place
    });
    let mut joints: Vec<[f64; 2]> = ends.collect();
    let hook = joints.pop().unwrap_or_default();
    let rope = Rope { m: 0.3 / N as f64, l, hook, g: GRAVITY };
    let simulation = AssembledSimulation::new(rope, Evi::midpoint(H).rescued::<6>());
    let mut run = simulation.start(joints.concat(), vec![0.0; 2 * N])?;
    print!("{}", run.report());
    let energy = run.energy();
    let drawn = |q: &[f64]| {
        let joints = q.chunks_exact(2).map(|place| [place[0], place[1]]).step_by(DRAWN);
        [[0.0; 2]].into_iter().chain(joints).chain([hook]).collect::<Vec<[f64; 2]>>()
    };
    let mut frames = vec![drawn(run.state().q())];
    let style = ProgressStyle::with_template("{bar:30} {pos} of {len} steps, about {eta} left")?;
    let bar = ProgressBar::new(run.steps_to(SECONDS)?).with_style(style);
    let mut draw = every(STEPS_PER_FRAME, |run: &AssembledRun<Rope, _>| -> ControlFlow<Infallible> {
        frames.push(drawn(run.state().q()));
        bar.set_position(run.steps());
        ControlFlow::Continue(())
    });
    run.advance_observed(SECONDS, &mut draw)?;
    bar.finish_and_clear();
    println!(
        "rope: {} steps to t = {SECONDS} s, energy off by {:+.1e} J, constraints by {:.1e} m²",
        run.steps(),
        run.energy() - energy,
        run.constraint_error()
    );
    let lines = [Line { class: "body", frames }];
    Ok(animation("A rope of 1,000 links, hung at both ends, let go", &lines, SECONDS))
}
