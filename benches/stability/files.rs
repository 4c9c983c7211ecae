//! The rows as files: `stability.csv` and the page `stability.html`.

use std::path::{Path, PathBuf};

use serde::Serialize;

use evi_benches::program::files::{WriteError, csv, page, replace};
use evi_benches::program::machine::Machine;

use crate::cases;
use crate::rows::Row;
use crate::series::Series;
use crate::theory::Figure;

const PAGE: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/style.css");
const SCRIPT: &str = concat!(include_str!("page/page.js"), include_str!("page/long_runs.js"));

/// A row as columns.
#[derive(Serialize)]
struct Record {
    case: String,
    parameter: String,
    method: String,
    verdict: String,
    first_step: Option<u64>,
    h: Option<f64>,
    steps: u64,
    energy_error: Option<f64>,
    slope_per_step: Option<f64>,
    slope_half_width: Option<f64>,
    constraint_error: Option<f64>,
    hidden_constraint_error: Option<f64>,
    momentum_error: Option<f64>,
    checked_steps: u64,
    /// Of so many of them the equations of the action, too.
    checked_actions: u64,
    /// Largest residual of a checked step, in roundings.
    check_roundings: f64,
    check_step: u64,
    check_equation: String,
    theory: String,
    agrees: bool,
    figures: String,
    reason: String,
    faults: String,
    seconds: f64,
}

impl From<&Row> for Record {
    fn from(row: &Row) -> Self {
        let finding = &row.finding;
        let verdict = &finding.verdict;
        let slope = verdict.slope();
        let texts: Vec<String> = finding.figures.iter().map(Figure::text).collect();
        Self {
            case: row.case.into(),
            parameter: row.parameter.clone(),
            method: row.method.into(),
            verdict: verdict.kind().name().into(),
            first_step: verdict.first_step(),
            h: finding.h.is_finite().then_some(finding.h),
            steps: finding.steps,
            energy_error: verdict.excursion(),
            slope_per_step: slope.map(|slope| slope.per_step),
            slope_half_width: slope.map(|slope| slope.half_width),
            constraint_error: finding.constraint_error,
            hidden_constraint_error: finding.hidden_constraint_error,
            momentum_error: finding.momentum_error,
            checked_steps: finding.check.steps,
            checked_actions: finding.check.actions,
            check_roundings: finding.check.worst,
            check_step: finding.check.worst_step,
            check_equation: finding.check.equation.into(),
            theory: finding.theory.as_ref().map_or(String::new(), |theory| theory.sentence.clone()),
            agrees: finding.faults.is_empty(),
            figures: texts.join("; "),
            reason: verdict.reason().or(finding.remark.as_deref()).unwrap_or_default().into(),
            faults: finding.faults.join("; "),
            seconds: row.seconds,
        }
    }
}

#[derive(Serialize)]
struct Data<'a> {
    machine: Machine,
    quick: bool,
    cases: Vec<Summary>,
    rows: Vec<Record>,
    long_runs: Vec<LongRun<'a>>,
}

/// A run that a figure shows.
#[derive(Serialize)]
struct LongRun<'a> {
    parameter: &'a str,
    method: &'static str,
    series: &'a Series,
}

#[derive(Serialize)]
struct Summary {
    name: &'static str,
    summary: &'static str,
}

impl<'a> LongRun<'a> {
    fn of(row: &'a Row) -> Option<Self> {
        let Row { parameter, method, finding, .. } = row;
        finding.series.as_ref().map(|series| Self { parameter, method, series })
    }
}

/// Writes both files into the folder `out`; each is replaced as a whole.
pub(crate) fn write(rows: &[Row], quick: bool, out: &Path) -> Result<Vec<PathBuf>, WriteError> {
    let cases = cases::ALL.iter().map(|case| Summary { name: case.name, summary: case.summary }).collect();
    let records = || rows.iter().map(Record::from);
    let long_runs = rows.iter().filter_map(LongRun::of).collect();
    let data = Data { machine: Machine::present(), quick, cases, rows: records().collect(), long_runs };
    let json = serde_json::to_string(&data).expect("numbers and strings");
    [("stability.csv", csv(records())), ("stability.html", page(PAGE, STYLE, SCRIPT, &json))]
        .into_iter()
        .map(|(name, text)| replace(&out.join(name), &text))
        .collect()
}
