//! Values at all nodes, and products with tables.

use crate::array::Array;
use crate::mechanics::State;
use crate::scalar::Lanes;
use crate::scheme::Columns;
use crate::system::MechanicalSystem;

/// One value per coordinate at every node.
pub(super) type Nodes<S> = <S as MechanicalSystem>::PerCoordinate<Lanes>;

/// Zeros; written as a copy, since what builds an array from a function is not always inlined.
#[inline(always)]
pub(in crate::mechanics) fn nothing<A: Array<Lanes>>() -> A {
    A::filled(Lanes::ZERO)
}

/// The product of a table of `K` columns with a vector, added to `start`: two sums that do not wait for each other.
#[inline(always)]
pub(crate) fn product<const K: usize, const FUSED: bool>(columns: &Columns, x: Lanes, start: Lanes) -> Lanes {
    product_of_stored::<K, FUSED>(columns, x.stored(), start)
}

/// The same for a vector that lies in memory, as those of large scenes do.
#[inline(always)]
pub(crate) fn product_of_stored<const K: usize, const FUSED: bool>(
    columns: &Columns,
    x: Lanes,
    start: Lanes,
) -> Lanes {
    const SUMS: usize = 2;
    let x = x.to_array();
    let mut sums = [start, Lanes::ZERO];
    for col in 0..K {
        let factor = Lanes::splat(x[col]);
        let sum = &mut sums[col % SUMS];
        *sum = if 0 < col && col < SUMS {
            columns[col] * factor
        } else {
            columns[col].times_plus::<FUSED>(factor, *sum)
        };
    }
    sums[0] + sums[1]
}

/// `q₀ + d`.
#[inline(always)]
pub(in crate::mechanics) fn from_start<S: MechanicalSystem>(
    start: &State<S>,
    differences: &Nodes<S>,
) -> Nodes<S> {
    let mut positions: Nodes<S> = nothing();
    for i in 0..S::N_COORDINATES {
        positions[i] = Lanes::splat(start.q[i]) + differences[i];
    }
    positions
}
