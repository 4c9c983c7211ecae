//! The results as files: `results.csv`, `results.json` and the page `report.html`.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::results::Results;

const PAGE: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/style.css");
const SCRIPT: &str = include_str!("page/page.js");

/// A file that cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {cause}", path.display())]
pub(crate) struct WriteError {
    path: PathBuf,
    cause: io::Error,
}

/// Writes the three files into the folder `out`; each is replaced as a whole.
pub(crate) fn write(results: &Results, out: &Path) -> Result<Vec<PathBuf>, WriteError> {
    let json = serde_json::to_string(results).expect("numbers that are finite, and strings");
    [("results.csv", csv(results)), ("report.html", page(&json)), ("results.json", json)]
        .into_iter()
        .map(|(name, text)| replace(&out.join(name), &text))
        .collect()
}

/// Makes the folder and checks that files can be written into it.
pub(crate) fn prepare(out: &Path) -> Result<(), WriteError> {
    let trial = out.join(".writable");
    fs::create_dir_all(out)
        .and_then(|()| fs::write(&trial, ""))
        .and_then(|()| fs::remove_file(&trial))
        .map_err(|cause| WriteError { path: out.into(), cause })
}

fn replace(path: &Path, text: &str) -> Result<PathBuf, WriteError> {
    let new = path.with_extension("new");
    fs::write(&new, text)
        .and_then(|()| fs::rename(&new, path))
        .map_err(|cause| WriteError { path: path.into(), cause })?;
    Ok(path.into())
}

fn csv(results: &Results) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in &results.rows {
        writer.serialize(row).expect("a row of plain cells");
    }
    String::from_utf8(writer.into_inner().expect("a buffer in memory")).expect("text")
}

/// One file that opens without a network: style, program and data are in it.
fn page(json: &str) -> String {
    // The only text that ends a script element.
    let data = json.replace("</", "<\\/");
    PAGE.replace("/*STYLE*/", STYLE).replace("/*DATA*/", &data).replace("/*SCRIPT*/", SCRIPT)
}
