//! Matrices over the coordinates and over the constraints, one of each member side by side.

use core::marker::PhantomData;

use super::lane_state::{nothing, side_by_side};
use super::mask::LaneMask;
use crate::array::Array;
use crate::mechanics::{CoordinateMatrix, Coupling};
use crate::scalar::{LANES, Lanes};
use crate::system::{Entry, MechanicalSystem};

/// Up to so many entries of the Jacobian, loops over pairs of them are unrolled.
const MOST_UNROLLED: usize = 16;

/// Symmetric matrices over the coordinates, which couple those that `C` says.
pub(super) struct LaneMatrix<S: MechanicalSystem, C> {
    /// All that is read of diagonal matrices.
    diagonal: S::PerCoordinate<Lanes>,
    /// The rows of others.
    rows: Vec<S::PerCoordinate<Lanes>>,
    coupling: PhantomData<C>,
}

impl<S: MechanicalSystem, C: Coupling<S>> LaneMatrix<S, C> {
    pub(super) fn of(matrices: [&CoordinateMatrix<S, C>; LANES]) -> Self {
        let row = |row: usize| side_by_side(|lane, col| matrices[lane].at(row, col));
        Self {
            diagonal: side_by_side(|lane, i| matrices[lane].at(i, i)),
            rows: if C::IS_DIAGONAL { Vec::new() } else { (0..S::N_COORDINATES).map(row).collect() },
            coupling: PhantomData,
        }
    }

    /// The products with vectors.
    #[inline(always)]
    pub(super) fn times<const FUSED: bool>(&self, x: &S::PerCoordinate<Lanes>) -> S::PerCoordinate<Lanes> {
        let mut product: S::PerCoordinate<Lanes> = nothing();
        for i in 0..S::N_COORDINATES {
            if C::IS_DIAGONAL {
                product[i] = self.diagonal[i] * x[i];
            } else {
                for k in 0..S::N_COORDINATES {
                    product[i] = self.rows[i][k].times_plus::<FUSED>(x[k], product[i]);
                }
            }
        }
        product
    }
}

/// The entries of the Jacobian of a scene, and what is made of them.
pub(super) struct Slopes<S: MechanicalSystem> {
    constants: S::PerConstant<Lanes>,
    /// Pairs of entries in one column: the products that matrices of many constraints are made of.
    pairs: Vec<[Entry; 2]>,
}

impl<S: MechanicalSystem> Slopes<S> {
    pub(super) fn new(constants: S::PerConstant<Lanes>) -> Self {
        let entries = S::STRUCTURE.jacobian.q;
        let all = entries.iter().flat_map(|a| entries.iter().map(move |b| [*a, *b]));
        let pairs = if entries.len() <= MOST_UNROLLED {
            Vec::new()
        } else {
            all.filter(|[a, b]| a.col == b.col).collect()
        };
        Self { constants, pairs }
    }

    /// The constants of the members.
    #[inline(always)]
    pub(super) const fn constants(&self) -> &S::PerConstant<Lanes> {
        &self.constants
    }

    #[inline(always)]
    fn at(&self, entry: &Entry, jacobian: &S::PerJacobianEntry<Lanes>) -> Lanes {
        entry.value(self.constants.as_ref(), jacobian.as_ref())
    }

    /// `Gᵀ x`.
    #[inline(always)]
    pub(super) fn pull<const FUSED: bool>(
        &self,
        jacobian: &S::PerJacobianEntry<Lanes>,
        x: &S::PerConstraint<Lanes>,
    ) -> S::PerCoordinate<Lanes> {
        let mut sum: S::PerCoordinate<Lanes> = nothing();
        S::for_each_slope(
            &self.constants,
            jacobian,
            #[inline(always)]
            |row, col, slope| sum[col] = slope.times_plus::<FUSED>(x[row], sum[col]),
        );
        sum
    }

    /// `G x`.
    #[inline(always)]
    pub(super) fn along<const FUSED: bool>(
        &self,
        jacobian: &S::PerJacobianEntry<Lanes>,
        x: &S::PerCoordinate<Lanes>,
    ) -> S::PerConstraint<Lanes> {
        let mut sum: S::PerConstraint<Lanes> = nothing();
        S::for_each_slope(
            &self.constants,
            jacobian,
            #[inline(always)]
            |row, col, slope| sum[row] = slope.times_plus::<FUSED>(x[col], sum[row]),
        );
        sum
    }

    /// `G v + ∂φ/∂t`.
    #[inline(always)]
    pub(super) fn rate<const FUSED: bool>(
        &self,
        jacobian: &S::PerJacobianEntry<Lanes>,
        v: &S::PerCoordinate<Lanes>,
    ) -> S::PerConstraint<Lanes> {
        let mut rate = self.along::<FUSED>(jacobian, v);
        for entry in S::STRUCTURE.jacobian.t {
            rate[entry.row] = rate[entry.row] + self.at(entry, jacobian);
        }
        rate
    }

    /// `Σᵢ |G_ci| rᵢ`.
    #[inline(always)]
    pub(super) fn scale(
        &self,
        jacobian: &S::PerJacobianEntry<Lanes>,
        reach: &S::PerCoordinate<Lanes>,
    ) -> S::PerConstraint<Lanes> {
        use crate::scalar::Scalar;
        let mut sum: S::PerConstraint<Lanes> = nothing();
        S::for_each_slope(
            &self.constants,
            jacobian,
            #[inline(always)]
            |row, col, slope| sum[row] = sum[row] + slope.abs() * reach[col],
        );
        sum
    }

    /// Adds the product of two entries in one column, for a diagonal `D`. A function, since what a closure does is not always inlined.
    #[inline(always)]
    fn add_pair<const FUSED: bool>(
        &self,
        [a, b]: [&Entry; 2],
        [jacobian, start_jacobian]: [&S::PerJacobianEntry<Lanes>; 2],
        diagonal: &S::PerCoordinate<Lanes>,
        gram: &mut LaneLu<S>,
    ) {
        let moved = diagonal[b.col] * self.at(b, start_jacobian);
        gram.add_product::<FUSED>(a.row, b.row, self.at(a, jacobian), moved);
    }

    /// Overwrites `gram` with `G₁ D G₀ᵀ`.
    #[inline(always)]
    pub(super) fn gram<C: Coupling<S>, const FUSED: bool>(
        &self,
        jacobian: &S::PerJacobianEntry<Lanes>,
        matrix: &LaneMatrix<S, C>,
        start_jacobian: &S::PerJacobianEntry<Lanes>,
        gram: &mut LaneLu<S>,
    ) {
        let entries = S::STRUCTURE.jacobian.q;
        gram.clear();
        let diagonal = &matrix.diagonal;
        if C::IS_DIAGONAL && entries.len() <= MOST_UNROLLED {
            S::for_each_slope(
                &self.constants,
                start_jacobian,
                #[inline(always)]
                |other, shared, start_slope| {
                    let moved = diagonal[shared] * start_slope;
                    S::for_each_slope(
                        &self.constants,
                        jacobian,
                        #[inline(always)]
                        |row, col, slope| {
                            if col == shared {
                                gram.add_product::<FUSED>(row, other, slope, moved);
                            }
                        },
                    );
                },
            );
        } else if C::IS_DIAGONAL {
            for [a, b] in &self.pairs {
                self.add_pair::<FUSED>([a, b], [jacobian, start_jacobian], diagonal, gram);
            }
        } else {
            for col in 0..S::N_CONSTRAINTS {
                let mut direction: S::PerCoordinate<Lanes> = nothing();
                for entry in entries {
                    if entry.row == col {
                        for i in 0..S::N_COORDINATES {
                            let slope = self.at(entry, start_jacobian);
                            direction[i] = matrix.rows[i][entry.col].times_plus::<FUSED>(slope, direction[i]);
                        }
                    }
                }
                for entry in entries {
                    gram.add_product::<FUSED>(entry.row, col, self.at(entry, jacobian), direction[entry.col]);
                }
            }
        }
    }
}

/// Square matrices over the constraints and their factors: closed forms for one or two rows, else `L U` without pivoting, within their envelope
/// (Golub & Van Loan, Matrix Computations, 4th ed., sec. 3.2 and 4.3). A singular matrix gives numbers that are not finite: what is
/// solved with it does not converge then.
pub(super) struct LaneLu<S: MechanicalSystem> {
    rows: S::PerConstraint<S::PerConstraint<Lanes>>,
    /// Column of the first nonzero of every row, and row of the first nonzero of every column.
    first: S::PerConstraint<usize>,
    /// `1 / det` of closed forms.
    reciprocal: Lanes,
}

impl<S: MechanicalSystem> LaneLu<S> {
    /// Whether elimination is unrolled, and the matrix full.
    pub(super) const IS_SMALL: bool = S::N_CONSTRAINTS <= 4;

    /// A matrix to be overwritten, where it is small: one that need not leave the registers.
    #[inline(always)]
    pub(super) fn small() -> Self {
        // A full matrix has no envelope.
        let first = S::PerConstraint::<usize>::filled(0);
        Self { rows: Array::from_fn(|_| nothing()), first, reciprocal: Lanes::ZERO }
    }

    pub(super) fn new<C: Coupling<S>>() -> Self {
        let mut first = S::PerConstraint::<usize>::from_fn(|row| if C::IS_DIAGONAL { row } else { 0 });
        for &(smaller, larger) in S::STRUCTURE.constraint_graph {
            first[larger] = first[larger].min(smaller);
        }
        Self { rows: Array::from_fn(|_| nothing()), first, reciprocal: Lanes::ZERO }
    }

    #[inline(always)]
    fn first(&self, row: usize) -> usize {
        if Self::IS_SMALL { 0 } else { self.first[row] }
    }

    #[inline(always)]
    fn clear(&mut self) {
        for row in 0..S::N_CONSTRAINTS {
            for col in self.first(row)..=row {
                self.rows[row][col] = Lanes::ZERO;
                self.rows[col][row] = Lanes::ZERO;
            }
        }
    }

    #[inline(always)]
    fn add_product<const FUSED: bool>(&mut self, row: usize, col: usize, a: Lanes, b: Lanes) {
        self.rows[row][col] = a.times_plus::<FUSED>(b, self.rows[row][col]);
    }

    /// The diagonal element of a row, before the matrix is factored.
    #[inline(always)]
    pub(super) fn diagonal(&self, row: usize) -> Lanes {
        self.rows[row][row]
    }

    /// Overwrites the matrix with its factors.
    #[inline(always)]
    pub(super) fn factor<const FUSED: bool>(&mut self) {
        let one = Lanes::splat(1.0);
        if S::N_CONSTRAINTS == 1 {
            self.reciprocal = one / self.rows[0][0];
        } else if S::N_CONSTRAINTS == 2 {
            let crossed = self.rows[0][1] * self.rows[1][0];
            let determinant = self.rows[0][0].times_plus::<FUSED>(self.rows[1][1], -crossed);
            self.reciprocal = one / determinant;
        } else {
            for row in 0..S::N_CONSTRAINTS {
                let start = self.first(row);
                for col in start..row {
                    let (mut lower, mut upper) = (self.rows[row][col], self.rows[col][row]);
                    for k in start.max(self.first(col))..col {
                        lower = (-self.rows[row][k]).times_plus::<FUSED>(self.rows[k][col], lower);
                        upper = (-self.rows[col][k]).times_plus::<FUSED>(self.rows[k][row], upper);
                    }
                    self.rows[row][col] = lower * self.rows[col][col];
                    self.rows[col][row] = upper;
                }
                let mut pivot = self.rows[row][row];
                for k in start..row {
                    pivot = (-self.rows[row][k]).times_plus::<FUSED>(self.rows[k][row], pivot);
                }
                self.rows[row][row] = one / pivot;
            }
        }
    }

    /// Takes the factors of `other` in the lanes of `mask`.
    #[inline(always)]
    pub(super) fn blend(&mut self, mask: LaneMask, other: &Self) {
        self.reciprocal = mask.select(other.reciprocal, self.reciprocal);
        for row in 0..S::N_CONSTRAINTS {
            for col in self.first(row)..=row {
                self.rows[row][col] = mask.select(other.rows[row][col], self.rows[row][col]);
                self.rows[col][row] = mask.select(other.rows[col][row], self.rows[col][row]);
            }
        }
    }

    /// Overwrites right-hand sides with solutions.
    #[inline(always)]
    pub(super) fn solve<const FUSED: bool>(&self, rhs: &mut S::PerConstraint<Lanes>) {
        if S::N_CONSTRAINTS == 1 {
            rhs[0] = rhs[0] * self.reciprocal;
        } else if S::N_CONSTRAINTS == 2 {
            let (a, b) = (rhs[0], rhs[1]);
            let first = self.rows[1][1].times_plus::<FUSED>(a, -(self.rows[0][1] * b));
            let second = self.rows[0][0].times_plus::<FUSED>(b, -(self.rows[1][0] * a));
            (rhs[0], rhs[1]) = (first * self.reciprocal, second * self.reciprocal);
        } else {
            for row in 0..S::N_CONSTRAINTS {
                for col in self.first(row)..row {
                    rhs[row] = (-self.rows[row][col]).times_plus::<FUSED>(rhs[col], rhs[row]);
                }
            }
            for col in (0..S::N_CONSTRAINTS).rev() {
                rhs[col] = rhs[col] * self.rows[col][col];
                for row in self.first(col)..col {
                    rhs[row] = (-self.rows[row][col]).times_plus::<FUSED>(rhs[col], rhs[row]);
                }
            }
        }
    }
}
