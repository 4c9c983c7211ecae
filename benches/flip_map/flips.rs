//! When a rod swings over the top.

use std::ops::ControlFlow;

use evi_core::columns::{Column, Table};
use evi_core::ensemble::{Gather, LaneMask, LaneState, Section, Sight};
use evi_core::scalar::Lanes;
use evi_examples::DoublePendulum;

/// The rods at the upper vertical.
pub(crate) struct Flips;

/// The rods as vectors, from the pivot outwards.
fn rods(q: &[Lanes; 4]) -> [[Lanes; 2]; 2] {
    [[q[0], q[1]], [q[2] - q[0], q[3] - q[1]]]
}

impl Section<DoublePendulum> for Flips {
    /// Changes its sign where a rod is vertical.
    #[inline(always)]
    fn value(&self, _t: Lanes, q: &[Lanes; 4], _v: &[Lanes; 4]) -> Lanes {
        let [inner, outer] = rods(q);
        inner[0] * outer[0]
    }

    /// Where a rod has changed sides above its joint.
    #[inline(always)]
    fn crossed(&self, before: &LaneState<DoublePendulum>, after: &LaneState<DoublePendulum>) -> LaneMask {
        let mut flipped = LaneMask::NONE;
        for (before, after) in rods(before.q()).into_iter().zip(rods(after.q())) {
            let sides = LaneMask::below(before[0] * after[0], Lanes::ZERO);
            flipped = flipped.or(sides.and(LaneMask::below(Lanes::ZERO, after[1])));
        }
        flipped
    }
}

/// Gathers the time of every member's first flip, and moves it no further.
pub(crate) struct FlipTimes;

impl Gather<DoublePendulum> for FlipTimes {
    type Part = Table;

    fn blank(&self) -> Table {
        Table::new(vec![Column::index("member"), Column::number("t")])
    }

    fn cross(&self, part: &mut Table, sight: &Sight<'_, DoublePendulum>) -> ControlFlow<()> {
        part.push([sight.member as f64, sight.state.t()]);
        ControlFlow::Break(())
    }
}
