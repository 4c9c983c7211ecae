//! Runs of many bodies, written down: everything from which they go on to the last bit.

use std::any::type_name;

use super::scene::PreparedScene;
use super::{
    AssembledRun, AssembledScheme, AssembledSimulation, AssembledStep, AssembledSystem, AssemblyError,
};
use crate::integrator::{Checkpoint, Fallbacks, Fingerprint, Tally, recall, recorded, without_paths};
use crate::memory::{Digest, Memory, Recall, Record};

impl<S: AssembledSystem, M: AssembledStep, T: Tally + Memory> AssembledRun<S, M, T> {
    /// The run, written down: its state, its steps, and the memory of its map and its tally, all numbers by their bits. It allocates; steps do not.
    ///
    /// ```
    /// # use evi_core::assembled::AssembledSimulation;
    /// # use evi_core::prelude::*;
    /// # const N: usize = 100;
    /// # #[derive(MechanicalSystem, Clone)]
    /// # #[evi(
    /// #     coordinates(p: [N]),
    /// #     kinetic = sum(0..N, |i| 0.5 * der(p[i]).powi(2)),
    /// #     potential = sum(1..N, |i| 0.5 * k * (p[i] - p[i - 1]).powi(2) + 0.25 * (p[i] - p[i - 1]).powi(4)),
    /// # )]
    /// # struct Lattice { k: f64 }
    /// let simulation = AssembledSimulation::new(Lattice { k: 2.0 }, Evi::midpoint(0.01));
    /// let mut run = simulation.start((0..N).map(|i| (i as f64).sin()).collect::<Vec<_>>(), vec![0.0; N])?;
    /// run.advance_to(1.0)?;
    /// let checkpoint = run.checkpoint();
    /// run.advance_to(2.0)?;
    ///
    /// let mut resumed = simulation.resume(&checkpoint)?;
    /// resumed.advance_to(2.0)?;
    /// assert_eq!((resumed.steps(), resumed.state()), (200, run.state()));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn checkpoint(&self) -> Checkpoint {
        let Self { scene, map, state, steps, tally, .. } = self;
        let (mut words, scheme) = recorded(map);
        words.extend(recorded(scene).0);
        let belongs_to = fingerprint::<S, M, T>(&self.system, scene, map, scheme);
        // An assembled run does not tell when it started.
        Checkpoint::new(belongs_to, (0.0, *steps), [recorded(state).0, words, recorded(tally).0])
    }
}

impl<S: AssembledSystem + Clone, F: AssembledScheme> AssembledSimulation<S, F> {
    /// The run that a checkpoint was taken of, as it was then.
    ///
    /// # Errors
    /// [`AssemblyError::Checkpoint`] for a checkpoint that is damaged or does not belong to this simulation, and other errors as for
    /// [`start`](Self::start).
    pub fn resume(&self, checkpoint: &Checkpoint) -> Result<AssembledRun<S, F::Step>, AssemblyError> {
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
    ) -> Result<AssembledRun<S, F::Step, T>, AssemblyError> {
        checkpoint.check_integrity()?;
        let mut scene = PreparedScene::new(self.system())?;
        let mut map = self.scheme().prepare(&mut scene)?;
        let (_, scheme) = recorded(&map);
        let fingerprint = fingerprint::<S, F::Step, T>(self.system(), &scene, &map, scheme);
        let [of_state, of_map, of_tally] = checkpoint.words_for(fingerprint)?;
        let mut state = scene.blank_state();
        recall("state", &mut state, of_state)?;
        scene.set_inputs(&state.inputs);
        recall("map", &mut MapInScene { map: &mut map, scene: &mut scene }, of_map)?;
        recall("tally", &mut tally, of_tally)?;
        Ok(AssembledRun {
            system: self.system().clone(),
            scene,
            map,
            state,
            steps: checkpoint.steps(),
            tally,
        })
    }
}

/// A map, and what its scene knows of the start of the next step.
struct MapInScene<'a, M> {
    map: &'a mut M,
    scene: &'a mut PreparedScene,
}

impl<M: Memory> Memory for MapInScene<'_, M> {
    fn record(&self, words: &mut Record<'_>) {
        words.part(self.map);
        words.part(self.scene);
    }

    fn recall(&mut self, words: &mut Recall<'_>) {
        words.part(self.map);
        words.part(self.scene);
    }
}

fn fingerprint<S, M: AssembledStep, T>(system: &S, scene: &PreparedScene, map: &M, scheme: u64) -> Fingerprint
where
    S: AssembledSystem,
{
    let (mut equations, mut constants) = (Digest::default(), Vec::new());
    equations.add(system.n_coordinates() as u64);
    for family in &scene.assembly.families {
        family.elements.tell(&mut equations, &mut constants);
    }
    Fingerprint {
        scene: without_paths(type_name::<S>()),
        equations: equations.value(),
        constants,
        map: without_paths(type_name::<M>()),
        step_size: map.h().to_bits(),
        scheme,
        tally: without_paths(type_name::<T>()),
    }
}
