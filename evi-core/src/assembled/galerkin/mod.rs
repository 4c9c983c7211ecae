//! Galerkin steps of assembled scenes with a constant mass of small blocks, by passes over all nodes at once, a node per lane: the equations and the
//! passes of [`Galerkin`](crate::integrator::Galerkin), with matrices of few nonzeros for every node.

mod landing;
mod passes;

use super::assembly::Point;
use super::scene::{ConstantInertia, PreparedScene};
use super::{AssembledScheme, AssembledState, AssembledStep, AssemblyError};
use crate::integrator::{Galerkin, IterationFailure, StepError, Symmetric as _, Tally};
use crate::linear::largest_magnitude;
use crate::newton::NotConverged;
use crate::scalar::InstructionSet;
use crate::scheme::{SchemeError, checked_step_size};
use passes::{FirstGuess, NodeStorage, Passes};

/// The one-step map of a [`Galerkin`] scheme, with the storage of its passes: nothing is allocated under a step.
///
/// A step whose passes do not converge from the past begins again from the acceleration of its start; one whose passes do not converge then has
/// failed.
pub struct AssembledGalerkin<const K: usize> {
    h: f64,
    instructions: InstructionSet,
    nodes: NodeStorage,
}

impl<const K: usize> AssembledScheme for Galerkin<K> {
    type Step = AssembledGalerkin<K>;

    fn prepare(&self, scene: &mut PreparedScene) -> Result<AssembledGalerkin<K>, AssemblyError> {
        let h = checked_step_size(self.step_size())?;
        let Some(ConstantInertia { gram, .. }) = &scene.inertia else {
            let requirement = "a constant mass matrix that couples the coordinates of one body only";
            return Err(SchemeError::UnsupportedStructure { scheme: "Galerkin", requirement }.into());
        };
        let nodes = NodeStorage::new::<K>(&scene.assembly, &gram.pattern, h);
        Ok(AssembledGalerkin { h, instructions: InstructionSet::detect(), nodes })
    }
}

impl<const K: usize> AssembledStep for AssembledGalerkin<K> {
    fn h(&self) -> f64 {
        self.h
    }

    fn forget(&mut self) {
        self.nodes.forget();
    }

    fn advance(
        &mut self,
        scene: &mut PreparedScene,
        state: &mut AssembledState,
        tally: &mut impl Tally,
    ) -> Result<(), StepError> {
        let passes = self.solve(scene, state, tally)?;
        tally.count_corrections(passes);
        self.land(scene, state, tally)?;
        self.nodes.remember();
        Ok(())
    }
}

impl<const K: usize> AssembledGalerkin<K> {
    /// The vector instructions of the passes, for reports.
    pub const fn instruction_set(&self) -> InstructionSet {
        self.instructions
    }

    /// Passes until they have converged: from the last steps, or from the state alone. Returns their number.
    fn solve(
        &mut self,
        scene: &mut PreparedScene,
        state: &AssembledState,
        tally: &mut impl Tally,
    ) -> Result<usize, StepError> {
        if self.nodes.knows_the_past() {
            if let Ok(passes) = self.pass(scene, state, FirstGuess::Continued) {
                return Ok(passes);
            }
            tally.count_restart();
            self.nodes.forget();
        }
        set_acceleration(scene, state).map_err(|matrix| StepError::Singular {
            t: state.t,
            correction: 0,
            matrix,
        })?;
        self.pass(scene, state, FirstGuess::Constant).map_err(|failure| {
            let residual = self.nodes.residuals().map(|lanes| lanes.largest());
            IterationFailure::from(failure).at(state.t, largest_magnitude(residual), 1.0)
        })
    }

    fn pass(
        &mut self,
        scene: &mut PreparedScene,
        state: &AssembledState,
        first: FirstGuess,
    ) -> Result<usize, NotConverged> {
        let Self { instructions, nodes, .. } = self;
        instructions.run(Passes::<K> { nodes, scene, start: state, first, instructions: *instructions })
    }
}

/// Overwrites `space.moved` with the acceleration of the state: `M a + Gᵀ λ = ∂L/∂q + f`, `G a = −γ`.
fn set_acceleration(
    scene: &mut PreparedScene,
    state: &AssembledState,
) -> Result<(), crate::linear::SingularMatrix> {
    let PreparedScene { assembly, inertia, space, .. } = scene;
    let Some(ConstantInertia { mass, gram }) = inertia else { return Ok(()) };
    let at = Point { t: state.t, q: &state.q, v: &state.v };
    assembly.force(at, &mut space.pull);
    mass.inverse_times(&space.pull, &mut space.moved);
    if assembly.n_constraints == 0 {
        return Ok(());
    }
    assembly.constraint_derivatives(state.t, &state.q, &mut space.at_start);
    gram.factor(mass, &space.at_start.slopes).map_err(|(_, matrix)| matrix)?;
    assembly.curvature(at, &mut space.rates);
    assembly.add_rates(&space.at_start.slopes, &space.moved, &mut space.rates);
    gram.solve(&mut space.rates);
    super::assembly::subtract_pull::<f64, false>(
        &assembly.slots,
        &space.at_start.slopes,
        &space.rates,
        &mut space.pull,
    );
    mass.inverse_times(&space.pull, &mut space.moved);
    Ok(())
}
