//! The ends of Galerkin steps of eight members: on the constraints and on the hidden ones to round-off.

use super::galerkin_lanes::{GalerkinLanes, Multipliers, Vector};
use super::lane_state::{LaneState, nothing};
use super::mask::LaneMask;
use super::projection::project;
use crate::integrator::ROUGH;
use crate::scalar::{Lanes, Scalar};
use crate::system::MechanicalSystem;

/// Ends of steps are on the constraints to round-off; what is farther beside them than this share of their terms has been projected with a matrix
/// that does not determine it.
const BESIDE: f64 = 1e-3;
/// Of the configuration, a length far above round-off and far below a step.
const SLIGHT: f64 = 1e-10;

impl<S: MechanicalSystem, const K: usize> GalerkinLanes<S, K> {
    /// The lanes whose residuals are farther beside the constraints than can be.
    #[inline(always)]
    fn beside(
        &self,
        jacobian: &S::PerJacobianEntry<Lanes>,
        reach: &Vector<S>,
        residual: &Multipliers<S>,
    ) -> LaneMask {
        let scale = self.slopes.scale(jacobian, reach);
        let mut on = LaneMask::ALL;
        for c in 0..S::N_CONSTRAINTS {
            on = on.and(LaneMask::at_most(residual[c].abs(), Lanes::splat(BESIDE) * scale[c]));
        }
        LaneMask::ALL.without(on)
    }

    /// The ends of the steps: on the constraints and on the hidden ones to round-off.
    #[inline(always)]
    pub(super) fn land<const FUSED: bool>(
        &mut self,
        state: &mut LaneState<S>,
        active: LaneMask,
        mut failed: LaneMask,
    ) -> LaneMask {
        let t = Lanes::splat(state.t + self.h);
        let mut q = self.positions[K - 1].clone();
        let mut slight = Lanes::ZERO;
        for i in 0..S::N_COORDINATES {
            slight = q[i].abs().larger(slight);
        }
        slight = Lanes::splat(SLIGHT) * slight;
        let mut way: Vector<S> = nothing();
        for i in 0..S::N_COORDINATES {
            way[i] = (q[i] - state.q[i]).abs() + slight;
        }
        if Self::IS_CONSTRAINED {
            let (mut shares, jacobian) = S::constraint_derivatives(self.slopes.constants(), t, &q);
            self.slopes.gram::<_, FUSED>(&jacobian, &self.legendre.inverse_mass, &jacobian, &mut self.gram);
            self.gram.factor::<FUSED>();
            self.gram.solve::<FUSED>(&mut shares);
            let pull = self.slopes.pull::<FUSED>(&jacobian, &shares);
            let displacement = self.legendre.inverse_mass.times::<FUSED>(&pull);
            for i in 0..S::N_COORDINATES {
                q[i] = q[i] - displacement[i];
            }
            if self.tolerance > ROUGH {
                let mut shares = S::constraints(self.slopes.constants(), t, &q);
                self.gram.solve::<FUSED>(&mut shares);
                let pull = self.slopes.pull::<FUSED>(&jacobian, &shares);
                let displacement = self.legendre.inverse_mass.times::<FUSED>(&pull);
                for i in 0..S::N_COORDINATES {
                    q[i] = q[i] - displacement[i];
                }
            }
        }
        let end_force = S::lagrangian_gradient(self.slopes.constants(), t, &q, &nothing()).force;
        let mut momentum = state.p.clone();
        for i in 0..S::N_COORDINATES {
            let mut gain = Lanes::splat(self.tables.last_weight) * end_force[i];
            for j in 0..K {
                gain = Lanes::splat(self.tables.weights[j]).times_plus::<FUSED>(self.forces[j][i], gain);
            }
            momentum[i] = momentum[i] + gain;
        }
        if !Self::IS_CONSTRAINED {
            let v = self.legendre.velocity::<FUSED>(&momentum);
            return state.replace(q, v, momentum, active, failed);
        }
        let (left, jacobian) = S::constraint_derivatives(self.slopes.constants(), t, &q);
        let projected =
            project::<S, FUSED>(&self.slopes, &self.legendre, &self.gram, &jacobian, momentum, active);
        let rate = self.slopes.rate::<FUSED>(&jacobian, &projected.v);
        let (mut reach, mut speeds): (Vector<S>, Vector<S>) = (nothing(), nothing());
        let per_h = Lanes::splat(1.0 / self.h.abs());
        for i in 0..S::N_COORDINATES {
            reach[i] = q[i].abs() + way[i];
            speeds[i] = way[i].times_plus::<FUSED>(per_h, projected.v[i].abs());
        }
        let beside = self.beside(&jacobian, &reach, &left).or(self.beside(&jacobian, &speeds, &rate));
        failed = failed.or(beside.and(active));
        state.replace(q, projected.v, projected.p, active, failed)
    }
}
