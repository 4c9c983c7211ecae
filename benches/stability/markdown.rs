//! The matrix of cases and methods as Markdown, with what is to say about the cells that surprise.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use evi_benches::program::files::{WriteError, replace};

use crate::cases;
use crate::rows::Row;
use crate::verdict::{Kind, Verdict};

const HEAD: &str = include_str!("matrix_head.md");
/// Paragraphs written by hand, so that writing the matrix anew keeps them.
const SURPRISES: &str = include_str!("surprises.md");

/// Writes the matrix into a file, which it replaces.
pub(crate) fn write(rows: &[Row], path: &Path) -> Result<PathBuf, WriteError> {
    replace(path, &matrix(rows))
}

fn matrix(rows: &[Row]) -> String {
    let mut text = HEAD.to_owned();
    for case in cases::ALL {
        let rows: Vec<&Row> = rows.iter().filter(|row| row.case == case.name).collect();
        if !rows.is_empty() {
            let _ = writeln!(text, "\n## {}\n\n{}.\n", case.name, capitalised(case.summary));
            table(&mut text, &rows);
        }
    }
    let _ = write!(text, "\n{SURPRISES}");
    text
}

fn table(text: &mut String, rows: &[&Row]) {
    let methods = distinct(rows.iter().map(|row| row.method));
    let parameters = distinct(rows.iter().map(|row| row.parameter.as_str()));
    let _ = writeln!(text, "| | {} |\n|---|{}", methods.join(" | "), "---|".repeat(methods.len()));
    for parameter in parameters {
        let _ = write!(text, "| {parameter} |");
        for method in &methods {
            let row = rows.iter().find(|row| row.parameter == parameter && row.method == *method);
            let _ = write!(text, " {} |", row.map_or(String::new(), |row| cell(row)));
        }
        text.push('\n');
    }
}

/// The verdict in a word, with the first step at which it shows, or the largest energy error.
fn cell(row: &Row) -> String {
    let verdict = &row.finding.verdict;
    let error = verdict.excursion().unwrap_or(f64::NAN);
    let step = verdict.first_step().unwrap_or(0);
    match (verdict, verdict.kind()) {
        (Verdict::Drifting(_), _) => format!("drifts {step}"),
        (_, Kind::Stable) => format!("{error:.0e}"),
        (_, Kind::Bounded) => format!("bounded {error:.0e}"),
        (_, Kind::Diverged) => format!("**diverges** {step}"),
        (_, Kind::NoSolution) => format!("*none* {step}"),
        _ => "refused".into(),
    }
}

fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut seen = Vec::new();
    names.for_each(|name| {
        if !seen.contains(&name) {
            seen.push(name);
        }
    });
    seen
}

fn capitalised(sentence: &str) -> String {
    let mut letters = sentence.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
