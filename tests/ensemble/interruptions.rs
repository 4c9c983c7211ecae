//! Interrupted ensembles keep what is finished and go on to the same bits.

use std::ops::ControlFlow;
use std::path::PathBuf;

use evi_core::columns::Table;
use evi_core::ensemble::{
    ByIndex, Ends, Ensemble, EnsembleError, Journal, JournalError, MemberError, Outcome, Quantity, Summaries,
    SummaryPart,
};
use evi_core::prelude::*;

use evi_examples::DoublePendulum;

use crate::members::pendulum;

const MEMBERS: usize = 300;
const CHUNK: usize = 32;

/// A file that is removed in the end.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("evi-ensemble-{}-{name}", std::process::id()));
        let _ = std::fs::remove_file(&path);
        Self(path)
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// All members, of which number 40 cannot start, until so many chunks are finished in this call.
fn run(
    journal: Option<&Journal>,
    most_chunks: usize,
) -> Result<Outcome<(SummaryPart, Table)>, EnsembleError> {
    let members = ByIndex::new(MEMBERS, |index| {
        let mut member = pendulum(index);
        if index == 40 {
            member.q[0] = f64::INFINITY;
        }
        member
    });
    let height = Quantity::<DoublePendulum>::new("height", |sight| sight.state.q()[3]);
    let gather = (Summaries::new(2, vec![height.histogram(-2.0, 0.0, 5)]), Ends);
    let ensemble = Ensemble::new(Evi::midpoint(0.05)).sampled(2, 10).chunks_of(CHUNK).threads(1);
    let seen = std::sync::atomic::AtomicUsize::new(0);
    ensemble.run_watched(&members, &gather, journal, &|progress| {
        assert_eq!(progress.members, MEMBERS);
        if seen.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1 >= most_chunks {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    })
}

#[test]
fn an_interrupted_ensemble_goes_on_to_the_same_bits() {
    let scratch = Scratch::new("resumed");
    let open = || Journal::open(&scratch.0, "pendulums").expect("a journal");
    let whole = run(None, usize::MAX).expect("a run");
    assert!(whole.is_complete());
    let part = run(Some(&open()), 4).expect("a part");
    assert_eq!((part.finished, part.is_complete()), (4 * CHUNK, false));
    assert_eq!(part.gathered.1.rows().len(), 4 * CHUNK - 1);
    let journal = open();
    assert_eq!(journal.finished_chunks(), 4);
    let resumed = run(Some(&journal), usize::MAX).expect("the rest");
    assert!(resumed.is_complete());
    assert_eq!(resumed.gathered, whole.gathered);
    let ([of_whole], [of_resumed]) = (&whole.failures[..], &resumed.failures[..]) else {
        panic!("one failure")
    };
    assert!(matches!(of_whole.error, MemberError::Start(StartError::NotFinite { .. })));
    assert_eq!(of_resumed.error, MemberError::Noted(of_whole.error.to_string()));
    assert_eq!((of_resumed.member, of_resumed.steps), (40, 0));
}

/// What a killed process leaves: a record that breaks off, or bytes that are none.
#[test]
fn a_broken_record_is_computed_again() {
    let scratch = Scratch::new("broken");
    let whole = run(None, usize::MAX).expect("a run");
    run(Some(&Journal::open(&scratch.0, "pendulums").expect("a journal")), 5).expect("a part");
    let bytes = std::fs::read(&scratch.0).expect("a file");
    for (cut, kept) in [(bytes.len() - 3, 4), (bytes.len() - 8, 4), (100, 0), (20, 0), (5, 0)] {
        std::fs::write(&scratch.0, &bytes[..cut]).expect("written");
        let journal = Journal::open(&scratch.0, "pendulums").expect("a journal");
        assert_eq!(journal.finished_chunks(), kept, "{cut} bytes");
        let resumed = run(Some(&journal), usize::MAX).expect("the rest");
        assert_eq!(resumed.gathered, whole.gathered);
    }
    let again = Journal::open(&scratch.0, "pendulums").expect("a journal");
    assert_eq!(again.finished_chunks(), MEMBERS.div_ceil(CHUNK));
}

#[test]
fn the_journal_of_another_ensemble_is_refused() {
    let scratch = Scratch::new("foreign");
    drop(Journal::open(&scratch.0, "pendulums").expect("a journal"));
    let error = Journal::open(&scratch.0, "springs").err().expect("refused");
    assert!(matches!(error, JournalError::Foreign { .. }), "{error}");
    let error = Journal::open("/nowhere/at/all", "pendulums").err().expect("refused");
    assert!(matches!(error, JournalError::Open { .. }), "{error}");
}

/// A link to a device that is always full stands for a disk that is.
#[cfg(target_os = "linux")]
#[test]
fn a_table_on_a_full_disk_is_an_error_and_the_old_one_stays() {
    use evi_core::columns::{Column, ColumnsError};

    let scratch = Scratch::new("table");
    let path = scratch.0.with_extension("csv");
    let new = Scratch(scratch.0.with_extension("new"));
    let mut table = Table::new(vec![Column::index("member"), Column::number("t")]);
    table.push([7.0, 0.25]);
    table.save(&path).expect("room");
    let old = std::fs::read(&path).expect("a file");
    std::os::unix::fs::symlink("/dev/full", &new.0).expect("a link");
    table.push([8.0, 0.5]);
    let error = table.save(&path).expect_err("no room");
    let ColumnsError::Write { cause, .. } = &error else { panic!("{error}") };
    assert_eq!(cause.kind(), std::io::ErrorKind::StorageFull);
    assert_eq!(std::fs::read(&path).expect("a file"), old);
    assert!(!new.0.exists() && !new.0.is_symlink(), "the new file is gone");
    drop(Scratch(path));
}
