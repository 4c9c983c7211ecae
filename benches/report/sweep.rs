//! The measurement: every piece of work, within the time that there is.

use std::collections::HashSet;
use std::error::Error;
use std::time::{Duration, Instant};

use evi_core::integrator::StartError;

use evi_benches::comparison::Refusal;
use evi_benches::comparison::measure::{Effort, long_run, measure};
use evi_benches::comparison::methods::{MethodFacts, Path, Resolution};
use evi_benches::comparison::scenes::{AnyScene, SceneFacts};
use evi_benches::program::progress::{self, Ending, Interruption};

use crate::journal::{Finished, Journal, Piece};
use crate::results::{LongRun, Row};
use crate::speedup::speedups;

/// How thorough the measurement is.
#[derive(Clone, Copy)]
pub(crate) struct Thoroughness {
    pub(crate) quick: bool,
    /// Whether programs outside of this one run too.
    peers: bool,
    effort: Effort,
    /// Ratio of neighbouring numbers of steps.
    refinement: f64,
    /// Longest sweep of one method on one scene.
    longest_sweep: Duration,
    /// Longest run of a method for the long-time energy.
    longest_run: Duration,
}

impl Thoroughness {
    pub(crate) fn new(quick: bool, peers: bool) -> Self {
        if quick {
            Self {
                quick,
                peers,
                effort: Effort { samples: 3, sample_seconds: 5e-5, seconds: 5e-4 },
                refinement: 2.0,
                longest_sweep: Duration::from_millis(150),
                longest_run: Duration::from_millis(30),
            }
        } else {
            Self {
                quick,
                peers,
                effort: Effort { samples: 5, sample_seconds: 5e-4, seconds: 1e-2 },
                refinement: 2.0_f64.powf(0.25),
                longest_sweep: Duration::from_secs(6),
                longest_run: Duration::from_millis(500),
            }
        }
    }

    /// Time for a whole measurement unless the user says otherwise.
    pub(crate) fn standard_budget(self) -> Duration {
        Duration::from_secs(if self.quick { 40 } else { 720 })
    }
}

/// Methods whose energy is followed over long times: one of each kind.
const LONG_RUNS: [&str; 7] =
    ["midpoint", "midpoint_8", "galerkin_8", "gauss_8", "rk4", "dop853", "generalized_alpha"];
/// Points of a curve of long-time energy.
const WINDOWS: usize = 240;
/// The fewest steps of a sweep.
const FEWEST_STEPS: f64 = 8.0;
/// A method that does not start with so many step sizes and has not before does not start on this scene.
const REFUSALS: usize = 6;
/// Up to an error of this fraction of the configuration, steps are halved from run to run.
const COARSE: f64 = 0.1;
/// The loosest tolerance of a sweep.
const LOOSEST: f64 = 1e-2;
/// The tightest tolerance of a sweep.
const TIGHTEST: f64 = 1e-14;

/// The scenes with the numbers of the methods that are wanted.
pub(crate) struct Plan<'p> {
    pub(crate) scenes: &'p [Box<dyn AnyScene>],
    pub(crate) methods: &'p [usize],
}

impl Plan<'_> {
    /// All pieces of work, scene by scene.
    fn pieces(&self) -> Vec<(&dyn AnyScene, Option<usize>, Piece)> {
        let mut pieces = Vec::new();
        for scene in self.scenes {
            let scene = &**scene;
            let (name, all) = (scene.facts().name.to_owned(), scene.methods());
            for &method in self.methods {
                let piece = Piece::Sweep { scene: name.clone(), method: all[method].name.into() };
                pieces.push((scene, Some(method), piece));
            }
            pieces.push((scene, None, Piece::Speedup { scene: name.clone() }));
            if scene.facts().conserves_energy {
                for &method in self.methods.iter().filter(|&&method| LONG_RUNS.contains(&all[method].name)) {
                    let piece = Piece::LongRun { scene: name.clone(), method: all[method].name.into() };
                    pieces.push((scene, Some(method), piece));
                }
            }
        }
        pieces
    }
}

/// Does the pieces of work that the journal does not hold, and keeps each in it.
pub(crate) fn run(
    plan: &Plan<'_>,
    thoroughness: Thoroughness,
    budget: Duration,
    journal: &mut Journal,
) -> Result<Ending, Box<dyn Error>> {
    let interruption = Interruption::listen()?;
    let pieces = plan.pieces();
    let finished: HashSet<Piece> = journal.pieces();
    let bar = progress::bar(pieces.len() as u64);
    bar.set_position(pieces.iter().filter(|piece| finished.contains(&piece.2)).count() as u64);
    bar.reset_eta();
    let begin = Instant::now();
    let todo: Vec<_> = pieces.into_iter().filter(|piece| !finished.contains(&piece.2)).collect();
    for (index, (scene, method, piece)) in todo.iter().enumerate() {
        bar.set_message(text(piece));
        let left = budget.saturating_sub(begin.elapsed()) / (todo.len() - index) as u32;
        let work = Work { scene: *scene, thoroughness, left, interruption: &interruption };
        let mut done =
            Finished { piece: piece.clone(), rows: Vec::new(), speedups: Vec::new(), long_run: None };
        match (piece, method) {
            (Piece::Sweep { .. }, Some(method)) => done.rows = work.sweep(*method),
            (Piece::LongRun { .. }, Some(method)) => {
                done.long_run = work.long_run(*method, &rows(journal, scene.facts().name));
            }
            _ => done.speedups = speedups(*scene, &rows(journal, scene.facts().name), thoroughness.quick),
        }
        if interruption.is_wanted() {
            bar.abandon_with_message("interrupted; what is finished is kept");
            return Ok(Ending::Interrupted);
        }
        journal.keep(done)?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(Ending::Complete)
}

fn rows(journal: &Journal, scene: &str) -> Vec<Row> {
    journal.finished.iter().flat_map(|piece| &piece.rows).filter(|row| row.scene == scene).cloned().collect()
}

fn text(piece: &Piece) -> String {
    match piece {
        Piece::Sweep { scene, method } => format!("{scene}, {method}"),
        Piece::Speedup { scene } => format!("{scene}, specialised against generic"),
        Piece::LongRun { scene, method } => format!("{scene}, {method}, long run"),
    }
}

/// A piece of work on one scene.
struct Work<'w> {
    scene: &'w dyn AnyScene,
    thoroughness: Thoroughness,
    /// Time for this piece.
    left: Duration,
    interruption: &'w Interruption,
}

impl Work<'_> {
    /// Runs of one method from coarse to fine, until errors have reached round-off or the time is over.
    fn sweep(&self, method: usize) -> Vec<Row> {
        let Thoroughness { effort, refinement, longest_sweep, .. } = self.thoroughness;
        // Most methods end early: one that does not may take more than its part.
        let allowed = (2 * self.left).min(longest_sweep);
        let (scene, facts) = (self.scene.facts(), self.scene.methods()[method]);
        if facts.path == Path::Program && self.thoroughness.peers {
            return self.sweep_of_program(&scene, &facts);
        }
        let begin = Instant::now();
        let mut rows = Vec::new();
        let mut progress = Progress::new(scene.size);
        let mut predicted = Duration::ZERO;
        // How many of the next resolutions lie too near to a run that failed or was coarse.
        let mut skipped = 0;
        let to_half_the_step = (2.0_f64.ln() / refinement.ln()).round() as u32;
        for resolution in resolutions(&facts, scene.horizon, refinement) {
            if skipped > 0 {
                skipped -= 1;
                continue;
            }
            if self.interruption.is_wanted() {
                break;
            }
            if !rows.is_empty() && begin.elapsed() + predicted > allowed {
                break;
            }
            let row = Row::without_run(&scene, &facts, "ok").at(facts.resolution, resolution);
            let clock = Instant::now();
            match measure(self.scene, method, resolution, effort) {
                Ok(outcome) => {
                    rows.push(row.with(outcome));
                    // Written so that a NaN is coarse.
                    let is_fine = outcome.position_error <= COARSE * scene.size;
                    skipped = if is_fine { 0 } else { to_half_the_step - 1 };
                    if progress.has_ended(outcome.position_error) {
                        break;
                    }
                }
                Err(failure) if failure.is::<Refusal>() => {
                    return vec![Row::without_run(&scene, &facts, failure.to_string())];
                }
                // A step size that resonates with a frequency is refused, and a finer one is not.
                Err(failure) if failure.is::<StartError>() && rows.len() >= REFUSALS => {
                    return vec![Row::without_run(&scene, &facts, format!("refused: {failure}"))];
                }
                Err(failure) => {
                    rows.push(Row { status: format!("failed: {failure}"), ..row });
                    skipped = to_half_the_step - 1;
                }
            }
            predicted = clock.elapsed().mul_f64(refinement);
        }
        rows
    }

    /// Runs of a program outside of this one, all at once.
    fn sweep_of_program(&self, scene: &SceneFacts, facts: &MethodFacts) -> Vec<Row> {
        let tolerances: Vec<f64> = resolutions(facts, scene.horizon, self.thoroughness.refinement).collect();
        match self.scene.runs_of_program(&tolerances) {
            Ok(runs) => runs
                .into_iter()
                .map(|(tolerance, outcome)| {
                    Row::without_run(scene, facts, "ok").at(facts.resolution, tolerance).with(outcome)
                })
                .collect(),
            Err(failure) => vec![Row::without_run(scene, facts, failure.to_string())],
        }
    }

    /// Energy over a time much longer than the horizon, by the run of the sweep that takes about as long as the midpoint rule takes to
    /// be exact to a thousandth of the configuration.
    fn long_run(&self, method: usize, rows: &[Row]) -> Option<LongRun> {
        let (scene, facts) = (self.scene.facts(), self.scene.methods()[method]);
        let of = |name: &str| -> Vec<&Row> {
            rows.iter().filter(|row| row.method == name && row.position_error.is_some()).collect()
        };
        let midpoint = of("midpoint");
        let exact = midpoint.iter().find(|row| row.position_error <= Some(1e-3 * scene.size));
        let target = exact.or(midpoint.last())?.seconds?;
        let off = |row: &&&Row| row.seconds.map_or(f64::INFINITY, |seconds| (seconds / target).ln().abs());
        let runs = of(facts.name);
        let row = runs.iter().min_by(|a, b| off(a).total_cmp(&off(b)))?;
        let horizons = (self.thoroughness.longest_run.as_secs_f64() / target).clamp(4.0, 1000.0).floor();
        let resolution = row.h.or(row.tolerance)?;
        let run = long_run(self.scene, method, resolution, horizons * scene.horizon, WINDOWS).ok()?;
        Some(LongRun {
            scene: scene.name.into(),
            method: facts.name.into(),
            h: row.h,
            tolerance: row.tolerance,
            times: run.times,
            energy_errors: run.energy_errors,
            status: run.failure.map_or("ok".into(), |failure| format!("failed: {failure}")),
        })
    }
}

/// Step sizes that are whole fractions of the horizon, or tolerances; from coarse to fine.
fn resolutions(method: &MethodFacts, horizon: f64, refinement: f64) -> Box<dyn Iterator<Item = f64>> {
    match method.resolution {
        Resolution::StepSize => {
            let steps = (0..).map(move |level| (FEWEST_STEPS * refinement.powi(level)).round());
            Box::new(steps.map(move |steps| horizon / steps))
        }
        Resolution::Tolerance => {
            let tolerances = (0..).map(move |level| LOOSEST * refinement.powi(-2 * level));
            Box::new(tolerances.take_while(|tolerance| *tolerance >= TIGHTEST))
        }
    }
}

/// Whether errors still fall.
struct Progress {
    size: f64,
    smallest: f64,
    without_gain: u32,
}

impl Progress {
    const fn new(size: f64) -> Self {
        Self { size, smallest: f64::INFINITY, without_gain: 0 }
    }

    /// Whether round-off is reached: the error is a few roundings of the configuration, or small and no longer falling.
    fn has_ended(&mut self, error: f64) -> bool {
        self.without_gain = if error < 0.9 * self.smallest { 0 } else { self.without_gain + 1 };
        self.smallest = self.smallest.min(error);
        error < 4.0 * f64::EPSILON * self.size || (self.smallest < 1e-8 * self.size && self.without_gain >= 4)
    }
}
