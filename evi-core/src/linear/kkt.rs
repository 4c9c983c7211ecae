//! The saddle-point matrix of a constrained step, assembled, scaled and factored.
//!
//! ```text
//! [ A   G₀ᵀ ] [ x ]   [ a ]        A: n × n,  G₀, G₁: m × n
//! [ G₁  0   ] [ y ] = [ b ]
//! ```
//!
//! Coordinates may be metres, radians or both; masses may differ by many powers of ten. The scene's own elimination judges
//! each pivot by its own terms and takes the matrix as it is. Where pivots are compared with each other, the scaled matrix
//! `D K D` takes its place: it has a unit diagonal in `A` and unit rows in `G₀` in the metric of `A`, so that its unknowns all
//! carry the unit of √A·q. `D` holds powers of two: scaling commits no rounding error.

use super::{Conditioning, Factorization, SingularMatrix, largest_magnitude};
use crate::array::Array;
use crate::scalar::Scalar;
use crate::system::MechanicalSystem;

/// Index of a constraint's multiplier among the unknowns.
#[inline]
pub(crate) const fn constraint_index<S: MechanicalSystem>(constraint: usize) -> usize {
    S::N_COORDINATES + constraint
}

/// The unknowns `(x, y)`, or the right-hand side `(a, b)`, from the values per coordinate and per constraint.
#[inline]
pub(crate) fn unknowns<S: MechanicalSystem>(
    mut coordinate: impl FnMut(usize) -> f64,
    mut constraint: impl FnMut(usize) -> f64,
) -> S::PerUnknown<f64> {
    let n = S::N_COORDINATES;
    Array::from_fn(|row| if row < n { coordinate(row) } else { constraint(row - n) })
}

/// A saddle-point matrix being assembled.
pub(crate) struct Kkt<S: MechanicalSystem> {
    rows: S::PerUnknown<S::PerUnknown<f64>>,
}

impl<S: MechanicalSystem> Kkt<S> {
    /// The zero matrix.
    #[inline]
    pub(crate) fn zero() -> Self {
        // A sum that begins at −0 is its first term to the last bit, so that the compiler leaves the addition out.
        Self { rows: Array::from_fn(|_| Array::from_fn(|_| -0.0)) }
    }

    /// Adds `value` to `A[row][col]`.
    #[inline]
    pub(crate) fn add_block(&mut self, row: usize, col: usize, value: f64) {
        self.rows[row][col] += value;
    }

    /// Overwrites `A` with its transpose.
    #[cfg(feature = "std")]
    pub(crate) fn transpose_block(&mut self) {
        for row in 0..S::N_COORDINATES {
            for col in 0..row {
                let mirrored = self.rows[col][row];
                self.rows[col][row] = self.rows[row][col];
                self.rows[row][col] = mirrored;
            }
        }
    }

    /// Sets `G₀ᵀ` from the Jacobian at the start of a step.
    #[inline]
    pub(crate) fn set_upper_jacobian(
        &mut self,
        constants: &S::PerConstant<f64>,
        jacobian: &S::PerJacobianEntry<f64>,
    ) {
        S::for_each_slope(constants, jacobian, |row, col, slope| {
            self.rows[col][constraint_index::<S>(row)] = slope;
        });
    }

    /// Sets `G₁` from the Jacobian at the end of a step.
    #[inline]
    pub(crate) fn set_lower_jacobian(
        &mut self,
        constants: &S::PerConstant<f64>,
        jacobian: &S::PerJacobianEntry<f64>,
    ) {
        S::for_each_slope(constants, jacobian, |row, col, slope| {
            self.rows[constraint_index::<S>(row)][col] = slope;
        });
    }

    /// Factors the matrix by the scene's own elimination, scaled where that gives up.
    #[inline]
    pub(crate) fn factor(self) -> Result<FactoredKkt<S>, SingularMatrix> {
        match S::KktFactors::factor_unscaled(&self.rows) {
            Some(factors) => Ok(FactoredKkt { factors, scale: None, inertia: self.inertia() }),
            None => self.factor_scaled(),
        }
    }

    /// Factors the matrix by the scene's own elimination, if its pivots are sound.
    #[inline(always)]
    pub(crate) fn factor_unscaled(&self) -> Option<S::KktFactors> {
        S::KktFactors::factor_unscaled(&self.rows)
    }

    /// Weights of the squares in `Σ wᵢ xᵢ²`, which is at least the square of
    /// [`relative_length`](FactoredKkt::relative_length) where no `Aᵢᵢ` vanishes.
    #[inline(always)]
    pub(crate) fn weights(&self, reference: impl Fn(usize) -> f64) -> S::PerCoordinate<f64> {
        let inertia = S::PerCoordinate::<f64>::from_fn(|i| self.rows[i][i].abs());
        let (mut reach, mut metric) = (-0.0, -0.0);
        for i in 0..S::N_COORDINATES {
            let square = reference(i) * reference(i);
            reach += square;
            metric += inertia[i] * square;
        }
        // (a + b)² ≤ 2 a² + 2 b².
        let (per_reach, per_metric) = (2.0 / reach, 2.0 / metric.max(f64::MIN_POSITIVE));
        Array::from_fn(|i| per_reach + inertia[i] * per_metric)
    }

    /// How well the matrix determines its unknowns, in one unit.
    pub(crate) fn conditioning(&self) -> Conditioning {
        let scale = self.scale();
        let scaled: S::PerUnknown<S::PerUnknown<f64>> =
            Array::from_fn(|row| Array::from_fn(|col| self.rows[row][col] * scale[row] * scale[col]));
        Conditioning::of::<_, _, S::PerUnknown<usize>>(&scaled)
    }

    /// Factors a matrix that may have entries outside of the scene's pattern.
    pub(crate) fn factor_densely(self) -> Result<FactoredKkt<S, S::DenseKktFactors>, SingularMatrix> {
        self.factor_scaled()
    }

    #[cold]
    fn factor_scaled<F>(mut self) -> Result<FactoredKkt<S, F>, SingularMatrix>
    where
        F: Factorization<S::PerUnknown<f64>, S::PerUnknown<S::PerUnknown<f64>>>,
    {
        let (inertia, scale) = (self.inertia(), self.scale());
        for row in 0..S::PerUnknown::<f64>::LEN {
            for col in 0..S::PerUnknown::<f64>::LEN {
                self.rows[row][col] *= scale[row] * scale[col];
            }
        }
        Ok(FactoredKkt { factors: F::factor(&self.rows)?, scale: Some(scale), inertia })
    }

    /// `|Aᵢᵢ|`, or what stands for it in a row where that is zero.
    #[inline]
    fn inertia(&self) -> S::PerCoordinate<f64> {
        Array::from_fn(|i| {
            let row = self.rows[i].as_ref();
            if row[i] == 0.0 {
                largest_magnitude(row[..S::N_COORDINATES].iter().copied())
            } else {
                row[i].abs()
            }
        })
    }

    /// The diagonal `D`: `1/√|Aᵢᵢ|` for a coordinate, `1/‖√A⁻¹ G₀ᵀ eᵢ‖` for a constraint, as powers of two.
    #[inline]
    pub(crate) fn scale(&self) -> S::PerUnknown<f64> {
        let n = S::N_COORDINATES;
        let mut scale = S::PerUnknown::<f64>::from_fn(|_| 1.0);
        let inertia = self.inertia();
        for i in 0..n {
            scale[i] = reciprocal_power_of_two(Scalar::sqrt(inertia[i]));
        }
        for constraint in n..S::PerUnknown::<f64>::LEN {
            let mut squares = 0.0;
            for i in 0..n {
                let scaled = self.rows[i][constraint] * scale[i];
                squares += scaled * scaled;
            }
            scale[constraint] = reciprocal_power_of_two(Scalar::sqrt(squares));
        }
        scale
    }
}

/// A factored saddle-point matrix.
pub(crate) struct FactoredKkt<S: MechanicalSystem, F = <S as MechanicalSystem>::KktFactors> {
    factors: F,
    /// The diagonal `D`, where the factors are those of `D K D`.
    scale: Option<S::PerUnknown<f64>>,
    /// `|Aᵢᵢ|`: the metric in which lengths are compared.
    inertia: S::PerCoordinate<f64>,
}

impl<S, F> FactoredKkt<S, F>
where
    S: MechanicalSystem,
    F: Factorization<S::PerUnknown<f64>, S::PerUnknown<S::PerUnknown<f64>>>,
{
    /// Overwrites the right-hand side `(a, b)` with the solution `(x, y)`.
    #[inline]
    pub(crate) fn solve(&self, rhs: &mut S::PerUnknown<f64>) {
        match &self.scale {
            None => self.factors.solve(rhs),
            Some(scale) => *rhs = self.solve_scaled(scale, rhs.clone()),
        }
    }

    #[cold]
    fn solve_scaled(&self, scale: &S::PerUnknown<f64>, mut rhs: S::PerUnknown<f64>) -> S::PerUnknown<f64> {
        let apply_scale = |unknowns: &mut S::PerUnknown<f64>| {
            for (unknown, scale) in unknowns.as_mut().iter_mut().zip(scale.as_ref()) {
                *unknown *= scale;
            }
        };
        apply_scale(&mut rhs);
        self.factors.solve(&mut rhs);
        apply_scale(&mut rhs);
        rhs
    }

    /// `Σ |Aᵢᵢ| xᵢ²`: the squared length of a configuration, whatever the units of its coordinates.
    #[inline]
    pub(crate) fn squared_length(&self, x: impl Fn(usize) -> f64) -> f64 {
        let mut sum = -0.0;
        for i in 0..S::N_COORDINATES {
            sum += self.inertia[i] * (x(i) * x(i));
        }
        sum
    }

    /// The length of `x` relative to that of `reference`; 0 for a vanishing `x`, whatever the reference. The sum of two: in the metric
    /// of the matrix, which is blind to what has no inertia, and of the numbers themselves, which is blind to what has small units.
    #[inline]
    pub(crate) fn relative_length(&self, x: impl Fn(usize) -> f64, reference: impl Fn(usize) -> f64) -> f64 {
        let (mut length, mut reach) = (-0.0, -0.0);
        for i in 0..S::N_COORDINATES {
            length += x(i) * x(i);
            reach += reference(i) * reference(i);
        }
        if length == 0.0 {
            return 0.0;
        }
        let metric = self.squared_length(x) / self.squared_length(reference).max(f64::MIN_POSITIVE);
        Scalar::sqrt(length / reach) + Scalar::sqrt(metric)
    }

    /// Smallest pivot over largest.
    #[inline]
    pub(crate) fn pivot_ratio(&self) -> f64 {
        self.factors.pivot_ratio()
    }

    /// Whether the pivoted dense solve has taken the place of the scene's own elimination.
    #[inline(always)]
    pub(crate) fn is_fallback(&self) -> bool {
        self.factors.is_fallback()
    }
}

/// The power of two next below `1/x`; 1 where `x` is zero or not a normal number.
#[inline]
pub(crate) fn reciprocal_power_of_two(x: f64) -> f64 {
    const EXPONENT_BITS: u64 = 0x7ff;
    const MANTISSA_BITS: u32 = 52;
    const LARGEST_REPRESENTABLE_SHIFT: u64 = 2 * 1023;
    let biased_exponent = (x.to_bits() >> MANTISSA_BITS) & EXPONENT_BITS;
    if !x.is_normal() || biased_exponent >= LARGEST_REPRESENTABLE_SHIFT {
        return 1.0;
    }
    f64::from_bits((LARGEST_REPRESENTABLE_SHIFT - biased_exponent) << MANTISSA_BITS)
}

#[cfg(test)]
mod power_of_two_tests {
    use super::*;

    #[test]
    fn the_reciprocal_lies_within_a_factor_of_two_and_is_a_power_of_two() {
        for exponent in -1021..=1021 {
            for mantissa in [1.0, 1.3, 2.0 - f64::EPSILON] {
                let x = mantissa * Scalar::powi(2.0_f64, exponent);
                let reciprocal = reciprocal_power_of_two(x);
                assert_eq!(reciprocal, Scalar::powi(2.0_f64, -exponent), "{x:e}");
                assert!((1.0..2.0).contains(&(x * reciprocal)), "{x:e}");
            }
        }
    }

    #[test]
    fn what_has_no_reciprocal_is_left_unscaled() {
        let subnormal = f64::MIN_POSITIVE / 2.0;
        for x in [0.0, -0.0, subnormal, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, f64::MAX] {
            assert_eq!(reciprocal_power_of_two(x), 1.0, "{x:e}");
        }
    }

    #[test]
    fn the_sign_does_not_matter() {
        assert_eq!(reciprocal_power_of_two(-3.0), 0.5);
    }
}

#[cfg(all(test, feature = "derive"))]
mod tests {
    use super::*;
    use crate::mechanics::Mechanics;

    #[derive(evi_macros::MechanicalSystem)]
    #[evi(
        coordinates(x1, y1, x2, y2),
        kinetic   = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2))
                  + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2)),
        potential = 0.0 * y1,
        constraint(rod1: unit * (x1.powi(2) + y1.powi(2)) == unit),
        constraint(rod2: (x2 - x1).powi(2) + (y2 - y1).powi(2) == 1.0),
    )]
    struct Chain {
        m1: f64,
        m2: f64,
        unit: f64,
    }

    const CONFIGURATION: [f64; 4] = [0.6, 0.8, 1.5, -0.1];

    fn kkt(system: &Chain) -> Kkt<Chain> {
        let mechanics = Mechanics::new(system);
        let (_, hessian) =
            Chain::lagrangian_derivatives(&mechanics.constants, 0.0, &CONFIGURATION, &[0.0; 4]);
        let (_, jacobian) = Chain::constraint_derivatives(&mechanics.constants, 0.0, &CONFIGURATION);
        mechanics.mass_kkt(&hessian, &jacobian)
    }

    /// Solves for a known solution whose entries are alike in the natural units of each unknown.
    fn check_scaling(m1: f64, m2: f64, unit: f64) {
        let system = Chain { m1, m2, unit };
        let matrix = kkt(&system);
        let scale = matrix.scale();
        let solution: [f64; 6] = core::array::from_fn(|i| scale[i] * [1.0, -2.0, 3.0, 1.5, -1.0, 2.5][i]);
        let mut unknowns: [f64; 6] =
            core::array::from_fn(|row| (0..6).map(|col| matrix.rows[row][col] * solution[col]).sum());
        let factors = matrix.factor().expect("regular for every pair of masses");
        assert!(factors.pivot_ratio() > 1e-2, "{:e}", factors.pivot_ratio());
        factors.solve(&mut unknowns);
        for i in 0..6 {
            let error = ((unknowns[i] - solution[i]) / scale[i]).abs();
            // Sums of up to four terms in the right-hand side, and the elimination of a matrix of condition 10:
            // 8 ε measured.
            assert!(error <= 32.0 * f64::EPSILON, "masses {m1:e}, {m2:e}: unknown {i} is off by {error:e}");
        }
    }

    #[test]
    fn masses_and_units_twelve_orders_apart_cost_no_accuracy() {
        for m1 in [1e-12, 1e-6, 1.0, 1e6, 1e12] {
            for m2 in [1e-12, 1e-6, 1.0, 1e6, 1e12] {
                for unit in [1e-9, 1.0, 1e9] {
                    check_scaling(m1, m2, unit);
                }
            }
        }
    }

    #[test]
    fn without_scaling_the_same_matrix_looks_singular() {
        let matrix = kkt(&Chain { m1: 1e-12, m2: 1e12, unit: 1e-9 });
        assert!(<Chain as MechanicalSystem>::DenseKktFactors::factor(&matrix.rows).is_err());
        assert!(matrix.factor_densely().is_ok());
    }

    #[test]
    fn units_that_differ_by_powers_of_two_change_no_bit() {
        let rhs = [0.3, -0.7, 0.1, 0.9, 0.0, 0.0];
        let solve = |power: i32| {
            let mass = Scalar::powi(4.0_f64, power);
            let mut unknowns = rhs.map(|value| value * mass);
            kkt(&Chain { m1: 1.7 * mass, m2: 0.4 * mass, unit: 1.0 }).factor().unwrap().solve(&mut unknowns);
            (unknowns[..4].to_vec(), unknowns[4] / mass, unknowns[5] / mass)
        };
        assert_eq!(solve(0), solve(20));
        assert_eq!(solve(0), solve(-20));
    }

    #[test]
    fn a_massless_body_on_a_free_joint_is_singular() {
        assert!(kkt(&Chain { m1: 1.0, m2: 0.0, unit: 1.0 }).factor().is_err());
    }

    #[test]
    fn a_length_is_measured_in_the_unit_of_each_coordinate() {
        let factors = kkt(&Chain { m1: 4.0, m2: 1.0, unit: 1.0 }).factor().unwrap();
        assert_eq!(factors.squared_length(|i| [3.0, 0.0, -5.0, 0.0][i]), 61.0);
    }

    #[test]
    fn a_length_with_an_entry_that_is_not_a_number_is_not_a_number() {
        let factors = kkt(&Chain { m1: 1.0, m2: 1.0, unit: 1.0 }).factor().unwrap();
        for i in 0..4 {
            let mut x = [1.0; 4];
            x[i] = f64::NAN;
            assert!(factors.squared_length(|i| x[i]).is_nan(), "entry {i}");
        }
    }
}
