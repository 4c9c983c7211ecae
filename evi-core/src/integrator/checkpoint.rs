//! A run, written down: everything from which it goes on to the last bit.

use std::any::type_name;
use std::string::String;
use std::vec::Vec;

use super::{OneStep, Run, Scheme, Simulation, Tally};
use crate::mechanics::{Mechanics, State};
use crate::memory::{Digest, Memory, Recall, Record};
use crate::newton::Fallbacks;
use crate::scheme::SchemeError;
use crate::system::{MechanicalSystem, SystemReport};

/// The layout of the words below. It changes with every change of what a map remembers.
const FORMAT: u32 = 1;

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

/// What a checkpoint is compared by with the simulation that is to resume it.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Fingerprint {
    scene: String,
    /// Digest of the equations as the user wrote them.
    equations: u64,
    /// Bits of every value that the equations take from the parameters.
    constants: Vec<u64>,
    /// The type of the one-step map.
    map: String,
    /// Bits of the step size.
    step_size: u64,
    /// Digest of the other numbers of the scheme.
    scheme: u64,
    tally: String,
}

/// A checkpoint that a simulation cannot go on from.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ResumeError {
    /// The scheme defines no step.
    #[error(transparent)]
    Scheme(#[from] SchemeError),
    /// Another version of the crate wrote the checkpoint.
    #[error("the checkpoint has format {found}, this version reads format {expected}")]
    Format {
        /// That of the checkpoint.
        found: u32,
        /// That of this version.
        expected: u32,
    },
    /// The checkpoint has changed since it was taken.
    #[error(
        "the checkpoint is damaged: its contents add up to {found:016x}, its checksum is {expected:016x}"
    )]
    Damaged {
        /// Checksum of the contents.
        found: u64,
        /// The checksum in the checkpoint.
        expected: u64,
    },
    /// The checkpoint is one of another scene.
    #[error("the checkpoint is one of the scene `{checkpoint}`, the simulation one of `{simulation}`")]
    OtherScene {
        /// That of the checkpoint.
        checkpoint: String,
        /// That of the simulation.
        simulation: String,
    },
    /// The scene has the same name, but other equations.
    #[error("the equations of the scene `{scene}` are not those that the checkpoint was taken with")]
    OtherEquations {
        /// The scene.
        scene: String,
    },
    /// The scene has other parameters.
    #[error(
        "the scene has other parameters: a value that its equations take from them was {checkpoint:e} when the checkpoint was \
         taken, and is {simulation:e}"
    )]
    OtherParameters {
        /// The first value that differs, when the checkpoint was taken.
        checkpoint: f64,
        /// The same in the simulation.
        simulation: f64,
    },
    /// The scheme is of another kind.
    #[error("the checkpoint is one of the map `{checkpoint}`, the simulation has `{simulation}`")]
    OtherMap {
        /// That of the checkpoint.
        checkpoint: String,
        /// That of the simulation.
        simulation: String,
    },
    /// The steps have another size.
    #[error("the checkpoint is one of steps of h = {checkpoint}, the simulation takes h = {simulation}")]
    StepSize {
        /// That of the checkpoint.
        checkpoint: f64,
        /// That of the simulation.
        simulation: f64,
    },
    /// The scheme is of the same kind, but has other nodes, frequencies or matrices.
    #[error("the scheme has other numbers (nodes, frequencies, matrices) than that of the checkpoint")]
    OtherScheme,
    /// What happened inside the steps was counted by another tally; see [`Simulation::resume_with`].
    #[error("the run of the checkpoint has the tally `{checkpoint}`, to be resumed with `{resumed}`")]
    OtherTally {
        /// That of the checkpoint.
        checkpoint: String,
        /// That of the run to be resumed.
        resumed: String,
    },
    /// The checkpoint does not hold as many words as the run remembers.
    #[error("the checkpoint holds {found} words of the {part}, the run remembers {expected}")]
    Length {
        /// `state`, `map` or `tally`.
        part: &'static str,
        /// Number of words in the checkpoint.
        found: usize,
        /// Number of words that the run remembers.
        expected: usize,
    },
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
        let Fingerprint { scene, equations, constants, map: map_name, step_size, scheme, tally: tally_name } =
            belongs_to;
        let mut digest = Digest::default();
        for text in [scene, map_name, tally_name] {
            digest.add(text.len() as u64);
            digest.add_bytes(text.as_bytes());
        }
        for words in [constants, state, map, tally] {
            digest.add(words.len() as u64);
            words.iter().for_each(|word| digest.add(*word));
        }
        for word in [u64::from(*format), *equations, *step_size, *scheme, *start_time, *steps] {
            digest.add(word);
        }
        digest.value()
    }

    fn check_integrity(&self) -> Result<(), ResumeError> {
        if self.format != FORMAT {
            return Err(ResumeError::Format { found: self.format, expected: FORMAT });
        }
        let (found, expected) = (self.sum(), self.checksum);
        if found == expected { Ok(()) } else { Err(ResumeError::Damaged { found, expected }) }
    }
}

impl Fingerprint {
    /// Of runs of `map` with a tally of type `T`; `scheme` is the digest of the map's fixed numbers.
    fn new<S: MechanicalSystem, M: OneStep<S>, T>(map: &M, scheme: u64) -> Self {
        Self {
            scene: S::REPORT.name.into(),
            equations: digest_of(&S::REPORT),
            constants: map.mechanics().constants.as_ref().iter().map(|value| value.to_bits()).collect(),
            map: without_paths(type_name::<M>()),
            step_size: map.h().to_bits(),
            scheme,
            tally: without_paths(type_name::<T>()),
        }
    }

    /// # Errors
    /// [`ResumeError`] for the first thing in which the simulation differs.
    fn check(&self, simulation: Self) -> Result<(), ResumeError> {
        let checkpoint = self.clone();
        if checkpoint.scene != simulation.scene {
            return Err(ResumeError::OtherScene {
                checkpoint: checkpoint.scene,
                simulation: simulation.scene,
            });
        }
        if checkpoint.equations != simulation.equations {
            return Err(ResumeError::OtherEquations { scene: checkpoint.scene });
        }
        for (&ours, &theirs) in checkpoint.constants.iter().zip(&simulation.constants) {
            if ours != theirs {
                let (checkpoint, simulation) = (f64::from_bits(ours), f64::from_bits(theirs));
                return Err(ResumeError::OtherParameters { checkpoint, simulation });
            }
        }
        if checkpoint.map != simulation.map {
            return Err(ResumeError::OtherMap { checkpoint: checkpoint.map, simulation: simulation.map });
        }
        if checkpoint.step_size != simulation.step_size {
            let [checkpoint, simulation] = [checkpoint.step_size, simulation.step_size].map(f64::from_bits);
            return Err(ResumeError::StepSize { checkpoint, simulation });
        }
        if checkpoint.tally != simulation.tally {
            return Err(ResumeError::OtherTally { checkpoint: checkpoint.tally, resumed: simulation.tally });
        }
        // Numbers of constants differ where a newer derive folds others.
        if checkpoint.constants.len() != simulation.constants.len() || checkpoint.scheme != simulation.scheme
        {
            return Err(ResumeError::OtherScheme);
        }
        Ok(())
    }
}

impl<S: MechanicalSystem, M: OneStep<S>, T: Tally + Memory> Run<S, M, T> {
    /// The run, written down. It allocates; steps do not.
    pub fn checkpoint(&self) -> Checkpoint {
        let (map, scheme) = recorded(self.map());
        let (state, _) = recorded(self.state());
        let (tally, _) = recorded(self.tally());
        let mut checkpoint = Checkpoint {
            format: FORMAT,
            checksum: 0,
            belongs_to: Fingerprint::new::<S, M, T>(self.map(), scheme),
            start_time: self.start_time().to_bits(),
            steps: self.steps(),
            state,
            map,
            tally,
        };
        checkpoint.checksum = checkpoint.sum();
        checkpoint
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
        checkpoint.belongs_to.check(Fingerprint::new::<S, F::Step, T>(&map, scheme))?;
        let mut state = State::blank();
        recall("state", &mut state, &checkpoint.state)?;
        recall("map", &mut map, &checkpoint.map)?;
        recall("tally", &mut tally, &checkpoint.tally)?;
        Ok(Run::resumed(map, state, f64::from_bits(checkpoint.start_time), checkpoint.steps, tally))
    }
}

/// The words of a memory, and the digest of its fixed numbers.
fn recorded(memory: &impl Memory) -> (Vec<u64>, u64) {
    let mut words = Vec::new();
    let mut sink = |word| words.push(word);
    let mut record = Record::to(&mut sink);
    memory.record(&mut record);
    let digest = record.digest();
    (words, digest)
}

/// Overwrites a memory with `words`, which have to be as many as it takes.
fn recall(part: &'static str, memory: &mut impl Memory, words: &[u64]) -> Result<(), ResumeError> {
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

/// Of the names and equations of a scene.
fn digest_of(scene: &SystemReport) -> u64 {
    let mut digest = Digest::default();
    for names in [scene.coordinates, scene.constraints, scene.parameters, scene.inputs, scene.observables] {
        digest.add(names.len() as u64);
        for name in names {
            digest.add(name.len() as u64);
            digest.add_bytes(name.as_bytes());
        }
    }
    for equation in scene.equations {
        for text in [equation.name, equation.left.unicode, equation.right.unicode] {
            digest.add(text.len() as u64);
            digest.add_bytes(text.as_bytes());
        }
    }
    digest.value()
}

/// A type as its user writes it: `EviStep<DoublePendulum, Linear, 1>`.
fn without_paths(name: &str) -> String {
    let mut short = String::new();
    let mut word = String::new();
    for character in name.chars() {
        match character {
            ':' => word.clear(),
            '<' | '>' | ',' | ' ' | '[' | ']' | '(' | ')' | ';' | '&' => {
                short.push_str(&word);
                word.clear();
                short.push(character);
            }
            _ => word.push(character),
        }
    }
    short + &word
}

#[cfg(test)]
mod tests {
    use super::without_paths;

    #[test]
    fn a_type_is_named_without_its_paths() {
        let name = "evi_core::integrator::evi::EviStep<a::b::Scene, [c::Frequency; 4], 3>";
        assert_eq!(without_paths(name), "EviStep<Scene, [Frequency; 4], 3>");
        assert_eq!(without_paths("()"), "()");
    }
}
