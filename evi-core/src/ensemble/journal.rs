//! Finished chunks on disk, so that an ensemble that was interrupted goes on where it stopped, to the last bit.
//!
//! The file is a list of words: a head that says which ensemble it belongs to, then per chunk its number, the number of its words, the words, and
//! their digest. A record that is not whole, as a killed process or a full disk leaves it, ends the list.

use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use crate::memory::{Digest, Memory, Recall, Record};

/// Begins every journal: `evi-ens` and a version.
const MAGIC: u64 = u64::from_le_bytes(*b"evi-ens1");

/// The finished chunks of one ensemble.
pub struct Journal {
    path: PathBuf,
    /// Words of the chunks that were finished when it was opened.
    found: HashMap<usize, Vec<u64>>,
    file: Mutex<Writer>,
}

/// A file, and how long it is up to its last whole record.
struct Writer {
    file: File,
    length: u64,
    chunks: usize,
}

/// A journal that cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JournalError {
    /// The file cannot be read or made.
    #[error("cannot open {}: {cause}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: io::Error,
    },
    /// The file belongs to an ensemble with another name.
    #[error("{} is no journal of this ensemble", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// A chunk cannot be added, as on a full disk. The chunks before are in the file.
    #[error("cannot write {}: {cause}; {chunks} finished chunks are kept in it", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Number of chunks that it has.
        chunks: usize,
        /// Why.
        cause: io::Error,
    },
}

impl Journal {
    /// Opens the journal of the ensemble called `name`, or begins it. The name says all that its results depend on: scene, scheme, members,
    /// samples, and what is gathered.
    ///
    /// # Errors
    /// [`JournalError::Open`]; [`JournalError::Foreign`] for the journal of another name.
    pub fn open(path: impl AsRef<Path>, name: &str) -> Result<Self, JournalError> {
        let path = path.as_ref().to_path_buf();
        let open = |cause| JournalError::Open { path: path.clone(), cause };
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(&path)
            .map_err(open)?;
        // What is no file may never end, as `/dev/full` does not.
        if !file.metadata().map_err(open)?.is_file() {
            return Err(open(io::Error::new(io::ErrorKind::InvalidInput, "it is no regular file")));
        }
        let head = [MAGIC, digest(name.bytes().map(u64::from))];
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(open)?;
        let words: Vec<u64> = bytes
            .chunks_exact(8)
            .map(|word| u64::from_le_bytes(word.try_into().unwrap_or_default()))
            .collect();
        if bytes.len() < 16 {
            // Nothing, or a head that was cut off.
            file.set_len(0).map_err(open)?;
            file.seek(SeekFrom::Start(0)).map_err(open)?;
            file.write_all(&as_bytes(&head)).map_err(open)?;
        } else if words[..2] != head {
            return Err(JournalError::Foreign { path });
        }
        let mut found = HashMap::new();
        let mut at = 2;
        while let Some(&[chunk, length]) = words.get(at..).and_then(|rest| rest.first_chunk())
            && let Some(end) = at.checked_add(2).and_then(|begin| begin.checked_add(length as usize))
            && let Some(&check) = words.get(end)
            && digest(words[at..end].iter().copied()) == check
        {
            found.insert(chunk as usize, words[at + 2..end].to_vec());
            at = end + 1;
        }
        let writer = Writer { file, length: 8 * at as u64, chunks: found.len() };
        Ok(Self { path, found, file: Mutex::new(writer) })
    }

    /// Number of chunks that were finished when the journal was opened.
    pub fn finished_chunks(&self) -> usize {
        self.found.len()
    }

    /// Overwrites `part` with that of a finished chunk, if it is there.
    pub(super) fn recall(&self, chunk: usize, part: &mut impl Memory) -> bool {
        let Some(words) = self.found.get(&chunk) else { return false };
        let mut words = words.iter().copied();
        part.recall(&mut Recall::from(&mut || words.next().unwrap_or_default()));
        true
    }

    /// Adds a finished chunk.
    pub(super) fn record(&self, chunk: usize, part: &impl Memory) -> Result<(), JournalError> {
        let mut words = vec![chunk as u64, 0];
        part.record(&mut Record::to(&mut |word| words.push(word)));
        words[1] = words.len() as u64 - 2;
        words.push(digest(words.iter().copied()));
        let mut writer = self.file.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        writer.add(&as_bytes(&words)).map_err(|cause| JournalError::Write {
            path: self.path.clone(),
            chunks: writer.chunks,
            cause,
        })
    }
}

impl Writer {
    /// Adds a record after the last whole one.
    fn add(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(self.length))?;
        self.file.write_all(bytes)?;
        self.length += bytes.len() as u64;
        self.chunks += 1;
        Ok(())
    }
}

fn as_bytes(words: &[u64]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

fn digest(words: impl IntoIterator<Item = u64>) -> u64 {
    let mut digest = Digest::default();
    words.into_iter().for_each(|word| digest.add(word));
    digest.value()
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    /// A device that is always full stands for a disk that is.
    #[test]
    fn a_full_disk_is_an_error_that_says_how_many_chunks_are_kept() {
        let path = PathBuf::from("/dev/full");
        let file = OpenOptions::new().write(true).open(&path).expect("Linux has it");
        let file = Mutex::new(Writer { file, length: 16, chunks: 3 });
        let journal = Journal { path, found: HashMap::new(), file };
        let error = journal.record(3, &()).expect_err("no room");
        let JournalError::Write { chunks, cause, .. } = &error else { panic!("{error}") };
        assert_eq!((*chunks, cause.kind()), (3, io::ErrorKind::StorageFull));
        assert_eq!(
            error.to_string(),
            "cannot write /dev/full: No space left on device (os error 28); 3 finished chunks are kept in it"
        );
        // The next record would stand where this one was to stand.
        let writer = journal.file.lock().expect("no panic");
        assert_eq!((writer.length, writer.chunks), (16, 3));
    }

    #[test]
    fn what_is_no_file_is_no_journal() {
        let error = Journal::open("/dev/full", "pendulums").err().expect("refused");
        assert_eq!(error.to_string(), "cannot open /dev/full: it is no regular file");
    }
}
