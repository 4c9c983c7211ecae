//! Which masses and lengths has this double pendulum?
//!
//! In: 200 samples of both bobs, with noise, of a pendulum that a known force pushes (without one only the ratio of the masses shows in a motion). Out: the four
//! parameters that fit them best, with standard errors, and a figure. The misfit is a function of a run; its gradient comes from going back over the steps once,
//! whatever the number of parameters is, and an optimizer of the crate argmin does the rest. The standard errors come from the derivatives of the samples by the
//! parameters, forward.

#[path = "../plot/mod.rs"]
mod plot;

mod pendulum;

use std::error::Error;
use std::path::PathBuf;

use argmin::core::{Executor, State as _};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use clap::Parser;
use evi_core::sensitivity::Objective;

use pendulum::{Fit, NAMES, TRUTH, noisy_samples, paths, standard_errors};
use plot::{Curve, Mark, Panel};

/// Masses and lengths of a double pendulum from noisy samples of its motion.
#[derive(Parser)]
struct Options {
    /// Folder for the figure.
    #[arg(long, value_name = "DIR", default_value = "target/identification")]
    out: PathBuf,
    /// Standard deviation of the noise, m.
    #[arg(long, value_name = "SIGMA", default_value_t = 0.01)]
    noise: f64,
    /// Seed of the noise.
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let Options { out, noise, seed } = Options::parse();
    std::fs::create_dir_all(&out).map_err(|error| format!("cannot create {}: {error}", out.display()))?;
    let samples = noisy_samples(noise, seed)?;
    let objective = Objective(Fit { samples: samples.clone() });

    let guess = [1.0; 4];
    let solver =
        LBFGS::new(MoreThuenteLineSearch::new(), 4).with_tolerance_grad(1e-8)?.with_tolerance_cost(1e-16)?;
    let logarithms = guess.iter().map(|x: &f64| x.ln()).collect();
    let found =
        Executor::new(objective, solver).configure(|state| state.param(logarithms).max_iters(100)).run()?;
    let state = found.state();
    let best = state.get_best_param().ok_or("the optimizer found nothing")?;
    let fitted: [f64; 4] = core::array::from_fn(|k| best[k].exp());
    let errors = standard_errors(&fitted, noise)?;

    println!("{} samples of two bobs, noise {noise} m; {} iterations", samples.len(), state.get_iter());
    let misfit = (0.5 * state.get_best_cost()).sqrt();
    println!("root of the mean square between samples and motion: {misfit:.5} m\n");
    println!("          guess       found    standard error    truth    off by errors");
    for k in 0..4 {
        let off = (fitted[k] - TRUTH[k]) / errors[k];
        println!(
            "{:>4} {:10.3} {:11.5} {:17.5} {:8.3} {off:16.2}",
            NAMES[k], guess[k], fitted[k], errors[k], TRUTH[k]
        );
    }

    let coordinate =
        |index: usize, title: &'static str, y_label: &'static str| -> Result<Panel, Box<dyn Error>> {
            let line = |label, colour, parameters: &[f64; 4]| -> Result<Curve, Box<dyn Error>> {
                let points = paths(parameters)?.into_iter().map(|(t, q)| (t, q[index])).collect();
                Ok(Curve { label: Some(label), colour, mark: Mark::Line, points })
            };
            let dots = samples.iter().map(|sample| (sample.t, sample.q[index])).collect();
            Ok(Panel {
                title,
                x_label: "time [s]",
                y_label,
                is_to_scale: false,
                curves: vec![
                    line("guess", 5, &guess)?,
                    line("found", 1, &fitted)?,
                    Curve { label: Some("samples"), colour: 0, mark: Mark::Dots, points: dots },
                ],
            })
        };
    let panels = [coordinate(0, "Inner bob", "x₁ [m]")?, coordinate(2, "Outer bob", "x₂ [m]")?];
    let path = out.join("identification.svg");
    plot::draw(&path, &panels)?;
    println!("\nwrote {}", path.display());
    Ok(())
}
