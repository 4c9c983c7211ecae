//! Galerkin steps of assembled scenes: the equations of [`Galerkin`](crate::integrator::Galerkin), with matrices of few nonzeros.
//!
//! A step is solved by passes over all nodes at once, a node per lane: [`passes`] where the mass is constant and of small blocks, [`points`] for any
//! other. What passes do not solve is left to Newton's iteration on all points, in [`newton`].

mod landing;
mod newton;
mod passes;
mod past;
mod points;
mod stages;
mod start;
mod sweeps;

use super::assembly::Assembly;
use super::scene::PreparedScene;
use super::{AssembledScheme, AssembledState, AssembledStep, AssemblyError};
use crate::integrator::{Galerkin, Iteration, IterationFailure, StepError, Symmetric as _, Tally};
use crate::memory::memory;
use crate::newton::NotConverged;
use crate::scalar::InstructionSet;
use crate::scheme::checked_step_size;
use newton::NewtonTables;
pub(super) use newton::PointMatrix;
use passes::{FirstGuess, NodeStorage, Passes};
use points::{PointPasses, PointStorage};

/// The one-step map of a [`Galerkin`] scheme, with the storage of its passes: nothing is allocated under a step.
///
/// A step whose passes do not converge from the past begins again from the acceleration of its start; one whose passes do not converge then is left to
/// Newton's iteration on all points, from the same start. Scenes whose matrix over all points is larger than a gigabyte have none: there such a step has
/// failed.
pub struct AssembledGalerkin<const K: usize> {
    h: f64,
    instructions: InstructionSet,
    /// None where Newton's iteration alone is asked for.
    nodes: Option<NodePasses>,
    newton: NewtonTables,
}

/// The passes of a scene.
enum NodePasses {
    /// With a constant mass of small blocks.
    Blocks(Box<NodeStorage>),
    /// With any other.
    Points(Box<PointStorage>),
}

/// How a step was solved.
#[derive(Clone, Copy, PartialEq)]
enum Solution {
    ByPasses,
    ByNewton,
}

impl<const K: usize> AssembledScheme for Galerkin<K> {
    type Step = AssembledGalerkin<K>;

    fn prepare(&self, scene: &mut PreparedScene) -> Result<AssembledGalerkin<K>, AssemblyError> {
        let h = checked_step_size(self.step_size())?;
        let nodes = match &scene.inertia {
            _ if self.is_by_newton() => None,
            Some(inertia) => {
                let nodes = NodeStorage::new::<K>(&scene.assembly, inertia, h);
                Some(NodePasses::Blocks(Box::new(nodes)))
            }
            None => match PointStorage::new::<K>(&scene.assembly, h) {
                Ok(nodes) => Some(NodePasses::Points(Box::new(nodes))),
                Err(fill) => return Err(scene.too_much(fill)),
            },
        };
        scene.prepare_points(K);
        Ok(AssembledGalerkin {
            h,
            instructions: InstructionSet::detect(),
            nodes,
            newton: NewtonTables::new::<K>(h),
        })
    }
}

impl<const K: usize> AssembledStep for AssembledGalerkin<K> {
    fn h(&self) -> f64 {
        self.h
    }

    fn forget(&mut self) {
        if let Some(nodes) = &mut self.nodes {
            nodes.forget();
        }
    }

    fn advance(
        &mut self,
        scene: &mut PreparedScene,
        state: &mut AssembledState,
        tally: &mut impl Tally,
    ) -> Result<(), StepError> {
        scene.know_start(state);
        let solution = self.solve(scene, state, tally)?;
        self.land(solution, scene, state, tally)?;
        if let Some(nodes) = &mut self.nodes {
            match solution {
                Solution::ByPasses => nodes.remember(),
                Solution::ByNewton => nodes.forget(),
            }
        }
        Ok(())
    }
}

impl<const K: usize> AssembledGalerkin<K> {
    /// How its steps are solved: which iteration, in which vector instructions; to be printed.
    pub const fn iteration(&self) -> Iteration {
        match self.nodes {
            Some(_) => Iteration::Passes(self.instructions),
            None => Iteration::Newton,
        }
    }

    /// Solves the equations of the step: by passes from the last steps, by passes from the state alone, or by Newton's iteration.
    fn solve(
        &mut self,
        scene: &mut PreparedScene,
        state: &AssembledState,
        tally: &mut impl Tally,
    ) -> Result<Solution, StepError> {
        if self.nodes.as_ref().is_some_and(NodePasses::knows_the_past) {
            if let Ok(passes) = self.pass(scene, state, FirstGuess::Continued) {
                tally.count_corrections(passes);
                return Ok(Solution::ByPasses);
            }
            tally.count_restart();
            self.forget();
        }
        scene.set_acceleration(state, self.h).map_err(|matrix| StepError::Singular {
            t: state.t,
            correction: 0,
            matrix,
        })?;
        if self.nodes.is_some() {
            let failure = match self.pass(scene, state, FirstGuess::Constant) {
                Ok(passes) => {
                    tally.count_corrections(passes);
                    return Ok(Solution::ByPasses);
                }
                Err(failure) => failure,
            };
            if scene.points.is_none() {
                let instructions = self.instructions;
                let residual = self
                    .nodes
                    .as_mut()
                    .map_or(f64::NAN, |nodes| nodes.largest_residual(&scene.assembly, instructions, state.t));
                return Err(IterationFailure::from(failure).at(state.t, residual, 1.0));
            }
            tally.count_newton();
            // Passes have overwritten it.
            scene.set_acceleration(state, self.h).map_err(|matrix| StepError::Singular {
                t: state.t,
                correction: 0,
                matrix,
            })?;
        }
        self.newton.solve(scene, state, tally)?;
        Ok(Solution::ByNewton)
    }

    fn pass(
        &mut self,
        scene: &mut PreparedScene,
        start: &AssembledState,
        first: FirstGuess,
    ) -> Result<usize, NotConverged> {
        let instructions = self.instructions;
        match &mut self.nodes {
            Some(NodePasses::Blocks(nodes)) => {
                instructions.run(Passes::<K> { nodes, scene, start, first, instructions })
            }
            Some(NodePasses::Points(nodes)) => {
                instructions.run(PointPasses::<K> { nodes, scene, start, first, instructions })
            }
            None => Err(NotConverged { corrections: 0, last_correction: f64::NAN }),
        }
    }
}

memory!([const K: usize] AssembledGalerkin<K>, |words| Self { h, instructions: _, nodes, newton: _ } => {
    words.fixed(*h);
    words.fixed(K as f64);
    // Which of them follows from the scene and the scheme.
    match nodes {
        Some(NodePasses::Blocks(nodes)) => words.part(nodes),
        Some(NodePasses::Points(nodes)) => words.part(nodes),
        None => words.fixed(-1.0),
    }
});

impl NodePasses {
    fn knows_the_past(&self) -> bool {
        match self {
            Self::Blocks(nodes) => nodes.past.is_known(),
            Self::Points(nodes) => nodes.past.is_known(),
        }
    }

    fn forget(&mut self) {
        match self {
            Self::Blocks(nodes) => nodes.past.forget(),
            Self::Points(nodes) => nodes.past.forget(),
        }
    }

    fn remember(&mut self) {
        match self {
            Self::Blocks(nodes) => nodes.remember(),
            Self::Points(nodes) => nodes.remember(),
        }
    }

    /// `|φ|` at the nodes where the last pass has ended.
    fn largest_residual(&mut self, assembly: &Assembly, instructions: InstructionSet, t: f64) -> f64 {
        match self {
            Self::Blocks(nodes) => nodes.largest_residual(assembly, instructions, t),
            Self::Points(nodes) => nodes.largest_residual(),
        }
    }
}
