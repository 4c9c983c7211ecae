//! A run, written down: everything from which it goes on to the last bit.

mod fingerprint;
mod resume_error;

use std::vec::Vec;

pub(crate) use self::fingerprint::{Fingerprint, without_paths};
use super::{OneStep, Run, Scheme, Simulation, Tally};
use crate::mechanics::{Mechanics, State};
use crate::memory::{Digest, Memory, Recall, Record};
use crate::newton::Fallbacks;
use crate::system::MechanicalSystem;

pub use self::resume_error::ResumeError;

/// The layout of the words below. It changes with every change of what a map remembers.
const FORMAT: u32 = 2;

/// A run, written down: its state, its time and steps, and the memory of its map and its tally, all numbers by their bits.
///
/// [`Run::checkpoint`] takes one, [`Simulation::resume`] goes on from it: the resumed run takes the same steps to the last bit as the first one
/// would have, by the same build on the same machine. A checkpoint knows to which simulation it belongs, and others refuse it. With the feature
/// `serde` it can be serialised; every number is a whole one, so that JSON is exact.
///
/// ```
/// use evi_core::prelude::*;
/// # #[derive(MechanicalSystem)]
/// # #[evi(coordinates(theta), kinetic = 0.5 * der(theta).powi(2), potential = -rate.powi(2) * theta.cos())]
/// # struct Pendulum { rate: f64 }
/// let simulation = Simulation::new(Pendulum { rate: 3.0 }, Evi::midpoint(0.01).compensated());
/// let mut run = simulation.start([1.0], [0.0])?;
/// run.advance_to(1.0)?;
/// let checkpoint = run.checkpoint();
/// run.advance_to(2.0)?;
///
/// let mut resumed = simulation.resume(&checkpoint)?;
/// assert_eq!(resumed.steps(), 100);
/// resumed.advance_to(2.0)?;
/// assert_eq!(resumed.state().q()[0].to_bits(), run.state().q()[0].to_bits());
///
/// let shorter = Simulation::new(Pendulum { rate: 3.0 }, Evi::midpoint(0.005).compensated());
/// assert!(matches!(shorter.resume(&checkpoint), Err(ResumeError::StepSize { .. })));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Checkpoint {
    format: u32,
    /// Of all that follows.
    checksum: u64,
    belongs_to: Fingerprint,
    /// Bits of the time at which the run started.
    start_time: u64,
    steps: u64,
    state: Vec<u64>,
    map: Vec<u64>,
    tally: Vec<u64>,
}

impl Checkpoint {
    /// Time of the state.
    pub fn t(&self) -> f64 {
        self.state.first().map_or(f64::NAN, |bits| f64::from_bits(*bits))
    }

    /// Number of steps taken.
    pub const fn steps(&self) -> u64 {
        self.steps
    }

    /// The checksum of the contents.
    fn sum(&self) -> u64 {
        let Self { format, checksum: _, belongs_to, start_time, steps, state, map, tally } = self;
        let mut digest = Digest::default();
        belongs_to.add_to(&mut digest);
        for words in [state, map, tally] {
            digest.add_list(words);
        }
        for word in [u64::from(*format), *start_time, *steps] {
            digest.add(word);
        }
        digest.value()
    }

    /// A run of the simulation that `belongs_to` tells, by the words of its parts.
    pub(crate) fn new(
        belongs_to: Fingerprint,
        (start_time, steps): (f64, u64),
        [state, map, tally]: [Vec<u64>; 3],
    ) -> Self {
        let start_time = start_time.to_bits();
        let mut checkpoint =
            Self { format: FORMAT, checksum: 0, belongs_to, start_time, steps, state, map, tally };
        checkpoint.checksum = checkpoint.sum();
        checkpoint
    }

    /// The words of state, map and tally, if the checkpoint is one of the simulation that `simulation` tells.
    ///
    /// # Errors
    /// [`ResumeError`] for the first thing in which the simulation differs.
    pub(crate) fn words_for(&self, simulation: Fingerprint) -> Result<[&[u64]; 3], ResumeError> {
        self.belongs_to.check(simulation)?;
        Ok([&self.state, &self.map, &self.tally])
    }

    /// # Errors
    /// [`ResumeError`] for a checkpoint of another version, or one that has changed since it was taken.
    pub(crate) fn check_integrity(&self) -> Result<(), ResumeError> {
        if self.format != FORMAT {
            return Err(ResumeError::Format { found: self.format, expected: FORMAT });
        }
        let (found, expected) = (self.sum(), self.checksum);
        if found == expected { Ok(()) } else { Err(ResumeError::Damaged { found, expected }) }
    }
}

impl<S: MechanicalSystem, M: OneStep<S>, T: Tally + Memory> Run<S, M, T> {
    /// The run, written down. It allocates; steps do not.
    pub fn checkpoint(&self) -> Checkpoint {
        let (map, scheme) = recorded(self.map());
        let (state, _) = recorded(self.state());
        let (tally, _) = recorded(self.tally());
        let belongs_to = Fingerprint::new::<S, M, T>(self.map(), scheme);
        Checkpoint::new(belongs_to, (self.start_time(), self.steps()), [state, map, tally])
    }
}

impl<S: MechanicalSystem, F: Scheme<S>> Simulation<S, F> {
    /// The run that a checkpoint was taken of, as it was then.
    ///
    /// # Errors
    /// [`ResumeError`] for a checkpoint that is damaged or does not belong to this simulation.
    pub fn resume(&self, checkpoint: &Checkpoint) -> Result<Run<S, F::Step>, ResumeError> {
        self.resume_with(checkpoint, Fallbacks::default())
    }

    /// The same for a run with another tally than the usual one, which `tally` is of the type of:
    /// `simulation.resume_with(&checkpoint, Statistics::default())`.
    ///
    /// # Errors
    /// As for [`resume`](Self::resume).
    pub fn resume_with<T: Tally + Memory>(
        &self,
        checkpoint: &Checkpoint,
        mut tally: T,
    ) -> Result<Run<S, F::Step, T>, ResumeError> {
        checkpoint.check_integrity()?;
        let mut map = self.scheme().prepare(Mechanics::new(self.system()))?;
        let (_, scheme) = recorded(&map);
        let fingerprint = Fingerprint::new::<S, F::Step, T>(&map, scheme);
        let [of_state, of_map, of_tally] = checkpoint.words_for(fingerprint)?;
        let mut state = State::blank();
        recall("state", &mut state, of_state)?;
        recall("map", &mut map, of_map)?;
        recall("tally", &mut tally, of_tally)?;
        Ok(Run::resumed(map, state, f64::from_bits(checkpoint.start_time), checkpoint.steps, tally))
    }
}

/// The words of a memory, and the digest of its fixed numbers.
pub(crate) fn recorded(memory: &impl Memory) -> (Vec<u64>, u64) {
    let mut words = Vec::new();
    let mut sink = |word| words.push(word);
    let mut record = Record::to(&mut sink);
    memory.record(&mut record);
    let digest = record.digest();
    (words, digest)
}

/// Overwrites a memory with `words`, which have to be as many as it takes.
pub(crate) fn recall(part: &'static str, memory: &mut impl Memory, words: &[u64]) -> Result<(), ResumeError> {
    let mut expected = 0;
    let mut source = || {
        let word = words.get(expected).copied().unwrap_or_default();
        expected += 1;
        word
    };
    memory.recall(&mut Recall::from(&mut source));
    let found = words.len();
    if found == expected { Ok(()) } else { Err(ResumeError::Length { part, found, expected }) }
}
