//! Tables of many rows, kept by columns, and the files that other programs read them from.
//!
//! In: rows of numbers under named columns. Out: comma-separated values always, Parquet with the feature `parquet`; pandas and polars read both.
//! A file is replaced as a whole or not at all.

mod csv;
#[cfg(feature = "parquet")]
mod parquet;
mod table;

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

#[cfg(feature = "parquet")]
pub use self::parquet::ParquetRows;
pub use self::table::{Column, ColumnKind, Table};

/// A table that cannot be written. The file is as it was.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ColumnsError {
    /// The file system refuses, as a full disk does.
    #[error("cannot write {}: {cause}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: io::Error,
    },
    /// The format refuses.
    #[cfg(feature = "parquet")]
    #[error("cannot write {} as Parquet: {cause}", path.display())]
    Parquet {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: ::parquet::errors::ParquetError,
    },
    /// No format has this ending.
    #[error("no format of tables ends in `{ending}`: there are {}", FORMATS.join(", "))]
    UnknownFormat {
        /// The ending.
        ending: String,
    },
}

/// Endings of the formats that there are.
const FORMATS: &[&str] = if cfg!(feature = "parquet") { &["csv", "parquet"] } else { &["csv"] };

impl Table {
    /// Replaces the file by the table, in the format of its ending: `.csv`, or `.parquet` with the feature.
    ///
    /// # Errors
    /// [`ColumnsError`]; the file is then as it was.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), ColumnsError> {
        let path = path.as_ref();
        let ending = path.extension().map_or(String::new(), |ending| ending.to_string_lossy().into_owned());
        match ending.as_str() {
            "csv" => replace(path, |out| {
                csv::write(self, out)
                    .and_then(|()| out.flush())
                    .map_err(|cause| ColumnsError::Write { path: path.into(), cause })
            }),
            #[cfg(feature = "parquet")]
            "parquet" => replace(path, |out| {
                parquet::write(self, out).map_err(|cause| ColumnsError::Parquet { path: path.into(), cause })
            }),
            _ => Err(ColumnsError::UnknownFormat { ending }),
        }
    }
}

/// Writes a new file beside the old one, and puts it in its place when it is whole.
fn replace(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<(), ColumnsError>,
) -> Result<(), ColumnsError> {
    let new = path.with_extension("new");
    let refused = |cause| ColumnsError::Write { path: path.into(), cause };
    let mut out = BufWriter::new(File::create(&new).map_err(refused)?);
    let written = write(&mut out);
    // What is left in a buffer belongs to a file that is given up.
    drop(out.into_parts());
    if let Err(error) = written {
        // The error that counts is the first one.
        let _ = fs::remove_file(&new);
        return Err(error);
    }
    fs::rename(&new, path).map_err(refused)
}
