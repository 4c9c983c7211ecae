//! The rows on the terminal.

use crate::has_fault;
use crate::rows::Row;

/// A line per row, under its case and parameter.
pub(crate) fn print(rows: &[Row]) {
    let mut above = ("", "");
    for row in rows {
        let (case, parameter) = (row.case, row.parameter.as_str());
        if case != above.0 {
            println!("\n{}\n{case}", "─".repeat(100));
        }
        if (case, parameter) != above {
            println!("\n  {parameter}");
        }
        above = (case, parameter);
        println!("    {:<20} {}", row.method, line(row));
    }
}

/// The verdict with its numbers.
fn line(row: &Row) -> String {
    let verdict = &row.finding.verdict;
    let mut line = format!("{:<11}", verdict.kind().name());
    match verdict.first_step() {
        Some(step) => line += &format!(" {step:>8}"),
        None => line += &format!(" {:>8}", ""),
    }
    match verdict.excursion() {
        Some(excursion) => line += &format!(" {excursion:>8.1e}"),
        None => line += &format!(" {:>8}", ""),
    }
    line += &row.finding.check_text();
    for figure in &row.finding.figures {
        line += &format!("  {}", figure.text());
    }
    for text in verdict.reason().into_iter().chain(row.finding.remark.as_deref()) {
        line += &format!("  {text}");
    }
    line
}

/// The rows with faults, on the stream of errors; returns their number.
pub(crate) fn print_faults(rows: &[Row]) -> usize {
    let faulty: Vec<&Row> = rows.iter().filter(|row| has_fault(row)).collect();
    if faulty.is_empty() {
        println!("{} rows, no fault", rows.len());
        return 0;
    }
    eprintln!("\n{} of {} rows with faults:", faulty.len(), rows.len());
    for row in &faulty {
        eprintln!("  {}, {}, {}: {}", row.case, row.parameter, row.method, row.finding.faults.join("; "));
        eprintln!("      {}", line(row));
    }
    faulty.len()
}
