//! How fast do small deviations of chaotic motions grow?
//!
//! In: nothing but a folder and a time. Out: the Lyapunov spectra of Hénon and Heiles' star and of the double pendulum, in a table that shows how they
//! settle, and as a figure. Exponents of a Hamiltonian motion come in pairs of opposite sign, two of them are zero; their sum, measured with the volume of
//! Liouville on the constraint manifold, is zero to the round-off of a step over its size.

#[path = "../plot/mod.rs"]
mod plot;

use std::error::Error;
use std::path::PathBuf;

use clap::Parser;
use evi_core::prelude::*;
use evi_core::sensitivity::{DerivativeError, Differentiable, LyapunovRun};
use evi_examples::{DoublePendulum, HenonHeiles, Start};

use plot::{Curve, Mark, Panel};

/// Lyapunov spectra of two chaotic motions.
#[derive(Parser)]
struct Options {
    /// Folder for the figure.
    #[arg(long, value_name = "DIR", default_value = "target/lyapunov")]
    out: PathBuf,
    /// Length of the runs, in units of a hundred times of the scene.
    #[arg(long, value_name = "N", default_value_t = 40)]
    hundreds: u32,
}

/// The exponents at a time.
struct Row {
    time: f64,
    exponents: [f64; 4],
    liouville_rate: f64,
}

/// Steps between two orthonormalizations.
const EVERY: u64 = 10;

/// The exponents of a motion at times that grow by tenths of a power of two.
fn spectrum<S, F, const N: usize>(
    simulation: &Simulation<S, F>,
    start: Start<N>,
    time: f64,
) -> Result<Vec<Row>, DerivativeError>
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S, Step: Differentiable<S>>,
{
    let mut run = LyapunovRun::new(simulation, start.q, start.v, 4, EVERY)?;
    let mut rows = Vec::new();
    let mut next = 10.0;
    while next < 1.001 * time {
        run.advance_to(next)?;
        let found = run.exponents();
        let exponents = core::array::from_fn(|k| found[k]);
        let liouville_rate = run.liouville_rate().unwrap_or(f64::NAN);
        rows.push(Row { time: run.state().t(), exponents, liouville_rate });
        next *= 2.0_f64.powf(0.1);
    }
    Ok(rows)
}

fn print(title: &str, h: f64, rows: &[Row]) {
    println!("{title}, h = {h}\n");
    println!("        t      λ₁       λ₂       λ₃       λ₄     sum by Liouville's volume, in ε/h");
    let powers_of_two = rows.iter().rev().step_by(10).collect::<Vec<_>>();
    for Row { time, exponents: [a, b, c, d], liouville_rate } in powers_of_two.into_iter().rev() {
        let roundings = liouville_rate / (f64::EPSILON / h);
        println!("{time:9.0} {a:8.4} {b:8.4} {c:8.4} {d:8.4}   {liouville_rate:10.1e} {roundings:8.3}");
    }
    println!();
}

fn panel(title: &'static str, rows: &[Row]) -> Panel {
    const LABELS: [&str; 4] = ["λ₁", "λ₂", "λ₃", "λ₄"];
    let curve = |k: usize| Curve {
        label: Some(LABELS[k]),
        colour: k,
        mark: Mark::Line,
        points: rows.iter().map(|row| (row.time.log10(), row.exponents[k])).collect(),
    };
    Panel {
        title,
        x_label: "log₁₀ of the time",
        y_label: "mean rate of growth up to then",
        is_to_scale: false,
        curves: (0..4).map(curve).collect(),
    }
}

/// Across the axis at `y` with the energy ⅙, at which the motions of Hénon and Heiles can just escape: chaotic almost everywhere.
fn at_escape(y: f64, rate: f64) -> Start<2> {
    let potential = 0.5 * y * y - y.powi(3) / 3.0;
    let squared = 2.0 * (1.0 / 6.0 - potential) - rate * rate;
    Start { q: [0.0, y], v: [squared.sqrt(), rate] }
}

fn main() -> Result<(), Box<dyn Error>> {
    let Options { out, hundreds } = Options::parse();
    let time = 100.0 * f64::from(hundreds);
    std::fs::create_dir_all(&out).map_err(|error| format!("cannot create {}: {error}", out.display()))?;

    let h = 0.05;
    let star = Simulation::new(HenonHeiles::STANDARD, Evi::trapezoid(h));
    let star = spectrum(&star, at_escape(-0.1, 0.1), time)?;
    print("Hénon and Heiles' star at the energy of escape", h, &star);

    let h = 0.01;
    let system = DoublePendulum::UNIT;
    let pendulum = Simulation::new(system, Evi::midpoint(h));
    let pendulum = spectrum(&pendulum, system.horizontal(), time)?;
    print("Double pendulum from the horizontal, with constraints", h, &pendulum);

    let path = out.join("lyapunov.svg");
    plot::draw(&path, &[panel("Hénon and Heiles, E = 1/6", &star), panel("Double pendulum", &pendulum)])?;
    println!("wrote {}", path.display());
    Ok(())
}
