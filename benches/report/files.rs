//! The results as files: `results.csv`, `results.json` and the page `report.html`.

use std::path::{Path, PathBuf};

use evi_benches::program::files::{WriteError, csv, page, replace};

use crate::results::Results;

const PAGE: &str = include_str!("page/page.html");
const SCRIPT: &str = include_str!("page/page.js");

/// Writes the three files into the folder `out`; each is replaced as a whole.
pub(crate) fn write(results: &Results, out: &Path) -> Result<Vec<PathBuf>, WriteError> {
    let json = serde_json::to_string(results).expect("numbers that are finite, and strings");
    [
        ("results.csv", csv(&results.rows)),
        ("report.html", page(PAGE, "", SCRIPT, &json)),
        ("results.json", json),
    ]
    .into_iter()
    .map(|(name, text)| replace(&out.join(name), &text))
    .collect()
}
