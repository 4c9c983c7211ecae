//! The matrices of eight members' equations over coordinates and constraints, `[A G₀ᵀ; G₁ 0]`, factored side by side.

use super::lane_state::nothing;
use crate::array::Array;
use crate::linear::constraint_index;
use crate::scalar::Lanes;
use crate::system::MechanicalSystem;

/// One number per unknown of eight members.
pub(super) type Unknowns<S> = <S as MechanicalSystem>::PerUnknown<Lanes>;

/// Eight matrices, or their factors: `L` below the diagonal, `U` above it and inverted on it.
///
/// Coordinates are eliminated before constraints, without pivoting: a block `A` that is no small change of a mass matrix gives numbers that are not
/// finite, or corrections that do not converge, and the member is taken alone.
pub(super) struct LaneKkt<S: MechanicalSystem> {
    rows: S::PerUnknown<Unknowns<S>>,
}

impl<S: MechanicalSystem> LaneKkt<S> {
    const DIMENSION: usize = S::N_COORDINATES + S::N_CONSTRAINTS;

    pub(super) fn new() -> Self {
        Self { rows: Array::from_fn(|_| nothing()) }
    }

    /// Sets all entries to zero.
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        for row in 0..Self::DIMENSION {
            self.rows[row] = nothing();
        }
    }

    /// Adds to an entry of the block of the coordinates.
    #[inline(always)]
    pub(super) fn add(&mut self, row: usize, col: usize, value: Lanes) {
        self.rows[row][col] = self.rows[row][col] + value;
    }

    /// Sets the blocks of the constraints: `G₀ᵀ` above, `G₁` below.
    #[inline(always)]
    pub(super) fn set_constraints(
        &mut self,
        constants: &S::PerConstant<Lanes>,
        above: &S::PerJacobianEntry<Lanes>,
        below: &S::PerJacobianEntry<Lanes>,
    ) {
        let rows = &mut self.rows;
        S::for_each_slope(
            constants,
            above,
            #[inline(always)]
            |row, col, slope| rows[col][constraint_index::<S>(row)] = slope,
        );
        S::for_each_slope(
            constants,
            below,
            #[inline(always)]
            |row, col, slope| rows[constraint_index::<S>(row)][col] = slope,
        );
    }

    /// Overwrites the matrices with their factors.
    #[inline(always)]
    pub(super) fn factor<const FUSED: bool>(&mut self) {
        for k in 0..Self::DIMENSION {
            let inverse = Lanes::splat(1.0) / self.rows[k][k];
            self.rows[k][k] = inverse;
            let pivots = self.rows[k].clone();
            for row in k + 1..Self::DIMENSION {
                let multiplier = self.rows[row][k] * inverse;
                self.rows[row][k] = multiplier;
                for col in k + 1..Self::DIMENSION {
                    self.rows[row][col] = (-multiplier).times_plus::<FUSED>(pivots[col], self.rows[row][col]);
                }
            }
        }
    }

    /// Overwrites right-hand sides with solutions.
    #[inline(always)]
    pub(super) fn solve<const FUSED: bool>(&self, rhs: &mut Unknowns<S>) {
        for row in 0..Self::DIMENSION {
            for col in 0..row {
                rhs[row] = (-self.rows[row][col]).times_plus::<FUSED>(rhs[col], rhs[row]);
            }
        }
        for row in (0..Self::DIMENSION).rev() {
            for col in row + 1..Self::DIMENSION {
                rhs[row] = (-self.rows[row][col]).times_plus::<FUSED>(rhs[col], rhs[row]);
            }
            rhs[row] = rhs[row] * self.rows[row][row];
        }
    }
}
