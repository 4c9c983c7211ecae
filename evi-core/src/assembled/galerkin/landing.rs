//! The end of a Galerkin step: on the constraints and on the hidden ones, to round-off.

use super::super::AssembledState;
use super::super::assembly::Point;
use super::super::scene::PreparedScene;
use super::passes::NodeStorage;
use super::{AssembledGalerkin, NodePasses, Solution};
use crate::integrator::{StepError, Tally};

impl<const K: usize> AssembledGalerkin<K> {
    /// Overwrites `state` with the end that was found: the last point, moved onto the constraints once more, and the momentum `p₀ + h Σ bⱼ Fⱼ`, projected
    /// there.
    pub(super) fn land(
        &mut self,
        solution: Solution,
        scene: &mut PreparedScene,
        state: &mut AssembledState,
        tally: &mut impl Tally,
    ) -> Result<(), StepError> {
        let t = state.t + self.h;
        let failed = |cause| StepError::Projection { t, cause };
        let blocks = match (&self.nodes, solution) {
            (Some(NodePasses::Blocks(nodes)), Solution::ByPasses) => Some(nodes),
            (Some(NodePasses::Points(nodes)), Solution::ByPasses) => {
                nodes.arrive::<K>(&mut scene.space, state);
                None
            }
            (_, Solution::ByNewton) | (None, _) => None,
        };
        if let Some(nodes) = blocks {
            // The difference from the start, not the last lane of a rounded position.
            for (i, moved) in scene.space.moved.iter_mut().enumerate() {
                *moved = nodes.difference::<K>(i, state.v[i]);
            }
        }
        for ((q, start), moved) in scene.space.q.iter_mut().zip(&state.q).zip(&scene.space.moved) {
            *q = start + moved;
        }
        scene.meet_constraints(t).map_err(failed)?;
        if let Some(nodes) = blocks {
            set_momentum(nodes, scene, state, t);
        }
        scene.space.impulse.fill(0.0);
        scene.project(t, tally).map_err(failed)?;
        scene.reach(state, t)
    }
}

/// Overwrites `space.p` with `p₀ + h Σ bⱼ Fⱼ` of passes that know accelerations, with the force where the step ends.
fn set_momentum(nodes: &NodeStorage, scene: &mut PreparedScene, start: &AssembledState, t: f64) {
    let PreparedScene { assembly, space, .. } = scene;
    let tables = &nodes.tables;
    space.v.copy_from_slice(&start.v);
    if assembly.traits.force_is_on_v {
        for (v, &acceleration) in space.v.iter_mut().zip(&nodes.accelerations) {
            *v += (tables.end_velocity * acceleration).sum();
        }
    }
    assembly.force(Point { t, q: &space.q, v: &space.v }, &mut space.force);
    for (i, p) in space.p.iter_mut().enumerate() {
        let gain = tables.last_weight * space.force[i] + (tables.weights * nodes.forces[i]).sum();
        *p = start.p[i] + gain;
    }
}
