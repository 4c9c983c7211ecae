//! Which force on a cart swings its pendulum up?
//!
//! In: nothing but a folder. Out: the force, step by step, that brings pendulum and cart from hanging at rest to standing upright at rest where they began, with
//! little effort; a table of the iterations, and a figure. All of the forces are found together, from the gradient of one number by all of them, which going back
//! over the steps gives in the time of a few runs.

#[path = "../plot/mod.rs"]
mod plot;

mod cart;

use std::error::Error;
use std::f64::consts::PI;
use std::path::PathBuf;

use argmin::core::{Executor, State as _};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use clap::Parser;
use evi_core::sensitivity::Objective;

use cart::{H, LENGTH, STEPS, SwingUp, first_guess, motion};
use plot::{Curve, Mark, Panel};

/// The force that swings a pendulum on a cart up.
#[derive(Parser)]
struct Options {
    /// Folder for the figure.
    #[arg(long, value_name = "DIR", default_value = "target/swing_up")]
    out: PathBuf,
}

fn main() -> Result<(), Box<dyn Error>> {
    let Options { out } = Options::parse();
    std::fs::create_dir_all(&out).map_err(|error| format!("cannot create {}: {error}", out.display()))?;

    // What the end costs grows from solution to solution: a steep valley is entered from a gentle one.
    let mut forces = first_guess();
    println!(
        "weight of the end   iterations      cost   angle off upright   cart [m]   rates [rad/s, m/s]   largest force [N]"
    );
    for weight in [10.0, 100.0, 1_000.0, 10_000.0] {
        let solver = LBFGS::new(MoreThuenteLineSearch::new(), 12)
            .with_tolerance_grad(1e-5)?
            .with_tolerance_cost(1e-12)?;
        let found = Executor::new(Objective(SwingUp { weight }), solver)
            .configure(|state| state.param(forces).max_iters(400))
            .run()?;
        let state = found.state();
        forces = state.get_best_param().ok_or("the optimizer found nothing")?.clone();
        let (_, [x, angle], [x_rate, angle_rate]) = *motion(&forces)?.last().ok_or("no states")?;
        let largest = forces.iter().fold(0.0, |largest: f64, force| largest.max(force.abs()));
        println!(
            "{weight:17.0} {:12} {:9.3} {:19.5} {x:10.5} {angle_rate:11.5} {x_rate:8.5} {largest:19.2}",
            state.get_iter(),
            state.get_best_cost(),
            angle - PI,
        );
    }

    let motion = motion(&forces)?;
    let line = |label, colour, points| Curve { label, colour, mark: Mark::Line, points };
    let over_time = Panel {
        title: "Motion",
        x_label: "time [s]",
        y_label: "angle [half turns], cart [m]",
        is_to_scale: false,
        curves: vec![
            line(Some("angle"), 1, motion.iter().map(|(t, q, _)| (*t, q[1] / PI)).collect()),
            line(Some("cart"), 0, motion.iter().map(|(t, q, _)| (*t, q[0])).collect()),
        ],
    };
    let steps = forces
        .iter()
        .enumerate()
        .flat_map(|(step, &force)| [(step as f64 * H, force), ((step + 1) as f64 * H, force)]);
    let force = Panel {
        title: "Force on the cart",
        x_label: "time [s]",
        y_label: "force [N]",
        is_to_scale: false,
        curves: vec![line(None, 2, steps.collect())],
    };
    let tip = |q: &[f64; 2]| (q[0] + LENGTH * q[1].sin(), -LENGTH * q[1].cos());
    let mut rods: Vec<Curve> = motion
        .iter()
        .step_by(STEPS as usize / 24)
        .map(|(_, q, _)| line(None, 5, vec![(q[0], 0.0), tip(q)]))
        .collect();
    rods.push(line(Some("bob"), 1, motion.iter().map(|(_, q, _)| tip(q)).collect()));
    let path_of_bob = Panel {
        title: "Rod every eighth of a second",
        x_label: "x [m]",
        y_label: "y [m]",
        is_to_scale: true,
        curves: rods,
    };
    let path = out.join("swing_up.svg");
    plot::draw(&path, &[over_time, force, path_of_bob])?;
    println!("\nwrote {}", path.display());
    Ok(())
}
