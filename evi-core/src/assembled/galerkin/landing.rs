//! The end of a Galerkin step: on the constraints and on the hidden ones, to round-off.

use super::super::assembly::{Point, subtract_pull};
use super::super::scene::{ConstantInertia, PreparedScene};
use super::super::{AssembledState, failure};
use super::AssembledGalerkin;
use crate::integrator::{StepError, Tally};
use crate::linear::SingularMatrix;
use crate::mechanics::ProjectionError;

impl<const K: usize> AssembledGalerkin<K> {
    /// Overwrites `state` with the end that the passes have found: the last point, moved onto the constraints once more, and the momentum
    /// `p₀ + h Σ bⱼ Fⱼ`, projected there.
    pub(super) fn land(
        &mut self,
        scene: &mut PreparedScene,
        state: &mut AssembledState,
        tally: &mut impl Tally,
    ) -> Result<(), StepError> {
        let t = state.t + self.h;
        let PreparedScene { assembly, inertia, space, .. } = &mut *scene;
        let Some(ConstantInertia { mass, gram }) = inertia else {
            return Err(failure::singular(state.t, SingularMatrix { pivot_ratio: f64::NAN }));
        };
        let (tables, nodes) = (&self.nodes.tables, &self.nodes);
        // The difference from the start, not the last lane of a rounded position.
        for i in 0..assembly.n_coordinates {
            space.q[i] = state.q[i] + nodes.difference::<K>(i, state.v[i]);
        }
        if assembly.n_constraints > 0 {
            assembly.constraint_derivatives(t, &space.q, &mut space.at_end);
            gram.factor(mass, &space.at_end.slopes).map_err(|(_, matrix)| StepError::Projection {
                t,
                cause: ProjectionError::Singular(matrix),
            })?;
            space.rates.copy_from_slice(&space.at_end.values);
            gram.solve(&mut space.rates);
            space.pull.fill(0.0);
            subtract_pull::<f64, false>(&assembly.slots, &space.at_end.slopes, &space.rates, &mut space.pull);
            mass.inverse_times(&space.pull, &mut space.moved);
            space.q.iter_mut().zip(&space.moved).for_each(|(q, moved)| *q += moved);
            assembly.constraint_derivatives(t, &space.q, &mut space.at_end);
        }
        space.v.copy_from_slice(&state.v);
        if assembly.traits.force_is_on_v {
            for (v, &acceleration) in space.v.iter_mut().zip(&nodes.accelerations) {
                *v += (tables.end_velocity * acceleration).sum();
            }
        }
        let at = Point { t, q: &space.q, v: &space.v };
        assembly.force(at, &mut space.force);
        for (i, p) in space.p.iter_mut().enumerate() {
            let gain = tables.last_weight * space.force[i] + (tables.weights * nodes.forces[i]).sum();
            *p = state.p[i] + gain;
        }
        space.impulse.fill(0.0);
        scene.project(t, tally).map_err(|cause| StepError::Projection { t, cause })?;
        scene.reach(state, t)
    }
}
