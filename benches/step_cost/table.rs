//! Costs as text.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::measure::Cost;

const HEADER: &str =
    "scene,path,ns_per_step,ns_spread,instructions_per_step,newton_iterations,max_constraint_error";

/// An aligned table with ratios to the step written by hand, and below it the factors between the specialised and the generic
/// path.
pub(crate) fn of(costs: &[Cost]) -> String {
    let mut table = format!(
        "{:<22} {:<22} {:>9} {:>7} {:>6} {:>13} {:>6} {:>7} {:>9}\n",
        "scene", "path", "ns/step", "± ns", "/hand", "instructions", "/hand", "Newton", "|φ|"
    );
    let mut scene = "";
    for cost in costs {
        if scene != cost.scene {
            scene = cost.scene;
            table.push('\n');
        }
        let hand = find(costs, scene, "hand");
        let ratio_of = |quantity: fn(&Cost) -> Option<f64>| Some(quantity(cost)? / quantity(hand?)?);
        table.push_str(&format!(
            "{:<22} {:<22} {:>9.1} {:>7.1} {:>6} {:>13} {:>6} {:>7} {:>9}\n",
            cost.scene,
            cost.path,
            cost.nanoseconds,
            cost.spread,
            or_empty(ratio_of(|cost| Some(cost.nanoseconds)), |ratio| format!("{ratio:.2}")),
            cost.instructions.map_or("no valgrind".to_owned(), |count| format!("{count:.0}")),
            or_empty(ratio_of(|cost| cost.instructions), |ratio| format!("{ratio:.2}")),
            format!("{:.2}", cost.observed.mean_corrections),
            or_empty(cost.observed.max_constraint_error, |error| format!("{error:.1e}")),
        ));
    }
    table.push('\n');
    for specialised in costs.iter().filter(|cost| cost.path == "specialised") {
        let Some(generic) = find(costs, specialised.scene, "generic") else { continue };
        let factor = generic.nanoseconds / specialised.nanoseconds;
        table.push_str(&format!(
            "{}: the specialised step is {factor:.0} times as fast as the generic one",
            specialised.scene
        ));
        if let (Some(generic), Some(specialised)) = (generic.instructions, specialised.instructions) {
            table.push_str(&format!(" and executes 1/{:.0} of its instructions", generic / specialised));
        }
        table.push('\n');
    }
    table
}

fn find<'c>(costs: &'c [Cost], scene: &str, path: &str) -> Option<&'c Cost> {
    costs.iter().find(|cost| cost.scene == scene && cost.path == path)
}

fn or_empty(value: Option<f64>, text: impl Fn(f64) -> String) -> String {
    value.map_or(String::new(), text)
}

/// A file for the rows of the standard paths.
pub(crate) struct Csv {
    path: PathBuf,
    file: File,
}

/// Opens `step_cost.csv` in the folder `out`, which is made if it is missing.
pub(crate) fn create_csv(out: &Path) -> Result<Csv, String> {
    fs::create_dir_all(out).map_err(|error| format!("cannot create {}: {error}", out.display()))?;
    let path = out.join("step_cost.csv");
    let file = File::create(&path).map_err(|error| format!("cannot write {}: {error}", path.display()))?;
    Ok(Csv { path, file })
}

impl Csv {
    /// Writes a row for every scene and standard path; cells that were not measured or do not apply are empty.
    pub(crate) fn write(mut self, costs: &[Cost]) -> Result<PathBuf, String> {
        self.rows(costs).map_err(|error| format!("cannot write {}: {error}", self.path.display()))?;
        Ok(self.path)
    }

    fn rows(&mut self, costs: &[Cost]) -> io::Result<()> {
        writeln!(self.file, "{HEADER}")?;
        for cost in costs.iter().filter(|cost| cost.is_standard) {
            writeln!(
                self.file,
                "{},{},{:.2},{:.2},{},{:.4},{}",
                cost.scene,
                cost.path,
                cost.nanoseconds,
                cost.spread,
                or_empty(cost.instructions, |count| format!("{count:.1}")),
                cost.observed.mean_corrections,
                or_empty(cost.observed.max_constraint_error, |error| format!("{error:e}")),
            )?;
        }
        self.file.flush()
    }
}
