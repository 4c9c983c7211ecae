//! Checkpoints in files, whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::Path;

use evi_core::prelude::*;

/// Replaces the file by the checkpoint. Whoever reads it, even after the process or the machine went down in the middle, finds either the former or
/// this one: the new file takes the name of the old one when it is on the disk.
pub(crate) fn write(checkpoint: &Checkpoint, path: &Path) -> io::Result<()> {
    let next = path.with_extension("next");
    let mut file = BufWriter::new(File::create(&next)?);
    serde_json::to_writer(&mut file, checkpoint)?;
    file.flush()?;
    file.get_ref().sync_all()?;
    fs::rename(&next, path)
}

/// The checkpoint in the file, if there is one.
///
/// # Errors
/// [`ErrorKind::InvalidData`] for a file that holds no whole checkpoint. Whether its numbers are those that were written is found when a simulation
/// resumes it.
pub(crate) fn read(path: &Path) -> io::Result<Option<Checkpoint>> {
    match fs::read(path) {
        Ok(contents) => serde_json::from_slice(&contents).map(Some).map_err(|error| {
            let message = format!("{} is no whole checkpoint: {error}", path.display());
            io::Error::new(ErrorKind::InvalidData, message)
        }),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}
