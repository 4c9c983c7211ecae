//! Impulses of the nodes.

use super::nodes::{nothing, product};
use super::{LaneStep, Nodes};
use crate::mechanics::State;
use crate::scalar::Lanes;
use crate::system::MechanicalSystem;

impl<S: MechanicalSystem, const K: usize> LaneStep<S, K> {
    /// `h b (∂L/∂q + f)` at the nodes before the last.
    #[inline(always)]
    pub(super) fn free_impulses<const FUSED: bool>(
        &self,
        start: &State<S>,
        times: Lanes,
        points: &Nodes<S>,
        ways: &Nodes<S>,
    ) -> Nodes<S> {
        let mut forces = S::lagrangian_gradient(&self.constants, times, points, &nothing()).force;
        if S::STRUCTURE.forces.exist() {
            let mut velocities: Nodes<S> = nothing();
            if Self::FORCE_IS_ON_V {
                for i in 0..S::N_COORDINATES {
                    let v = Lanes::splat(start.v[i]);
                    velocities[i] = product::<K, FUSED>(&self.tables.velocities, ways[i], v);
                }
            }
            let mut inputs: S::PerInput<Lanes> = nothing();
            for i in 0..S::N_INPUTS {
                inputs[i] = Lanes::splat(start.inputs[i]);
            }
            let added = S::forces(&self.constants, times, points, &velocities, &inputs);
            for &i in S::STRUCTURE.forces.forced {
                forces[i] = forces[i] + added[i];
            }
        }
        for i in 0..S::N_COORDINATES {
            forces[i] = self.tables.weights * forces[i];
        }
        forces
    }

    /// Subtracts `Gᵀ Λ`.
    #[inline(always)]
    pub(super) fn subtract_constraint_force<const FUSED: bool>(
        &self,
        jacobian: &S::PerJacobianEntry<Lanes>,
        multipliers: &S::PerConstraint<Lanes>,
        impulses: &mut Nodes<S>,
    ) {
        S::for_each_slope(
            &self.constants,
            jacobian,
            #[inline(always)]
            |row, col, slope| {
                impulses[col] = (-slope).times_plus::<FUSED>(multipliers[row], impulses[col]);
            },
        );
    }
}
