//! Measurements as text.

use std::path::Path;

use serde::Serialize;

use crate::experiment::Measurement;

/// A row of the CSV file; its fields are the header.
#[derive(Serialize)]
struct Row {
    state: String,
    method: &'static str,
    nodes: Option<usize>,
    omega: Option<f64>,
    h: f64,
    steps: u64,
    steps_done: u64,
    max_energy_error: f64,
    max_constraint_error: f64,
    max_hidden_constraint_error: f64,
    seconds: f64,
    status: String,
}

impl From<&Measurement> for Row {
    fn from(measurement: &Measurement) -> Self {
        let case = measurement.case;
        Self {
            state: case.state.to_string(),
            method: case.method.name(),
            nodes: case.method.nodes(),
            omega: case.method.omega(),
            h: case.h,
            steps: case.steps,
            steps_done: measurement.steps_done,
            max_energy_error: measurement.max_energy_error,
            max_constraint_error: measurement.max_constraint_error,
            max_hidden_constraint_error: measurement.max_hidden_constraint_error,
            seconds: measurement.seconds,
            status: measurement.status(),
        }
    }
}

/// Writes one row per measurement; cells that do not apply are empty.
pub(crate) fn write_csv<'m>(
    path: &Path,
    measurements: impl Iterator<Item = &'m Measurement>,
) -> Result<(), csv::Error> {
    let mut writer = csv::Writer::from_path(path)?;
    for measurement in measurements {
        writer.serialize(Row::from(measurement))?;
    }
    writer.flush()?;
    Ok(())
}

/// An aligned table.
pub(crate) fn of(measurements: &[Measurement]) -> String {
    let mut table = format!(
        "{:<11} {:<16} {:>6} {:>11} {:>11} {:>11} {:>9}  {}\n",
        "start", "method", "h [s]", "|H-H0| [J]", "|phi| [m^2]", "|Gv| [rel]", "ns/step", "status"
    );
    for measurement in measurements {
        let case = measurement.case;
        table.push_str(&format!(
            "{:<11} {:<16} {:>6} {:>11.2e} {:>11.2e} {:>11.2e} {:>9.0}  {}\n",
            case.state.to_string(),
            case.method.to_string(),
            case.h,
            measurement.max_energy_error,
            measurement.max_constraint_error,
            measurement.max_hidden_constraint_error,
            1e9 * measurement.seconds / measurement.steps_done.max(1) as f64,
            measurement.status(),
        ));
    }
    table
}
