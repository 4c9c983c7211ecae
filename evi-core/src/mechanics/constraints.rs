//! Products with the constraint Jacobian, entry by entry of its pattern.

use super::{CoordinateMatrix, Coupling, Mechanics};
use crate::array::Array;
use crate::linear::largest_magnitude;
use crate::scalar::Scalar;
use crate::system::{Entry, MechanicalSystem};

/// `B Gᵀ` for a symmetric matrix `B` over the coordinates, a row per constraint.
pub(crate) type Directions<S> =
    <S as MechanicalSystem>::PerConstraint<<S as MechanicalSystem>::PerCoordinate<f64>>;

/// A matrix over the constraints, by rows.
pub(super) type Gram<S> = <S as MechanicalSystem>::PerConstraint<<S as MechanicalSystem>::PerConstraint<f64>>;

/// Where a sum begins: `−0 + x` is `x` to the last bit, so that the compiler leaves the addition out.
pub(crate) const NOTHING: f64 = -0.0;

/// A matrix over the constraints being added up: terms of even and of odd columns by themselves, two short chains of additions instead of a long
/// one. Few constraints wait for their matrix; to add up the halves of many, most of whose entries are zero, takes longer than the wait.
struct Halves<S: MechanicalSystem> {
    even: Gram<S>,
    odd: Gram<S>,
}

impl<S: MechanicalSystem> Halves<S> {
    const ARE_TWO: bool = S::N_CONSTRAINTS <= 4;

    #[inline(always)]
    fn none() -> Self {
        let nothing = || Array::from_fn(|_| Array::from_fn(|_| NOTHING));
        Self { even: nothing(), odd: nothing() }
    }

    #[inline(always)]
    fn add(&mut self, row: usize, other: usize, col: usize, term: f64) {
        let half = if Self::ARE_TWO && col % 2 == 1 { &mut self.odd } else { &mut self.even };
        half[row][other] += term;
    }

    #[inline(always)]
    fn sum(self) -> Gram<S> {
        let Self { even, odd } = self;
        if !Self::ARE_TWO {
            return even;
        }
        Array::from_fn(|row| Array::from_fn(|other| even[row][other] + odd[row][other]))
    }
}

impl<S: MechanicalSystem> Mechanics<S> {
    /// `φ` and the varying entries of `G`, both over the content of the slopes: in these units impulses are larger by that factor.
    #[inline(always)]
    pub(crate) fn primitive_constraints(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
    ) -> (S::PerConstraint<f64>, S::PerJacobianEntry<f64>) {
        let (residuals, slopes) = S::constraint_slopes(&self.constants, t, q);
        (over_content::<S>(residuals), slopes)
    }

    /// Adds `Gᵀ x` to `sum`.
    #[inline]
    pub(crate) fn add_constraint_force(
        &self,
        jacobian: &S::PerJacobianEntry<f64>,
        x: &S::PerConstraint<f64>,
        sum: &mut S::PerCoordinate<f64>,
    ) {
        S::for_each_slope(&self.constants, jacobian, |row, col, slope| sum[col] += slope * x[row]);
    }

    /// Subtracts `Gᵀ x` from `sum`.
    #[inline]
    pub(crate) fn subtract_constraint_force(
        &self,
        jacobian: &S::PerJacobianEntry<f64>,
        x: &S::PerConstraint<f64>,
        sum: &mut S::PerCoordinate<f64>,
    ) {
        S::for_each_slope(&self.constants, jacobian, |row, col, slope| sum[col] -= slope * x[row]);
    }

    /// `B Gᵀ` for a symmetric matrix `B`, a row per constraint.
    #[inline(always)]
    pub(crate) fn constraint_directions<C: Coupling<S>>(
        &self,
        jacobian: &S::PerJacobianEntry<f64>,
        matrix: &CoordinateMatrix<S, C>,
    ) -> Directions<S> {
        let mut directions: Directions<S> = Array::from_fn(|_| Array::from_fn(|_| 0.0));
        S::for_each_slope(&self.constants, jacobian, |row, col, slope| {
            let direction = &mut directions[row];
            if C::IS_DIAGONAL {
                direction[col] = matrix.at(col, col) * slope;
            } else {
                for i in 0..S::N_COORDINATES {
                    direction[i] += matrix.at(i, col) * slope;
                }
            }
        });
        directions
    }

    /// `G D`, where the rows of `directions` are the columns of `D`, made by a matrix that couples what `C` says.
    #[inline(always)]
    pub(crate) fn gram_matrix<C: Coupling<S>>(
        &self,
        jacobian: &S::PerJacobianEntry<f64>,
        directions: &Directions<S>,
    ) -> Gram<S> {
        let mut halves = Halves::<S>::none();
        self.for_each_gram_term::<C>(jacobian, directions, |row, other, col, term| {
            halves.add(row, other, col, term);
        });
        halves.sum()
    }

    /// `G₁ B G₀ᵀ` for a diagonal matrix `B`.
    #[inline(always)]
    pub(crate) fn gram_matrix_between<C: Coupling<S>>(
        &self,
        end: &S::PerJacobianEntry<f64>,
        matrix: &CoordinateMatrix<S, C>,
        start: &S::PerJacobianEntry<f64>,
    ) -> Gram<S> {
        let mut rows: Directions<S> = Array::from_fn(|_| Array::from_fn(|_| 0.0));
        S::for_each_slope(&self.constants, start, |row, col, slope| rows[row][col] = slope);
        let mut halves = Halves::<S>::none();
        S::for_each_slope_pair(&self.constants, end, |row, other, col, slope| {
            halves.add(row, other, col, matrix.at(col, col) * (slope * rows[other][col]));
        });
        halves.sum()
    }

    /// `G B Gᵀ` for a symmetric matrix `B` that couples what `C` says.
    #[inline(always)]
    pub(super) fn symmetric_gram_matrix<C: Coupling<S>>(
        &self,
        jacobian: &S::PerJacobianEntry<f64>,
        matrix: &CoordinateMatrix<S, C>,
    ) -> Gram<S> {
        if !C::IS_DIAGONAL {
            return self.gram_matrix::<C>(jacobian, &self.constraint_directions(jacobian, matrix));
        }
        let mut halves = Halves::<S>::none();
        S::for_each_gram_product(&self.constants, jacobian, |row, other, col, slope, other_slope| {
            halves.add(row, other, col, matrix.at(col, col) * (slope * other_slope));
        });
        let lower = halves.sum();
        Array::from_fn(|row| Array::from_fn(|col| if col <= row { lower[row][col] } else { lower[col][row] }))
    }

    /// Calls `add(row, other, col, G[row][col] D[col][other])` for every term of `G D`.
    #[inline(always)]
    fn for_each_gram_term<C: Coupling<S>>(
        &self,
        jacobian: &S::PerJacobianEntry<f64>,
        directions: &Directions<S>,
        mut add: impl FnMut(usize, usize, usize, f64),
    ) {
        if C::IS_DIAGONAL {
            S::for_each_slope_pair(&self.constants, jacobian, |row, other, col, slope| {
                add(row, other, col, slope * directions[other][col]);
            });
        } else {
            S::for_each_slope(&self.constants, jacobian, |row, col, slope| {
                for other in 0..S::N_CONSTRAINTS {
                    add(row, other, col, slope * directions[other][col]);
                }
            });
        }
    }

    /// `Σᵢ |G_ci| rᵢ` for a reach `rᵢ ≥ 0` of every coordinate.
    #[inline]
    pub(crate) fn constraint_scale(
        &self,
        jacobian: &S::PerJacobianEntry<f64>,
        reach: &S::PerCoordinate<f64>,
    ) -> S::PerConstraint<f64> {
        let mut scale = S::PerConstraint::<f64>::from_fn(|_| NOTHING);
        S::for_each_slope(&self.constants, jacobian, |row, col, slope| {
            scale[row] += slope.abs() * reach[col]
        });
        scale
    }

    /// The largest `|residual_c|` as a share of `Σᵢ |G_ci| rᵢ`, `rᵢ ≥ 0`; 0 where both are, NaN where either is no number.
    #[cfg(feature = "std")]
    pub(crate) fn share_beside(
        &self,
        jacobian: &S::PerJacobianEntry<f64>,
        reach: &S::PerCoordinate<f64>,
        residual: &S::PerConstraint<f64>,
    ) -> f64 {
        let scale = self.constraint_scale(jacobian, reach);
        let mut largest = 0.0;
        for c in 0..S::N_CONSTRAINTS {
            let share = if residual[c] == 0.0 { 0.0 } else { residual[c].abs() / scale[c] };
            // Written so that a NaN stays.
            largest = if share <= largest { largest } else { share };
        }
        largest
    }

    /// `G q`: of each constraint, no more than the terms that it adds up, and where it is homogeneous but for a constant, as much.
    #[inline(always)]
    pub(crate) fn reach(
        &self,
        jacobian: &S::PerJacobianEntry<f64>,
        q: &S::PerCoordinate<f64>,
    ) -> S::PerConstraint<f64> {
        let mut reach = S::PerConstraint::<f64>::from_fn(|_| NOTHING);
        S::for_each_slope(&self.constants, jacobian, |row, col, slope| reach[row] += slope * q[col]);
        reach
    }

    /// `|G q|` at every configuration on the constraints, where they are quadratic forms but for a constant,
    /// `φ = ½ qᵀ φ_qq q + φ(0)`: `2 |φ(0)|`.
    pub(crate) fn constant_reach(&self) -> Option<S::PerConstraint<f64>> {
        let origin = Array::from_fn(|_| 0.0);
        let (at_origin, jacobian) = S::constraint_derivatives(&self.constants, 0.0, &origin);
        let is_form = |entry: &Entry| entry.value(self.constants.as_ref(), jacobian.as_ref()) == 0.0;
        // Exactly zero, as the slopes of a form are at the origin.
        let are_forms =
            S::STRUCTURE.has_quadratic_constraints() && S::STRUCTURE.jacobian.q.iter().all(is_form);
        are_forms.then(|| Array::from_fn(|c| 2.0 * at_origin[c].abs()))
    }

    /// Up to which `|d|²` of a displacement `d` every `½ |dᵀ φ_qq d|`, over the content, is at most `allowed`, where `φ_qq` is constant: the least
    /// `2 allowed_c / maxᵢ Σⱼ |∂²φ_c/∂qᵢ∂qⱼ|`.
    pub(crate) fn straight_up_to(&self, allowed: &S::PerConstraint<f64>) -> f64 {
        debug_assert!(
            S::STRUCTURE.has_quadratic_constraints(),
            "the curvature is the same everywhere and at all times"
        );
        let origin = Array::from_fn(|_| 0.0);
        let limit = |c: usize| {
            let alone = Array::from_fn(|other| if other == c { 1.0 } else { 0.0 });
            let mut sums = S::PerCoordinate::<f64>::from_fn(|_| 0.0);
            self.for_each_constraint_curvature(0.0, &origin, &alone, |row, _, value| {
                sums[row] += value.abs()
            });
            let bend = largest_magnitude(sums.as_ref().iter().copied());
            // Where nothing is curved, nothing is left, whatever is allowed.
            if bend == 0.0 { f64::MAX } else { 2.0 * S::STRUCTURE.jacobian.content * allowed[c] / bend }
        };
        let mut least = f64::MAX;
        for limit in (0..S::N_CONSTRAINTS).map(limit) {
            // Written so that a NaN stays.
            least = if limit >= least { least } else { limit };
        }
        least
    }

    /// `‖G_c‖`, the Euclidean norm of every constraint's gradient.
    pub(crate) fn gradient_norms(&self, jacobian: &S::PerJacobianEntry<f64>) -> S::PerConstraint<f64> {
        let mut squares = S::PerConstraint::<f64>::from_fn(|_| NOTHING);
        S::for_each_slope(&self.constants, jacobian, |row, _, slope| squares[row] += slope * slope);
        Array::from_fn(|c| Scalar::sqrt(squares[c]))
    }

    /// `∂φ/∂t`.
    #[inline(always)]
    pub(crate) fn constraint_time_rate(&self, jacobian: &S::PerJacobianEntry<f64>) -> S::PerConstraint<f64> {
        let mut rate = S::PerConstraint::<f64>::from_fn(|_| NOTHING);
        for entry in S::STRUCTURE.jacobian.t {
            rate[entry.row] += entry.value(self.constants.as_ref(), jacobian.as_ref());
        }
        rate
    }

    /// `G v + ∂φ/∂t`: the rate at which a motion leaves the constraints.
    #[inline]
    pub(crate) fn constraint_rate(
        &self,
        jacobian: &S::PerJacobianEntry<f64>,
        v: &S::PerCoordinate<f64>,
    ) -> S::PerConstraint<f64> {
        let mut even = self.constraint_time_rate(jacobian);
        let mut odd = S::PerConstraint::<f64>::from_fn(|_| NOTHING);
        S::for_each_slope(&self.constants, jacobian, |row, col, slope| {
            let rate = if col % 2 == 0 { &mut even } else { &mut odd };
            rate[row] += slope * v[col];
        });
        Array::from_fn(|c| even[c] + odd[c])
    }

    /// Calls `add(row, col, value)` for every entry of `Σ μ φ_qq`, the second derivative of `μᵀφ`.
    pub(crate) fn for_each_constraint_curvature(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
        multipliers: &S::PerConstraint<f64>,
        add: impl FnMut(usize, usize, f64),
    ) {
        for_each_constraint_curvature::<S>(&self.constants, (t, q), multipliers, add);
    }
}

/// Residuals, or what else is as large as `φ`, over the content of its slopes; of impulses in units of the content, those in units of `φ`.
#[inline(always)]
pub(crate) fn over_content<S: MechanicalSystem>(residuals: S::PerConstraint<f64>) -> S::PerConstraint<f64> {
    let content = const { S::STRUCTURE.jacobian.content };
    if content == 1.0 { residuals } else { Array::from_fn(|c| residuals[c] * (1.0 / content)) }
}

/// Calls `add(row, col, value)` for every entry of `Σ μ φ_qq`, the second derivative of `μᵀφ`, of a scene with these constants: for the pairs of
/// [`for_each_curved_pair`], in their order.
pub(crate) fn for_each_constraint_curvature<S: MechanicalSystem>(
    constants: &S::PerConstant<f64>,
    (t, q): (f64, &S::PerCoordinate<f64>),
    multipliers: &S::PerConstraint<f64>,
    mut add: impl FnMut(usize, usize, f64),
) {
    if S::N_CONSTRAINTS == 0 {
        return;
    }
    let curvature = |direction| S::constraint_curvature(constants, t, q, &direction);
    let unit = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
    let at_rest = curvature(Array::from_fn(|_| 0.0));
    let along: Directions<S> = {
        let columns = S::PerCoordinate::<S::PerConstraint<f64>>::from_fn(|col| {
            curvature(Array::from_fn(|i| unit(i, col)))
        });
        Array::from_fn(|c| Array::from_fn(|col| columns[col][c]))
    };
    for row in 0..S::N_COORDINATES {
        let curves = curved_with::<S>(row);
        // Not up to `row` alone, which hides from the optimiser that all of them are in range.
        for col in (0..S::N_COORDINATES).filter(|&col| col <= row && curves[col]) {
            // γ is a quadratic polynomial of the velocity: γ(a + b) − γ(a) − γ(b) + γ(0) leaves twice its
            // bilinear form, without the terms of time. Constraint by constraint, so that small whole numbers
            // cancel exactly.
            let along_both = curvature(Array::from_fn(|i| unit(i, row) + unit(i, col)));
            let bilinear = |c: usize| along_both[c] - (along[c][row] + along[c][col]) + at_rest[c];
            let value = (0..S::N_CONSTRAINTS).map(|c| 0.5 * multipliers[c] * bilinear(c)).sum();
            add(row, col, value);
            if row != col {
                add(col, row, value);
            }
        }
    }
}

/// Calls `visit(row, col)` for every entry that `Σ μ φ_qq` can have.
#[cfg(feature = "std")]
pub(crate) fn for_each_curved_pair<S: MechanicalSystem>(mut visit: impl FnMut(usize, usize)) {
    for row in 0..S::N_COORDINATES {
        let curves = curved_with::<S>(row);
        for col in (0..=row).filter(|&col| curves[col]) {
            visit(row, col);
            if row != col {
                visit(col, row);
            }
        }
    }
}

/// The coordinates with which some constraint can have a second derivative by `coordinate`, too: both stand in it, and its gradient varies with both.
fn curved_with<S: MechanicalSystem>(coordinate: usize) -> S::PerCoordinate<bool> {
    let varying = || S::STRUCTURE.jacobian.q.iter().filter(|entry| entry.is_varying());
    let mut curves = S::PerCoordinate::<bool>::filled(false);
    for entry in varying().filter(|entry| entry.col == coordinate) {
        for other in varying().filter(|other| other.row == entry.row) {
            curves[other.col] = true;
        }
    }
    curves
}
