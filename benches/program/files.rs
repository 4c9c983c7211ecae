//! Files that are written as a whole or not at all, and pages that open without a network.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::Serialize;

const STYLE: &str = include_str!("page/style.css");
const ELEMENTS: &str = include_str!("page/elements.js");

/// A file that cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {cause}", path.display())]
pub struct WriteError {
    path: PathBuf,
    cause: io::Error,
}

/// Makes the folder and checks that files can be written into it.
///
/// # Errors
/// [`WriteError`] where they cannot.
pub fn prepare(out: &Path) -> Result<(), WriteError> {
    let trial = out.join(".writable");
    fs::create_dir_all(out)
        .and_then(|()| fs::write(&trial, ""))
        .and_then(|()| fs::remove_file(&trial))
        .map_err(|cause| WriteError { path: out.into(), cause })
}

/// Replaces the file by `content`, at once; returns its path.
///
/// # Errors
/// [`WriteError`]; the file is then as it was.
pub fn replace(path: &Path, content: &(impl AsRef<[u8]> + ?Sized)) -> Result<PathBuf, WriteError> {
    let new = path.with_extension("new");
    fs::write(&new, content)
        .and_then(|()| fs::rename(&new, path))
        .map_err(|cause| WriteError { path: path.into(), cause })?;
    Ok(path.into())
}

/// The rows as comma-separated values, their fields as columns.
///
/// # Panics
/// For rows that are not flat.
pub fn csv<R: Serialize>(rows: impl IntoIterator<Item = R>) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row).expect("a row of plain cells");
    }
    String::from_utf8(writer.into_inner().expect("a buffer in memory")).expect("text")
}

/// One file that opens without a network: the common style and elements, `style`, `script` and the data are put in the places that `page` has
/// for them.
pub fn page(page: &str, style: &str, script: &str, json: &str) -> String {
    // The only text that ends a script element.
    let data = json.replace("</", "<\\/");
    page.replace("/*STYLE*/", &format!("{STYLE}{style}"))
        .replace("/*DATA*/", &data)
        .replace("/*SCRIPT*/", &format!("{ELEMENTS}{script}"))
}
