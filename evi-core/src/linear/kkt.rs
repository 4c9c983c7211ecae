//! The saddle-point matrix of a constrained step, assembled, scaled and factored.
//!
//! ```text
//! [ A   G₀ᵀ ] [ x ]   [ a ]        A: n × n,  G₀, G₁: m × n
//! [ G₁  0   ] [ y ] = [ b ]
//! ```
//!
//! Coordinates may be metres, radians or both; masses may differ by many powers of ten. The scaled matrix
//! `D K D` has a unit diagonal in `A` and unit rows in `G₀` in the metric of `A`, so that its unknowns all carry the
//! unit of √A·q and pivots can be compared. `D` holds powers of two: scaling commits no rounding error.

use super::{Factorization, SingularMatrix};
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
        Self { rows: Array::from_fn(|_| Array::from_fn(|_| 0.0)) }
    }

    /// Adds `value` to `A[row][col]`.
    #[inline]
    pub(crate) fn add_block(&mut self, row: usize, col: usize, value: f64) {
        self.rows[row][col] += value;
    }

    /// Sets `G₀ᵀ` from the Jacobian at the start of a step.
    #[inline]
    pub(crate) fn set_upper_jacobian(&mut self, constants: &[f64], jacobian: &[f64]) {
        for entry in S::STRUCTURE.jacobian.q {
            self.rows[entry.col][constraint_index::<S>(entry.row)] = entry.value(constants, jacobian);
        }
    }

    /// Sets `G₁` from the Jacobian at the end of a step.
    #[inline]
    pub(crate) fn set_lower_jacobian(&mut self, constants: &[f64], jacobian: &[f64]) {
        for entry in S::STRUCTURE.jacobian.q {
            self.rows[constraint_index::<S>(entry.row)][entry.col] = entry.value(constants, jacobian);
        }
    }

    /// Scales and factors the matrix.
    #[inline]
    pub(crate) fn factor(mut self) -> Result<FactoredKkt<S>, SingularMatrix> {
        let scale = self.scale();
        for row in 0..S::PerUnknown::<f64>::LEN {
            for col in 0..S::PerUnknown::<f64>::LEN {
                self.rows[row][col] *= scale[row] * scale[col];
            }
        }
        Ok(FactoredKkt { factors: S::KktFactors::factor(&self.rows)?, scale })
    }

    /// The diagonal `D`: `1/√|Aᵢᵢ|` for a coordinate, `1/‖√A⁻¹ G₀ᵀ eᵢ‖` for a constraint, as powers of two.
    #[inline]
    fn scale(&self) -> S::PerUnknown<f64> {
        let n = S::N_COORDINATES;
        let mut scale = S::PerUnknown::<f64>::from_fn(|_| 1.0);
        for i in 0..n {
            let row = self.rows[i].as_ref();
            let inertia = if row[i] == 0.0 { largest_magnitude(&row[..n]) } else { row[i].abs() };
            scale[i] = reciprocal_power_of_two(Scalar::sqrt(inertia));
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
pub(crate) struct FactoredKkt<S: MechanicalSystem> {
    factors: S::KktFactors,
    scale: S::PerUnknown<f64>,
}

impl<S: MechanicalSystem> FactoredKkt<S> {
    /// Overwrites the right-hand side `(a, b)` with the solution `(x, y)`.
    #[inline]
    pub(crate) fn solve(&self, rhs: &mut S::PerUnknown<f64>) {
        self.apply_scale(rhs);
        self.factors.solve(rhs);
        self.apply_scale(rhs);
    }

    /// Length of `x` in units of its natural scale: `max |xᵢ| / Dᵢ`.
    #[inline]
    pub(crate) fn scaled_length<'x>(&self, x: impl IntoIterator<Item = &'x f64>) -> f64 {
        let mut largest = 0.0_f64;
        for (x, scale) in x.into_iter().take(S::N_COORDINATES).zip(self.scale.as_ref()) {
            let length = (x / scale).abs();
            // Written so that a NaN survives the comparison.
            largest = if length <= largest { largest } else { length };
        }
        largest
    }

    /// Smallest pivot over largest.
    #[inline]
    pub(crate) fn pivot_ratio(&self) -> f64 {
        self.factors.pivot_ratio()
    }

    #[inline]
    fn apply_scale(&self, unknowns: &mut S::PerUnknown<f64>) {
        for (unknown, scale) in unknowns.as_mut().iter_mut().zip(self.scale.as_ref()) {
            *unknown *= scale;
        }
    }
}

fn largest_magnitude(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| value.abs().max(largest))
}

/// The power of two next below `1/x`; 1 where `x` is zero or not a normal number.
#[inline]
fn reciprocal_power_of_two(x: f64) -> f64 {
    const EXPONENT_BITS: u64 = 0x7ff;
    const MANTISSA_BITS: u32 = 52;
    const LARGEST_REPRESENTABLE_SHIFT: u64 = 2 * 1023;
    let biased_exponent = (x.to_bits() >> MANTISSA_BITS) & EXPONENT_BITS;
    if !x.is_normal() || biased_exponent >= LARGEST_REPRESENTABLE_SHIFT {
        return 1.0;
    }
    f64::from_bits((LARGEST_REPRESENTABLE_SHIFT - biased_exponent) << MANTISSA_BITS)
}
