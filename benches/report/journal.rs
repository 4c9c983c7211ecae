//! What is finished of a measurement, on disk as soon as it is finished: an interrupted measurement goes on where it stopped.
//!
//! One line of JSON per finished piece, after a line that says by what build the measurement is made. The file goes when the
//! measurement is complete.

use std::collections::HashSet;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use evi_benches::program::machine::Machine;

use crate::results::{LongRun, Row, Speedup};

/// A piece of work.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Piece {
    /// All runs of a method on a scene.
    Sweep { scene: String, method: String },
    /// Specialised against generic path.
    Speedup { scene: String },
    /// A long run of a method on a scene.
    LongRun { scene: String, method: String },
}

/// A finished piece of work with its result.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Finished {
    pub(crate) piece: Piece,
    pub(crate) rows: Vec<Row>,
    pub(crate) speedups: Vec<Speedup>,
    pub(crate) long_run: Option<LongRun>,
}

#[derive(Serialize, Deserialize)]
struct Head {
    quick: bool,
    machine: Machine,
}

/// The file, and what it holds.
pub(crate) struct Journal {
    path: PathBuf,
    file: File,
    machine: Machine,
    pub(crate) finished: Vec<Finished>,
}

/// A journal that cannot be used. The file is as it was.
#[derive(Debug, thiserror::Error)]
pub(crate) enum JournalError {
    #[error("cannot write {}: {cause}", path.display())]
    Write { path: PathBuf, cause: io::Error },
    #[error("cannot read {}: {cause}", path.display())]
    Read { path: PathBuf, cause: io::Error },
    #[error(
        "line {line} of {} is not what an interrupted measurement leaves: {cause}. Mend or remove the file",
        path.display()
    )]
    Corrupt { path: PathBuf, line: usize, cause: serde_json::Error },
    #[error(
        "{} holds an unfinished measurement {}. Finish it as it was begun, choose another folder, or remove the file",
        path.display(),
        if *quick { "with --quick" } else { "without --quick" }
    )]
    OtherEffort { path: PathBuf, quick: bool },
    #[error(
        "{} holds an unfinished measurement by another machine or build ({machine}). Choose another folder, or remove the file",
        path.display()
    )]
    OtherBuild { path: PathBuf, machine: String },
}

impl Journal {
    /// Opens the journal in the folder `out`, with what an interrupted measurement has left in it.
    pub(crate) fn open(out: &Path, quick: bool, machine: Machine) -> Result<Self, JournalError> {
        let path = out.join("unfinished.jsonl");
        if path.exists() {
            return Self::resume(path, quick, &machine);
        }
        let cannot_write = |cause| JournalError::Write { path: path.clone(), cause };
        let mut file = File::create(&path).map_err(cannot_write)?;
        write_line(&mut file, &Head { quick, machine: machine.clone() }).map_err(cannot_write)?;
        Ok(Self { path, file, machine, finished: Vec::new() })
    }

    fn resume(path: PathBuf, quick: bool, machine: &Machine) -> Result<Self, JournalError> {
        let text =
            fs::read_to_string(&path).map_err(|cause| JournalError::Read { path: path.clone(), cause })?;
        // A line without an end was being written when the program was killed.
        let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
        let corrupt = |line, cause| JournalError::Corrupt { path: path.clone(), line, cause };
        let mut lines = whole.lines();
        let head: Head =
            serde_json::from_str(lines.next().unwrap_or_default()).map_err(|cause| corrupt(1, cause))?;
        if head.quick != quick {
            return Err(JournalError::OtherEffort { path, quick: head.quick });
        }
        if !head.machine.is_like(machine) {
            return Err(JournalError::OtherBuild { path, machine: head.machine.line() });
        }
        let finished = lines
            .enumerate()
            .map(|(index, line)| serde_json::from_str(line).map_err(|cause| corrupt(index + 2, cause)))
            .collect::<Result<_, _>>()?;
        let cannot_write = |cause| JournalError::Write { path: path.clone(), cause };
        let file = OpenOptions::new().append(true).open(&path).map_err(cannot_write)?;
        file.set_len(whole.len() as u64).map_err(cannot_write)?;
        Ok(Self { path, file, machine: head.machine, finished })
    }

    /// With what the measurement was begun.
    pub(crate) const fn machine(&self) -> &Machine {
        &self.machine
    }

    /// The pieces that are finished.
    pub(crate) fn pieces(&self) -> HashSet<Piece> {
        self.finished.iter().map(|finished| finished.piece.clone()).collect()
    }

    /// Keeps a finished piece.
    pub(crate) fn keep(&mut self, finished: Finished) -> Result<(), JournalError> {
        write_line(&mut self.file, &finished)
            .map_err(|cause| JournalError::Write { path: self.path.clone(), cause })?;
        self.finished.push(finished);
        Ok(())
    }

    /// Removes the file: the measurement is complete and its results are written.
    pub(crate) fn remove(self) -> Result<(), JournalError> {
        fs::remove_file(&self.path).map_err(|cause| JournalError::Write { path: self.path, cause })
    }
}

fn write_line(file: &mut File, value: &impl Serialize) -> io::Result<()> {
    let mut line = serde_json::to_string(value)?;
    line.push('\n');
    // In one call, so that a killed program leaves a whole line or a torn last one.
    file.write_all(line.as_bytes())?;
    file.flush()
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::PathBuf;

    use super::{Finished, Journal, JournalError, Piece};
    use evi_benches::program::machine::Machine;

    fn folder(name: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("evi_journal_{name}_{}", std::process::id()));
        fs::create_dir_all(&path).expect("a folder for temporary files");
        path
    }

    fn finished(scene: &str) -> Finished {
        let piece = Piece::Speedup { scene: scene.into() };
        Finished { piece, rows: Vec::new(), speedups: Vec::new(), long_run: None }
    }

    /// A journal with two finished pieces, closed.
    fn written(name: &str) -> PathBuf {
        let folder = folder(name);
        let mut journal = Journal::open(&folder, true, Machine::present()).expect("a new journal");
        journal.keep(finished("top")).expect("space");
        journal.keep(finished("chain")).expect("space");
        folder
    }

    #[test]
    fn what_is_finished_is_there_again() {
        let folder = written("again");
        let journal = Journal::open(&folder, true, Machine::present()).expect("the same measurement");
        assert_eq!(journal.pieces().len(), 2);
        journal.remove().expect("the file");
        assert!(Journal::open(&folder, true, Machine::present()).expect("new").finished.is_empty());
        fs::remove_dir_all(folder).expect("the folder");
    }

    #[test]
    fn a_torn_last_line_is_dropped_and_the_next_one_is_whole() {
        let folder = written("torn");
        let file = folder.join("unfinished.jsonl");
        let text = fs::read_to_string(&file).expect("the file");
        fs::write(&file, &text[..text.len() - 7]).expect("the file");
        let mut journal = Journal::open(&folder, true, Machine::present()).expect("a torn line");
        assert_eq!(journal.finished.len(), 1);
        journal.keep(finished("kepler")).expect("space");
        drop(journal);
        assert_eq!(Journal::open(&folder, true, Machine::present()).expect("whole").finished.len(), 2);
        fs::remove_dir_all(folder).expect("the folder");
    }

    #[test]
    fn a_corrupt_line_is_named_and_nothing_is_lost() {
        let folder = written("corrupt");
        let file = folder.join("unfinished.jsonl");
        let text = fs::read_to_string(&file).expect("the file").replacen("speedups", "speeds", 1);
        fs::write(&file, &text).expect("the file");
        let Err(error) = Journal::open(&folder, true, Machine::present()) else { panic!("it was opened") };
        assert!(matches!(error, JournalError::Corrupt { line: 2, .. }), "{error}");
        assert_eq!(fs::read_to_string(&file).expect("the file"), text);
        fs::remove_dir_all(folder).expect("the folder");
    }

    #[test]
    fn another_effort_does_not_go_on_with_it() {
        let folder = written("effort");
        let opened = Journal::open(&folder, false, Machine::present());
        assert!(matches!(opened, Err(JournalError::OtherEffort { quick: true, .. })));
        fs::remove_dir_all(folder).expect("the folder");
    }
}
