//! What the derive costs a build: seconds over the same crate without it, for scenes of 2 to 60 coordinates, and in
//! loops of 20,000.
//!
//! `cargo run --release --example compile_cost -- --out DIR [--quick]`. Out: a table, and `compile_cost.csv` in DIR. A
//! throw-away crate that depends on evi-core is built again and again, with nothing but its own source to compile: without the
//! derive, with it, and with a run of `Evi::midpoint` on top, which is where the integrator is compiled for the scene. Every figure is the
//! shortest of interleaved repetitions. Last, a scene of about 10,000 statements is built without optimisation, and its
//! first step compared with that of the generic path.

mod builds;
mod scenes;

use std::error::Error;
use std::path::PathBuf;

use builds::{Bench, Profile};
use clap::Parser;
use scenes::{Content, Scene};
use serde::Serialize;

/// What the derive costs a build.
#[derive(Parser)]
struct Options {
    /// Folder for the table.
    #[arg(long, value_name = "DIR", default_value = "target/compile_cost")]
    out: PathBuf,
    /// Few scenes, once each.
    #[arg(long)]
    quick: bool,
}

/// A row of the table; its fields are the header of the CSV file. Times in seconds.
#[derive(Serialize)]
struct Row {
    scene: &'static str,
    coordinates: usize,
    constraints: usize,
    /// Of the largest kernel.
    statements: usize,
    profile: &'static str,
    /// The crate without the derive.
    bare: f64,
    /// What the derive adds.
    derive: f64,
    /// What the derive and a run add.
    derive_and_run: f64,
    /// Expanding all macros of the crate with the derive, less that of the crate without; empty where rustc does not tell.
    expansion: Option<f64>,
}

/// Coordinates of the scene with about 10,000 statements in its largest kernel.
const LARGE: usize = 46;
/// Relative difference of the momenta of two paths after one step, summed over the coordinates: round-off of sums of a thousand terms.
const AGREEMENT: f64 = 1e-12;

fn main() -> Result<(), Box<dyn Error>> {
    let Options { out, quick } = Options::parse();
    std::fs::create_dir_all(&out).map_err(|error| format!("cannot create {}: {error}", out.display()))?;
    let (repetitions, dense, sparse, looped): (usize, &[usize], &[usize], &[usize]) = if quick {
        (1, &[2], &[], &[20])
    } else {
        (3, &[2, 10, 20, 40, 60], &[2, 10, 20, 40, 60], &[20, 1_000, 10_000])
    };
    let scenes = std::iter::once(Scene::double_pendulum())
        .chain(dense.iter().map(|&n| Scene::rotators(n)))
        .chain(sparse.iter().map(|&n| Scene::chain(n)))
        .chain(looped.iter().map(|&bodies| Scene::chain_in_loops(bodies)));

    let csv = out.join("compile_cost.csv");
    let mut writer = csv::Writer::from_path(&csv)?;
    let bench = Bench::new()?;
    println!(
        "{:<16} {:>5} {:>5} {:>10}  {:<8} {:>6} {:>8} {:>8} {:>10}",
        "scene", "n", "m", "statements", "profile", "bare", "+ derive", "+ run", "expansion"
    );
    for scene in scenes {
        for profile in [Profile::Debug, Profile::Release] {
            let row = measured(&bench, &scene, profile, repetitions)?;
            print(&row);
            writer.serialize(row)?;
        }
    }
    writer.flush()?;
    println!("wrote {}", csv.display());

    let large = Scene::rotators(LARGE);
    let seconds = bench.build(Profile::Debug, &large.source(Content::Comparison))?;
    let [statements, difference] = bench.numbers(Profile::Debug)?;
    println!(
        "{} of {} coordinates, {statements} statements: built without optimisation in {seconds:.1} s; \
         first step and generic path differ by {difference:.1e}",
        large.name, large.n_coordinates
    );
    // Compared this way round, so that a NaN fails.
    let agrees = difference <= AGREEMENT;
    if !agrees {
        return Err(format!("the paths differ by {difference:e}, more than {AGREEMENT:e}").into());
    }
    Ok(())
}

fn measured(
    bench: &Bench,
    scene: &Scene,
    profile: Profile,
    repetitions: usize,
) -> Result<Row, Box<dyn Error>> {
    let contents = [Content::Bare, Content::Derive, Content::Run];
    let mut shortest = [f64::INFINITY; 3];
    let mut expansions = [f64::INFINITY; 2];
    for _ in 0..repetitions {
        for (content, shortest) in std::iter::zip(contents, &mut shortest) {
            *shortest = shortest.min(bench.build(profile, &scene.source(content))?);
        }
        for (content, shortest) in std::iter::zip(contents, &mut expansions) {
            let expansion = bench.expansion(profile, &scene.source(content))?;
            *shortest = shortest.min(expansion.unwrap_or(f64::NAN));
        }
    }
    bench.build(profile, &scene.source(Content::Run))?;
    let [statements] = bench.numbers(profile)?;
    let [bare, derive, run] = shortest;
    let expansion = expansions[1] - expansions[0];
    Ok(Row {
        scene: scene.name,
        coordinates: scene.n_coordinates,
        constraints: scene.n_constraints,
        statements: statements as usize,
        profile: profile.name(),
        bare,
        derive: derive - bare,
        derive_and_run: run - bare,
        expansion: expansion.is_finite().then_some(expansion),
    })
}

fn print(row: &Row) {
    let expansion = row.expansion.map_or("not told".to_owned(), |seconds| format!("{seconds:.3}"));
    println!(
        "{:<16} {:>5} {:>5} {:>10}  {:<8} {:>6.2} {:>8.2} {:>8.2} {:>10}",
        row.scene,
        row.coordinates,
        row.constraints,
        row.statements,
        row.profile,
        row.bare,
        row.derive,
        row.derive_and_run,
        expansion
    );
}
