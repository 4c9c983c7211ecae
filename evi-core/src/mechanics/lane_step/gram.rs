//! Products with the inverse mass matrix, and the Gram matrices of the constraints.

use super::nodes::nothing;
use super::{LaneStep, Nodes};
use crate::linear::LaneGram;
use crate::mechanics::{AsMass, CoordinateMatrix, Coupling};
use crate::scalar::Lanes;
use crate::system::MechanicalSystem;

impl<S: MechanicalSystem, const K: usize> LaneStep<S, K> {
    /// Overwrites the Gram matrices of the nodes `1 .. K` with their factors.
    #[inline(always)]
    pub(super) fn factor_gram<const FUSED: bool>(&mut self, jacobian: &S::PerJacobianEntry<Lanes>) {
        add_gram::<S, FUSED>(&self.inverse_mass, &self.constants, jacobian, &mut self.gram);
        self.gram.factor::<FUSED>();
    }

    /// Overwrites those of the nodes `0 .. K−1` with theirs.
    #[inline(always)]
    pub(super) fn factor_start_gram<const FUSED: bool>(&mut self, jacobian: &S::PerJacobianEntry<Lanes>) {
        add_gram::<S, FUSED>(&self.inverse_mass, &self.constants, jacobian, &mut self.start_gram);
        self.start_gram.factor::<FUSED>();
    }

    /// `M⁻¹ Gᵀ η` within the step, and nothing at its end, where no force is evaluated.
    #[inline(always)]
    pub(super) fn displacements<const FUSED: bool>(
        &self,
        jacobian: &S::PerJacobianEntry<Lanes>,
        shares: &S::PerConstraint<Lanes>,
    ) -> Nodes<S> {
        let mut inner: S::PerConstraint<Lanes> = nothing();
        for c in 0..S::N_CONSTRAINTS {
            inner[c] = shares[c] * self.tables.inner;
        }
        let mut sum: Nodes<S> = nothing();
        S::for_each_slope(
            &self.constants,
            jacobian,
            #[inline(always)]
            |row, col, slope| sum[col] = slope.times_plus::<FUSED>(inner[row], sum[col]),
        );
        applied::<S, FUSED>(&self.inverse_mass, &sum)
    }
}

/// `B x` at every node, for a matrix `B` that couples what the mass matrix couples.
#[inline(always)]
pub(super) fn applied<S: MechanicalSystem, const FUSED: bool>(
    matrix: &CoordinateMatrix<S, AsMass>,
    x: &Nodes<S>,
) -> Nodes<S> {
    let mut products: Nodes<S> = nothing();
    for i in 0..S::N_COORDINATES {
        if <AsMass as Coupling<S>>::IS_DIAGONAL {
            products[i] = Lanes::splat(matrix.at(i, i)) * x[i];
        } else {
            for k in 0..S::N_COORDINATES {
                products[i] = Lanes::splat(matrix.at(i, k)).times_plus::<FUSED>(x[k], products[i]);
            }
        }
    }
    products
}

/// Overwrites `gram` with `G M⁻¹ Gᵀ`, its lower triangle.
#[inline(always)]
fn add_gram<S: MechanicalSystem, const FUSED: bool>(
    inverse_mass: &CoordinateMatrix<S, AsMass>,
    constants: &S::PerConstant<Lanes>,
    jacobian: &S::PerJacobianEntry<Lanes>,
    gram: &mut LaneGram<S>,
) {
    gram.clear();
    if <AsMass as Coupling<S>>::IS_DIAGONAL {
        S::for_each_gram_product(
            constants,
            jacobian,
            #[inline(always)]
            |row, other, col, slope, other_slope| {
                let scaled = Lanes::splat(inverse_mass.at(col, col)) * slope;
                gram.add_product::<FUSED>(row, other, scaled, other_slope);
            },
        );
        return;
    }
    for other in 0..S::N_CONSTRAINTS {
        let mut direction: Nodes<S> = nothing();
        S::for_each_slope(
            constants,
            jacobian,
            #[inline(always)]
            |row, col, slope| {
                if row == other {
                    for i in 0..S::N_COORDINATES {
                        let mass = Lanes::splat(inverse_mass.at(i, col));
                        direction[i] = mass.times_plus::<FUSED>(slope, direction[i]);
                    }
                }
            },
        );
        S::for_each_slope(
            constants,
            jacobian,
            #[inline(always)]
            |row, col, slope| {
                if row >= other {
                    gram.add_product::<FUSED>(row, other, slope, direction[col]);
                }
            },
        );
    }
}
