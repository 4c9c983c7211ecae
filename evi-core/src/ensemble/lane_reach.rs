//! What steps of eight members are found to the round-off of: as in `mechanics/reach.rs`, member by member.

use super::galerkin_lanes::Vector;
use super::lane_state::LaneState;
use super::mask::LaneMask;
use crate::mechanics::reach::{CLOSEST, LONG};
use crate::newton::LIGHT;
use crate::scalar::{Lanes, Scalar};
use crate::system::MechanicalSystem;

/// What lengths are compared in.
pub(super) struct LaneReach<S: MechanicalSystem> {
    /// One over the reach, in the metric of the masses.
    pub(super) per_reach: Lanes,
    /// What a coordinate is multiplied with: its displacements are then in that metric, those of a light one in plain numbers.
    pub(super) units: Vector<S>,
}

impl<S: MechanicalSystem> LaneReach<S> {
    /// Of steps of size `h` from `state`, where `units` are roots of masses.
    #[inline(always)]
    pub(super) fn of(units: &Vector<S>, h: f64, state: &LaneState<S>) -> Self {
        let h = Lanes::splat(h.abs());
        let [mut here, mut way, mut plain_here, mut plain_way] = [Lanes::ZERO; 4];
        for i in 0..S::N_COORDINATES {
            let (q, moved) = (state.q[i].abs(), h * state.v[i].abs());
            here = (units[i] * q).larger(here);
            way = (units[i] * moved).larger(way);
            plain_here = q.larger(plain_here);
            plain_way = moved.larger(plain_way);
        }
        let (metric, plain) = (reach(here, way), reach(plain_here, plain_way));
        let least = Lanes::splat(LIGHT) * metric / plain;
        let mut units = units.clone();
        for i in 0..S::N_COORDINATES {
            units[i] = units[i].larger(least);
        }
        Self { per_reach: Lanes::splat(1.0) / metric, units }
    }
}

#[inline(always)]
fn reach(here: Lanes, way: Lanes) -> Lanes {
    let here = here + way;
    let long = Lanes::splat(LONG) * way;
    let limited = LaneMask::below(long, here).select(long, here);
    limited.larger(Lanes::splat(CLOSEST) * here)
}
