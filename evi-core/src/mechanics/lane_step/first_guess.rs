//! What the first pass begins with: accelerations, and the multipliers that they imply.

use super::nodes::{nothing, product};
use super::{LaneStep, Nodes};
use crate::scalar::Lanes;
use crate::scheme::PAST;
use crate::system::MechanicalSystem;

/// Where the passes begin.
pub(crate) enum FirstGuess<'a, S: MechanicalSystem> {
    /// From the accelerations of the last steps, the last one first.
    Continued(&'a [Nodes<S>; PAST]),
    /// From the acceleration of the state at every node.
    Constant(&'a S::PerCoordinate<f64>),
}

impl<S: MechanicalSystem, const K: usize> LaneStep<S, K> {
    #[inline(always)]
    pub(super) fn first_accelerations<const FUSED: bool>(&self, first: &FirstGuess<'_, S>) -> Nodes<S> {
        let mut accelerations: Nodes<S> = nothing();
        match first {
            FirstGuess::Continued([last, before]) => {
                let [of_last, of_before] = &self.tables.prediction;
                for i in 0..S::N_COORDINATES {
                    let older = product::<K, FUSED>(of_before, before[i], Lanes::ZERO);
                    accelerations[i] = product::<K, FUSED>(of_last, last[i], older);
                }
            }
            FirstGuess::Constant(acceleration) => {
                for i in 0..S::N_COORDINATES {
                    accelerations[i] = Lanes::splat(acceleration[i]);
                }
            }
        }
        accelerations
    }

    /// `λⱼ = Sⱼ⁻¹ Gⱼ (M⁻¹ fⱼ − aⱼ)`: the multipliers of the accelerations `aⱼ` under the other forces `fⱼ`.
    #[inline(always)]
    pub(super) fn implied_multipliers<const FUSED: bool>(
        &self,
        jacobian: &S::PerJacobianEntry<Lanes>,
        forces: &Nodes<S>,
        accelerations: &Nodes<S>,
    ) -> S::PerConstraint<Lanes> {
        let free = self.accelerated::<FUSED>(forces);
        let mut multipliers: S::PerConstraint<Lanes> = nothing();
        for entry in S::STRUCTURE.jacobian.q {
            let slope = entry.value(self.constants.as_ref(), jacobian.as_ref());
            let held = free[entry.col] - accelerations[entry.col];
            multipliers[entry.row] = slope.times_plus::<FUSED>(held, multipliers[entry.row]);
        }
        self.start_gram.solve::<FUSED>(&mut multipliers);
        multipliers
    }
}
