//! What the first pass begins with: the ways of the nodes, and the multipliers that they imply.

use super::gram::applied;
use super::nodes::{nothing, product};
use super::{LaneStep, Nodes};
use crate::scalar::Lanes;
use crate::scheme::PAST;
use crate::system::MechanicalSystem;

/// Where the passes begin.
pub(crate) enum FirstGuess<'a, S: MechanicalSystem> {
    /// From the ways of the last steps, the last one first.
    Continued(&'a [Nodes<S>; PAST]),
    /// From the acceleration of the state at every node.
    Constant(&'a S::PerCoordinate<f64>),
}

impl<S: MechanicalSystem, const K: usize> LaneStep<S, K> {
    #[inline(always)]
    pub(super) fn first_ways<const FUSED: bool>(&self, first: &FirstGuess<'_, S>) -> Nodes<S> {
        let mut ways: Nodes<S> = nothing();
        match first {
            FirstGuess::Continued([last, before]) => {
                let [of_last, of_before] = &self.tables.prediction;
                for i in 0..S::N_COORDINATES {
                    let older = product::<K, FUSED>(of_before, before[i], Lanes::ZERO);
                    ways[i] = product::<K, FUSED>(of_last, last[i], older);
                }
            }
            FirstGuess::Constant(acceleration) => {
                let h = Lanes::splat(1.0 / self.tables.per_step);
                for i in 0..S::N_COORDINATES {
                    ways[i] = h * self.tables.weights * Lanes::splat(acceleration[i]);
                }
            }
        }
        ways
    }

    /// `Λⱼ = Sⱼ⁻¹ Gⱼ (h M⁻¹ kⱼ − yⱼ) / h`: the impulses of the constraints by which the other impulses `kⱼ` go the ways `yⱼ`.
    #[inline(always)]
    pub(super) fn implied_multipliers<const FUSED: bool>(
        &self,
        jacobian: &S::PerJacobianEntry<Lanes>,
        impulses: &Nodes<S>,
        ways: &Nodes<S>,
    ) -> S::PerConstraint<Lanes> {
        let free = applied::<S, FUSED>(&self.mobility, impulses);
        let per_step = Lanes::splat(self.tables.per_step);
        let mut multipliers: S::PerConstraint<Lanes> = nothing();
        S::for_each_slope(
            &self.constants,
            jacobian,
            #[inline(always)]
            |row, col, slope| {
                let held = (free[col] - ways[col]) * per_step;
                multipliers[row] = slope.times_plus::<FUSED>(held, multipliers[row]);
            },
        );
        self.start_gram.solve::<FUSED>(&mut multipliers);
        multipliers
    }
}
