//! The end of a step.

use super::LaneStep;
use crate::array::Array;
use crate::mechanics::{ForcePoint, Mechanics, Points, State};
use crate::system::MechanicalSystem;

/// The end of a step before the constraints are met there to round-off.
pub(crate) struct LaneEnd<S: MechanicalSystem> {
    /// `q_K − q₀`.
    pub(crate) difference: S::PerCoordinate<f64>,
    /// Passes taken.
    pub(crate) passes: usize,
}

impl<S: MechanicalSystem, const K: usize> LaneStep<S, K> {
    /// `M⁻¹ F` at one node.
    #[inline]
    pub(crate) fn inverse_mass_times(&self, force: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64> {
        self.inverse_mass.times(|i| force[i])
    }

    /// `p⁻ − p₀ = Σⱼ kⱼ`, with the force at the end of the step, but for that of the constraints there, at `q_end`.
    pub(crate) fn momentum_gain(
        &self,
        mechanics: &Mechanics<S>,
        (start, t_end): (&State<S>, f64),
        q_end: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        let mut velocity = start.v.clone();
        if Self::FORCE_IS_ON_V {
            for i in 0..S::N_COORDINATES {
                velocity[i] += (self.tables.end_velocity * self.ways[i]).sum();
            }
        }
        let mut gain = S::lagrangian_gradient(&mechanics.constants, t_end, q_end, &velocity).force;
        mechanics
            .add_force(ForcePoint { t: t_end, q: q_end, v: &velocity, inputs: &start.inputs }, &mut gain);
        for i in 0..S::N_COORDINATES {
            gain[i] = self.tables.last_weight * gain[i] + self.impulses[i].sum();
        }
        gain
    }

    /// The points of the last passes, of size `h` and from `start`: as the equations of all points have them, which know `h Λ`.
    pub(crate) fn points_found(&self, start: &State<S>, h: f64) -> Points<S, K> {
        let differences = self.differences::<false>(&self.ways, &self.inertial(start));
        let difference = |a: usize| Array::from_fn(|i| differences[i].to_array()[a]);
        let impulse = |a: usize| {
            let lane = if a == 0 { K - 1 } else { a - 1 };
            Array::from_fn(|c| h * self.multipliers[c].to_array()[lane])
        };
        Points { differences: core::array::from_fn(difference), impulses: core::array::from_fn(impulse) }
    }
}
