//! Which method reaches which accuracy in which time, on every scene of the gallery.
//!
//! `cargo run --release --example report`. Out: a table on the terminal, and in the folder `--out` the files `report.html` (opens offline),
//! `results.csv` and `results.json`. A measurement that is interrupted goes on where it stopped when it is called again. Errors are
//! distances from the end of each scene's standard motion, known as `examples/gallery` says; times are medians, in process, warm, on one
//! thread, without the preparation of a run.

mod files;
mod journal;
mod orders;
mod results;
mod speedup;
mod sweep;
mod terminal;
mod verdicts;

use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;

use evi_benches::comparison::scenes::{self, AnyScene};
use evi_benches::program::machine::Machine;
use evi_benches::program::progress::Ending;
use evi_benches::program::{self, check_names, is_chosen};

use journal::Journal;
use results::{Results, Row};
use sweep::{Plan, Thoroughness};

/// Error against run time, every method on every scene.
#[derive(Parser)]
struct Options {
    /// Only these scenes, such as double_pendulum.
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    scene: Vec<String>,
    /// Only these methods, such as midpoint.
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    method: Vec<String>,
    /// Time for the whole measurement.
    #[arg(long, value_name = "SECONDS")]
    time_budget: Option<u64>,
    /// Few step sizes and few repetitions: figures for a first look.
    #[arg(long)]
    quick: bool,
    /// Folder for the results, made if it is missing.
    #[arg(long, value_name = "DIR", default_value = "target/report")]
    out: PathBuf,
    /// Runs solvers outside of this program too, where they are installed.
    #[arg(long)]
    peers: bool,
    /// Takes steps of a method on a scene and nothing else: what this program runs under valgrind.
    #[arg(long, num_args = 4, value_names = ["SCENE", "METHOD", "H", "STEPS"], hide = true)]
    counted: Option<Vec<String>>,
}

fn main() -> ExitCode {
    let options = Options::parse();
    program::on_a_large_stack(|| measured(options))
}

fn measured(options: Options) -> ExitCode {
    match run(options) {
        Ok(Ending::Complete) => ExitCode::SUCCESS,
        Ok(Ending::Interrupted) => ExitCode::from(130),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(options: Options) -> Result<Ending, Box<dyn Error>> {
    let scenes = chosen_scenes(&options.scene)?;
    if let Some(counted) = options.counted {
        let scene = chosen_scenes(&counted[..1])?.remove(0);
        println!("{:?}", speedup::take_steps(&*scene, &counted[1], counted[2].parse()?, counted[3].parse()?));
        return Ok(Ending::Complete);
    }
    let methods = chosen_methods(&*scenes[0], &options.method)?;
    let thoroughness = Thoroughness::new(options.quick, options.peers);
    let budget = options.time_budget.map_or(thoroughness.standard_budget(), Duration::from_secs);
    program::files::prepare(&options.out)?;
    let mut journal = Journal::open(&options.out, options.quick, Machine::present())?;
    let plan = Plan { scenes: &scenes, methods: &methods };
    let ending = sweep::run(&plan, thoroughness, budget, &mut journal)?;

    let results = gather(&plan, options.quick, &journal);
    terminal::print(&results);
    println!();
    for path in files::write(&results, &options.out)? {
        println!("wrote {}", path.display());
    }
    match ending {
        Ending::Complete => {
            check_coverage(&results)?;
            journal.remove()?;
        }
        Ending::Interrupted => println!("interrupted: the same command goes on from here"),
    }
    Ok(ending)
}

fn chosen_scenes(names: &[String]) -> Result<Vec<Box<dyn AnyScene>>, String> {
    let all = scenes::all();
    check_names("scene", names, &all.iter().map(|scene| scene.facts().name).collect::<Vec<_>>())?;
    Ok(all.into_iter().filter(|scene| is_chosen(scene.facts().name, names)).collect())
}

/// Numbers of the methods, the same for every scene.
fn chosen_methods(scene: &dyn AnyScene, names: &[String]) -> Result<Vec<usize>, String> {
    let all: Vec<&str> = scene.methods().iter().map(|method| method.name).collect();
    check_names("method", names, &all)?;
    Ok((0..all.len()).filter(|&method| is_chosen(all[method], names)).collect())
}

fn gather(plan: &Plan<'_>, quick: bool, journal: &Journal) -> Results {
    let facts = plan.scenes[0].methods();
    let methods: Vec<results::Method> = plan.methods.iter().map(|&method| facts[method].into()).collect();
    let scenes: Vec<results::Scene> = plan.scenes.iter().map(|scene| scene.facts().into()).collect();
    let wanted = |name: &str| scenes.iter().any(|scene| scene.name == name);
    let finished = || journal.finished.iter();
    let rows: Vec<Row> = finished()
        .flat_map(|piece| &piece.rows)
        .filter(|row| wanted(&row.scene) && methods.iter().any(|method| method.name == row.method))
        .cloned()
        .collect();
    let mut orders = Vec::new();
    for scene in &scenes {
        for method in &methods {
            let rows: Vec<&Row> =
                rows.iter().filter(|row| row.scene == scene.name && row.method == method.name).collect();
            orders.extend(orders::fit(&rows, scene.size));
        }
    }
    Results {
        verdicts: scenes.iter().map(|scene| verdicts::on(scene.name, &rows, &methods)).collect(),
        machine: journal.machine().clone(),
        quick,
        errors: verdicts::ERRORS,
        orders,
        speedups: finished().flat_map(|piece| piece.speedups.clone()).collect(),
        long_runs: finished().filter_map(|piece| piece.long_run.clone()).collect(),
        scenes,
        methods,
        rows,
    }
}

/// Every method on every scene has a row with numbers or with the reason why it has none.
fn check_coverage(results: &Results) -> Result<(), String> {
    for scene in &results.scenes {
        for method in &results.methods {
            let is_there = |row: &&Row| row.scene == scene.name && row.method == method.name;
            let row = results.rows.iter().find(is_there);
            if !row.is_some_and(|row| row.seconds.is_some() || row.status != "ok") {
                return Err(format!("the results lack {} on {}", method.name, scene.name));
            }
        }
    }
    Ok(())
}
