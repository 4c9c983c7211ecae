//! Products with the inverse mass matrix, and the Gram matrices of the constraints.

use super::nodes::nothing;
use super::{LaneStep, Nodes};
use crate::linear::LaneGram;
use crate::mechanics::{AsMass, CoordinateMatrix, Coupling};
use crate::scalar::Lanes;
use crate::system::{Entry, MechanicalSystem};

/// Up to so many entries of the Jacobian, loops over pairs of them are unrolled.
const MOST_UNROLLED: usize = 16;

impl<S: MechanicalSystem, const K: usize> LaneStep<S, K> {
    /// Overwrites the Gram matrices of the nodes `1 .. K` with their factors.
    #[inline(always)]
    pub(super) fn factor_gram<const FUSED: bool>(&mut self, jacobian: &S::PerJacobianEntry<Lanes>) {
        add_gram::<S, FUSED>(&self.inverse_mass, &self.products, &self.constants, jacobian, &mut self.gram);
        self.gram.factor::<FUSED>();
    }

    /// Overwrites those of the nodes `0 .. K−1` with theirs.
    #[inline(always)]
    pub(super) fn factor_start_gram<const FUSED: bool>(&mut self, jacobian: &S::PerJacobianEntry<Lanes>) {
        let (mass, products, gram) = (&self.inverse_mass, &self.products, &mut self.start_gram);
        add_gram::<S, FUSED>(mass, products, &self.constants, jacobian, gram);
        gram.factor::<FUSED>();
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
        for entry in S::STRUCTURE.jacobian.q {
            let slope = entry.value(self.constants.as_ref(), jacobian.as_ref());
            sum[entry.col] = slope.times_plus::<FUSED>(inner[entry.row], sum[entry.col]);
        }
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
    products: &[[Entry; 2]],
    constants: &S::PerConstant<Lanes>,
    jacobian: &S::PerJacobianEntry<Lanes>,
    gram: &mut LaneGram<S>,
) {
    let entries = S::STRUCTURE.jacobian.q;
    let slope = |entry: &Entry| entry.value(constants.as_ref(), jacobian.as_ref());
    gram.clear();
    if <AsMass as Coupling<S>>::IS_DIAGONAL {
        if entries.len() <= MOST_UNROLLED {
            for a in entries {
                for b in entries {
                    if b.col == a.col && b.row <= a.row {
                        let scaled = Lanes::splat(inverse_mass.at(a.col, a.col)) * slope(a);
                        gram.add_product::<FUSED>(a.row, b.row, scaled, slope(b));
                    }
                }
            }
        } else {
            for [a, b] in products {
                let scaled = Lanes::splat(inverse_mass.at(a.col, a.col)) * slope(a);
                gram.add_product::<FUSED>(a.row, b.row, scaled, slope(b));
            }
        }
        return;
    }
    for col in 0..S::N_CONSTRAINTS {
        let mut direction: Nodes<S> = nothing();
        for entry in entries {
            if entry.row == col {
                for i in 0..S::N_COORDINATES {
                    let mass = Lanes::splat(inverse_mass.at(i, entry.col));
                    direction[i] = mass.times_plus::<FUSED>(slope(entry), direction[i]);
                }
            }
        }
        for entry in entries {
            if entry.row >= col {
                gram.add_product::<FUSED>(entry.row, col, slope(entry), direction[entry.col]);
            }
        }
    }
}
