//! Where the passes over the points of a Galerkin step begin.

use super::lane_step::{nothing, product};
use super::{Acceleration, State};
use crate::scalar::Lanes;
use crate::scheme::{Columns, PAST, PointTables};
use crate::system::MechanicalSystem;

/// One value per coordinate at every node.
pub(super) type Nodes<S> = <S as MechanicalSystem>::PerCoordinate<Lanes>;

/// One value per constraint at every node.
pub(super) type NodeMultipliers<S> = <S as MechanicalSystem>::PerConstraint<Lanes>;

/// Velocities at the nodes `1 .. K` and multipliers at the nodes before the last.
pub(crate) struct NodeMotion<S: MechanicalSystem> {
    pub(crate) velocities: Nodes<S>,
    pub(crate) multipliers: NodeMultipliers<S>,
}

// Written out, since a derive would demand the same of `S`.
impl<S: MechanicalSystem> Clone for NodeMotion<S> {
    fn clone(&self) -> Self {
        Self { velocities: self.velocities.clone(), multipliers: self.multipliers.clone() }
    }
}

impl<S: MechanicalSystem> NodeMotion<S> {
    /// Nothing moves.
    pub(crate) fn rest() -> Self {
        Self { velocities: nothing(), multipliers: nothing() }
    }
}

/// Where the passes begin.
pub(crate) enum PointGuess<'a, S: MechanicalSystem> {
    /// From the last steps, the last one first.
    Continued(&'a [NodeMotion<S>; PAST]),
    /// From the acceleration and the multipliers of the state.
    Constant(&'a Acceleration<S>),
}

/// Where the passes begin: differences, and the velocities whose integrals they are.
pub(super) struct FirstPoints<S: MechanicalSystem> {
    pub(super) differences: Nodes<S>,
    pub(super) velocities: Nodes<S>,
    pub(super) multipliers: NodeMultipliers<S>,
}

impl<S: MechanicalSystem> PointGuess<'_, S> {
    /// Where the passes begin.
    #[inline(always)]
    pub(super) fn first<const K: usize, const FUSED: bool>(
        &self,
        tables: &PointTables,
        start: &State<S>,
    ) -> FirstPoints<S> {
        let mut first =
            FirstPoints::<S> { differences: nothing(), velocities: nothing(), multipliers: nothing() };
        match self {
            Self::Continued([last, before]) => {
                for i in 0..S::N_COORDINATES {
                    first.velocities[i] =
                        predicted::<K, FUSED>(&tables.prediction, [last.velocities[i], before.velocities[i]]);
                }
                for c in 0..S::N_CONSTRAINTS {
                    first.multipliers[c] = predicted::<K, FUSED>(
                        &tables.lobatto.prediction,
                        [last.multipliers[c], before.multipliers[c]],
                    );
                }
            }
            Self::Constant(at_start) => {
                for i in 0..S::N_COORDINATES {
                    let change = tables.lobatto.nodes * Lanes::splat(at_start.acceleration[i]);
                    first.velocities[i] = Lanes::splat(start.v[i]) + change;
                }
                for c in 0..S::N_CONSTRAINTS {
                    first.multipliers[c] = Lanes::splat(at_start.multipliers[c]);
                }
            }
        }
        for i in 0..S::N_COORDINATES {
            first.differences[i] = product::<K, FUSED>(&tables.ways, first.velocities[i], Lanes::ZERO);
        }
        first
    }
}

/// What follows the values of the last step and of the one before.
#[inline(always)]
fn predicted<const K: usize, const FUSED: bool>(
    [of_last, of_before]: &[Columns; PAST],
    [last, before]: [Lanes; PAST],
) -> Lanes {
    let older = product::<K, FUSED>(of_before, before, Lanes::ZERO);
    product::<K, FUSED>(of_last, last, older)
}
