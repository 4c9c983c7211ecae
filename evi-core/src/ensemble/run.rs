//! An ensemble: a scheme, when members are seen, and their motion as one call.

use core::ops::{ControlFlow, Range};
use std::sync::Mutex;

use super::chunk::{Gathered, Motion, Schedule};
use super::failure::{Failure, Failures};
use super::gather::{Gather, Part};
use super::journal::{Journal, JournalError};
use super::lane_map::LaneScheme;
use super::members::Members;
use super::section::{NoSection, Section};
use super::tree::Tree;
use crate::memory::{Memory, Recall, Record};
use crate::system::MechanicalSystem;

/// Members that one thread moves at a time: long enough that nobody waits, short enough that an interruption loses little.
const CHUNK: usize = 256;

/// A scheme for many members, and when they are seen.
///
/// Results depend neither on the number of threads nor on the company that a member is in: chunks of members and the tree that puts them
/// together are fixed by their indices.
#[derive(Clone, Debug)]
pub struct Ensemble<F, X = NoSection> {
    scheme: F,
    schedule: Schedule,
    section: X,
    chunk: usize,
    threads: Option<usize>,
}

/// How far an ensemble is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Members whose motion is finished.
    pub finished: usize,
    /// All members.
    pub members: usize,
}

/// What is left of an ensemble.
#[derive(Debug)]
pub struct Outcome<P> {
    /// What was gathered.
    pub gathered: P,
    /// Members that came to no end, in the order of their indices.
    pub failures: Vec<Failure>,
    /// Members whose motion is finished, with or without an end.
    pub finished: usize,
    /// All members.
    pub members: usize,
}

impl<P> Outcome<P> {
    /// Whether no chunk of members is missing.
    pub const fn is_complete(&self) -> bool {
        self.finished == self.members
    }
}

/// An ensemble that cannot run, or not to its end. What was finished before is in its journal.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EnsembleError {
    /// The journal cannot be used.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// No threads can be started.
    #[error("cannot start {threads} threads: {message}")]
    Threads {
        /// How many.
        threads: usize,
        /// Why.
        message: String,
    },
}

/// What one chunk leaves behind: a leaf of the tree.
impl<P: Memory> Memory for Gathered<P> {
    fn record(&self, words: &mut Record<'_>) {
        words.part(&self.part);
        words.part(&self.failures);
    }

    fn recall(&mut self, words: &mut Recall<'_>) {
        words.part(&mut self.part);
        words.part(&mut self.failures);
    }
}

impl<P: Part> Part for Gathered<P> {
    fn absorb(&mut self, later: Self) {
        self.part.absorb(later.part);
        self.failures.0.extend(later.failures.0);
    }
}

impl<F> Ensemble<F> {
    /// An ensemble that moves by `scheme` from time 0; members are seen at the start until told otherwise.
    pub const fn new(scheme: F) -> Self {
        let schedule = Schedule { t: 0.0, stride: 1, samples: 0 };
        Self { scheme, schedule, section: NoSection, chunk: CHUNK, threads: None }
    }

    /// Watches for crossings of a section.
    pub fn section<X>(self, section: X) -> Ensemble<F, X> {
        let Self { scheme, schedule, chunk, threads, .. } = self;
        Ensemble { scheme, schedule, section, chunk, threads }
    }
}

impl<F, X> Ensemble<F, X> {
    /// Members start at time `t`.
    #[must_use]
    pub const fn from_time(mut self, t: f64) -> Self {
        self.schedule.t = t;
        self
    }

    /// Members are seen at their start and `samples` times after `steps` steps each.
    #[must_use]
    pub const fn sampled(mut self, samples: usize, steps: u64) -> Self {
        (self.schedule.samples, self.schedule.stride) = (samples, steps);
        self
    }

    /// So many members are moved at a time. Sums are the same to the last bit for the same number only.
    #[must_use]
    pub const fn chunks_of(mut self, members: usize) -> Self {
        self.chunk = if members == 0 { 1 } else { members };
        self
    }

    /// Moves members on so many threads, as far as the feature `rayon` is there; without this call on as many as there are cores.
    #[must_use]
    pub const fn threads(mut self, threads: usize) -> Self {
        self.threads = Some(threads);
        self
    }

    /// Number of chunks that so many members make.
    pub(super) const fn chunks(&self, members: usize) -> usize {
        members.div_ceil(self.chunk)
    }

    /// The members of a chunk.
    pub(super) fn range(&self, chunk: usize, members: usize) -> Range<usize> {
        chunk * self.chunk..((chunk + 1) * self.chunk).min(members)
    }

    /// The motion of members, and what is gathered of it.
    pub(super) const fn motion<'a, G>(&'a self, gather: &'a G) -> Motion<'a, F, X, G> {
        Motion { scheme: &self.scheme, schedule: self.schedule, section: &self.section, gather }
    }

    /// Number of threads that are asked for.
    #[cfg(feature = "mpi")]
    pub(super) const fn wanted_threads(&self) -> Option<usize> {
        self.threads
    }

    /// Number of steps that a member takes from start to end.
    pub const fn steps(&self) -> u64 {
        self.schedule.samples as u64 * self.schedule.stride
    }

    /// Moves all members to their ends.
    ///
    /// # Errors
    /// [`EnsembleError::Threads`].
    pub fn run<S, G>(&self, members: &impl Members<S>, gather: &G) -> Result<Outcome<G::Part>, EnsembleError>
    where
        S: MechanicalSystem,
        F: LaneScheme<S> + Sync,
        X: Section<S>,
        G: Gather<S>,
    {
        self.run_watched(members, gather, None, &|_| ControlFlow::Continue(()))
    }

    /// Moves all members to their ends, shows its progress after every chunk, and ends early where `watch` breaks: what is finished then is kept.
    /// Chunks that are in the `journal` are not moved again, and those that are finished are added to it.
    ///
    /// # Errors
    /// [`EnsembleError`]; what is finished by then is in the journal.
    pub fn run_watched<S, G>(
        &self,
        members: &impl Members<S>,
        gather: &G,
        journal: Option<&Journal>,
        watch: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
    ) -> Result<Outcome<G::Part>, EnsembleError>
    where
        S: MechanicalSystem,
        F: LaneScheme<S> + Sync,
        X: Section<S>,
        G: Gather<S>,
    {
        let count = members.count();
        let chunks = self.chunks(count);
        let range = |chunk: usize| self.range(chunk, count);
        let motion = self.motion(gather);
        let mut tree = Tree::new(chunks);
        let mut finished = 0;
        let mut missing = Vec::new();
        for chunk in 0..chunks {
            let mut gathered = Gathered { part: gather.blank(), failures: Failures::default() };
            if journal.is_some_and(|journal| journal.recall(chunk, &mut gathered)) {
                finished += range(chunk).len();
                tree.put(chunk, gathered);
            } else {
                missing.push(chunk);
            }
        }
        let shared = Mutex::new((tree, finished));
        let all = |chunk: usize| -> ControlFlow<Result<(), JournalError>> {
            let gathered = motion.integrate(members, range(chunk));
            if let Some(journal) = journal
                && let Err(error) = journal.record(chunk, &gathered)
            {
                return ControlFlow::Break(Err(error));
            }
            // A thread that panics ends the program's interest in the sum.
            let mut guard = shared.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            guard.0.put(chunk, gathered);
            guard.1 += range(chunk).len();
            let progress = Progress { finished: guard.1, members: count };
            drop(guard);
            watch(progress).map_break(Ok)
        };
        for_each(&missing, self.threads, &all)?;
        let (tree, finished) = shared.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        let blank = || Gathered { part: gather.blank(), failures: Failures::default() };
        let Gathered { part, failures } = tree.total().unwrap_or_else(blank);
        Ok(Outcome { gathered: part, failures: failures.0, finished, members: count })
    }
}

/// Does the work of every chunk until one of them breaks.
#[cfg(feature = "rayon")]
pub(super) fn for_each(
    chunks: &[usize],
    threads: Option<usize>,
    work: &(impl Fn(usize) -> ControlFlow<Result<(), JournalError>> + Sync),
) -> Result<(), EnsembleError> {
    use rayon::prelude::*;

    let all = || chunks.par_iter().try_for_each(|&chunk| work(chunk));
    let flow = match threads {
        Some(1) => chunks.iter().try_for_each(|&chunk| work(chunk)),
        Some(threads) if threads == rayon::current_num_threads() => all(),
        Some(threads) => rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|error| EnsembleError::Threads { threads, message: error.to_string() })?
            .install(all),
        None => all(),
    };
    ended(flow)
}

/// Does the work of every chunk until one of them breaks.
#[cfg(not(feature = "rayon"))]
pub(super) fn for_each(
    chunks: &[usize],
    _threads: Option<usize>,
    work: &(impl Fn(usize) -> ControlFlow<Result<(), JournalError>> + Sync),
) -> Result<(), EnsembleError> {
    ended(chunks.iter().try_for_each(|&chunk| work(chunk)))
}

fn ended(flow: ControlFlow<Result<(), JournalError>>) -> Result<(), EnsembleError> {
    match flow {
        ControlFlow::Continue(()) | ControlFlow::Break(Ok(())) => Ok(()),
        ControlFlow::Break(Err(error)) => Err(error.into()),
    }
}
