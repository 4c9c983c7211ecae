//! To which simulation a checkpoint belongs.

use std::any::type_name;
use std::string::String;
use std::vec::Vec;

use super::ResumeError;
use crate::integrator::OneStep;
use crate::memory::Digest;
use crate::system::{MechanicalSystem, SystemReport};

/// What a checkpoint is compared by with the simulation that is to resume it.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Fingerprint {
    pub(crate) scene: String,
    /// Digest of the equations as the user wrote them.
    pub(crate) equations: u64,
    /// Bits of every value that the equations take from the parameters.
    pub(crate) constants: Vec<u64>,
    /// The type of the one-step map.
    pub(crate) map: String,
    /// Bits of the step size.
    pub(crate) step_size: u64,
    /// Digest of the other numbers of the scheme.
    pub(crate) scheme: u64,
    pub(crate) tally: String,
}

impl Fingerprint {
    pub(super) fn add_to(&self, digest: &mut Digest) {
        let Self { scene, equations, constants, map, step_size, scheme, tally } = self;
        for text in [scene, map, tally] {
            digest.add_text(text);
        }
        digest.add_list(constants);
        for word in [*equations, *step_size, *scheme] {
            digest.add(word);
        }
    }

    /// Of runs of `map` with a tally of type `T`; `scheme` is the digest of the map's fixed numbers.
    pub(super) fn new<S: MechanicalSystem, M: OneStep<S>, T>(map: &M, scheme: u64) -> Self {
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
    pub(super) fn check(&self, simulation: Self) -> Result<(), ResumeError> {
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

/// Of the names and equations of a scene.
fn digest_of(scene: &SystemReport) -> u64 {
    let mut digest = Digest::default();
    scene.add_to(&mut digest);
    digest.value()
}

impl SystemReport {
    /// Adds the names and equations of a scene.
    pub(crate) fn add_to(&self, digest: &mut Digest) {
        for names in [self.coordinates, self.constraints, self.parameters, self.inputs, self.observables] {
            digest.add(names.len() as u64);
            names.iter().for_each(|name| digest.add_text(name));
        }
        for equation in self.equations {
            for text in [equation.name, equation.left.unicode, equation.right.unicode] {
                digest.add_text(text);
            }
        }
    }
}

/// A type as its user writes it: `EviStep<DoublePendulum, Linear, 1>`.
pub(crate) fn without_paths(name: &str) -> String {
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
