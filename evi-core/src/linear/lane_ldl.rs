//! Symmetric matrices of eight nodes at once, a node per lane: factored without pivoting, within their envelope.

use core::marker::PhantomData;

use crate::array::Array;
use crate::scalar::{Lanes, Scalar};
use crate::system::MechanicalSystem;

/// Gram matrices of the constraints, `G M⁻¹ Gᵀ`.
pub(crate) type LaneGram<S> = LaneLdl<
    <S as MechanicalSystem>::PerConstraint<Lanes>,
    <S as MechanicalSystem>::PerConstraint<<S as MechanicalSystem>::PerConstraint<Lanes>>,
    <S as MechanicalSystem>::PerConstraint<usize>,
>;

/// Mass matrices.
pub(crate) type LaneMass<S> = LaneLdl<
    <S as MechanicalSystem>::PerCoordinate<Lanes>,
    <S as MechanicalSystem>::PerCoordinate<<S as MechanicalSystem>::PerCoordinate<Lanes>>,
    <S as MechanicalSystem>::PerCoordinate<usize>,
>;

/// `S = L D Lᵀ` by rows: `L` below the diagonal, `1/D` on it (Golub & Van Loan, Matrix Computations, 4th ed., sec. 4.1.2).
///
/// Nothing is left of the first nonzero of a row, nor does elimination put anything there (ibid., sec. 4.3): on a chain of constraints the
/// cost is proportional to their number. A singular matrix gives numbers that are not finite: the caller's iteration does not
/// converge then.
pub(crate) struct LaneLdl<V, M, F> {
    rows: M,
    /// Column of the first nonzero of every row.
    first: F,
    vector: PhantomData<V>,
}

impl<V: Array<Lanes>, M: Array<V>, F: Array<usize>> LaneLdl<V, M, F> {
    /// Up to here elimination is unrolled, and a matrix is full.
    const UNROLLED: bool = V::LEN <= 4;

    /// For matrices with nonzeros at the given places, `(smaller, larger)` index, or everywhere.
    pub(crate) fn new(nonzeros: impl IntoIterator<Item = (usize, usize)>, is_full: bool) -> Self {
        let mut first = F::from_fn(|row| if is_full { 0 } else { row });
        for (smaller, larger) in nonzeros {
            first[larger] = first[larger].min(smaller);
        }
        Self { rows: M::from_fn(|_| V::from_fn(|_| Lanes::ZERO)), first, vector: PhantomData }
    }

    #[inline(always)]
    fn first(&self, row: usize) -> usize {
        if Self::UNROLLED { 0 } else { self.first[row] }
    }

    /// Sets the matrix to zero.
    #[inline(always)]
    pub(crate) fn clear(&mut self) {
        for row in 0..V::LEN {
            for col in self.first(row)..=row {
                self.rows[row][col] = Lanes::ZERO;
            }
        }
    }

    /// Sets the entry at `(row, col)`, `row ≥ col`.
    #[inline(always)]
    pub(crate) fn set(&mut self, row: usize, col: usize, value: Lanes) {
        self.rows[row][col] = value;
    }

    /// Adds `a · b` to the entry at `(row, col)`, `row ≥ col`.
    #[inline(always)]
    pub(crate) fn add_product<const FUSED: bool>(&mut self, row: usize, col: usize, a: Lanes, b: Lanes) {
        self.rows[row][col] = a.times_plus::<FUSED>(b, self.rows[row][col]);
    }

    /// Overwrites the matrix with its factors.
    #[inline(always)]
    pub(crate) fn factor<const FUSED: bool>(&mut self) {
        self.factor_showing::<FUSED>(|_, _| {});
    }

    /// The same, and shows the entries of `D`, `(row, entry)`.
    #[inline(always)]
    fn factor_showing<const FUSED: bool>(&mut self, mut pivot_of: impl FnMut(usize, Lanes)) {
        for row in 0..V::LEN {
            let start = self.first(row);
            for col in start..row {
                let mut entry = self.rows[row][col];
                for k in start.max(self.first(col))..col {
                    entry = (-self.rows[row][k]).times_plus::<FUSED>(self.rows[col][k], entry);
                }
                self.rows[row][col] = entry;
            }
            let mut pivot = self.rows[row][row];
            for col in start..row {
                let entry = self.rows[row][col];
                let multiplier = entry * self.rows[col][col];
                pivot = (-multiplier).times_plus::<FUSED>(entry, pivot);
                self.rows[row][col] = multiplier;
            }
            pivot_of(row, pivot);
            self.rows[row][row] = Lanes::splat(1.0) / pivot;
        }
    }

    /// Overwrites the right-hand sides with the solutions.
    #[inline(always)]
    pub(crate) fn solve<const FUSED: bool>(&self, rhs: &mut V) {
        for row in 0..V::LEN {
            for col in self.first(row)..row {
                rhs[row] = (-self.rows[row][col]).times_plus::<FUSED>(rhs[col], rhs[row]);
            }
        }
        for row in 0..V::LEN {
            rhs[row] = rhs[row] * self.rows[row][row];
        }
        for row in (0..V::LEN).rev() {
            for col in self.first(row)..row {
                rhs[col] = (-self.rows[row][col]).times_plus::<FUSED>(rhs[row], rhs[col]);
            }
        }
    }
}

/// Overwrites `mass` with the factors of the mass matrices of eight nodes, and returns a metric of motions.
///
/// Of a positive definite mass it is the diagonal, none of which is smaller than its entry of `D`. On the diagonal of an indefinite one, as of a
/// spacetime, there may be a zero: motions along that coordinate would have no length.
#[inline(always)]
pub(crate) fn factor_mass<S: MechanicalSystem, const FUSED: bool>(
    mass: &mut LaneMass<S>,
    constants: &S::PerConstant<Lanes>,
    hessian: &S::PerHessianEntry<Lanes>,
) -> S::PerCoordinate<Lanes> {
    let mut inertia = S::PerCoordinate::<Lanes>::filled(Lanes::ZERO);
    mass.clear();
    S::for_each_vv(
        constants,
        hessian,
        #[inline(always)]
        |row, col, value| {
            if row >= col {
                mass.set(row, col, value);
            }
            if row == col {
                inertia[row] = Scalar::abs(value);
            }
        },
    );
    mass.factor_showing::<FUSED>(
        #[inline(always)]
        |row, pivot| inertia[row] = inertia[row].larger(Scalar::abs(pivot)),
    );
    inertia
}
