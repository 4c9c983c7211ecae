//! Numbers with rates of change: forward-mode derivatives along one direction or several.

use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

use super::Scalar;

/// The derivatives of a number along one direction, or along several side by side.
pub(crate) trait Rate:
    Copy + Debug + Add<Output = Self> + Sub<Output = Self> + Neg<Output = Self>
{
    /// Of what stays as it is.
    const ZERO: Self;

    /// Times a number.
    fn times(self, factor: f64) -> Self;

    /// Times a number that need not exist where the rate is exactly zero.
    fn times_if_moving(self, factor: f64) -> Self;
}

impl Rate for f64 {
    const ZERO: Self = 0.0;

    #[inline]
    fn times(self, factor: f64) -> Self {
        self * factor
    }

    #[inline]
    fn times_if_moving(self, factor: f64) -> Self {
        // Equality to the exact zero of `from_f64`.
        if self == 0.0 { 0.0 } else { self * factor }
    }
}

/// A number and its derivative along a direction, or along several. Kernels that are evaluated on tangents give their derivatives along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tangent<R = f64> {
    pub(crate) value: f64,
    pub(crate) rate: R,
}

impl<R> Tangent<R> {
    pub(crate) const fn new(value: f64, rate: R) -> Self {
        Self { value, rate }
    }
}

impl<R: Rate> Tangent<R> {
    /// A number that stays as it is.
    #[inline]
    pub(crate) const fn still(value: f64) -> Self {
        Self { value, rate: R::ZERO }
    }

    /// `f(self)` from the value and the derivative of `f`.
    #[inline]
    fn chain(self, value: f64, derivative: f64) -> Self {
        Self { value, rate: self.rate.times(derivative) }
    }
}

impl<R: Rate> Add for Tangent<R> {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, rate: self.rate + other.rate }
    }
}

impl<R: Rate> Sub for Tangent<R> {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, rate: self.rate - other.rate }
    }
}

impl<R: Rate> Mul for Tangent<R> {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            rate: self.rate.times(other.value) + other.rate.times(self.value),
        }
    }
}

impl<R: Rate> Div for Tangent<R> {
    type Output = Self;

    #[inline]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, rate: (self.rate - other.rate.times(value)).times(1.0 / other.value) }
    }
}

impl<R: Rate> Neg for Tangent<R> {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self { value: -self.value, rate: -self.rate }
    }
}

impl<R: Rate> Scalar for Tangent<R> {
    #[inline]
    fn from_f64(value: f64) -> Self {
        Self::still(value)
    }

    #[inline]
    fn powi(self, exponent: i32) -> Self {
        let x = self.value;
        if exponent == 0 {
            return Self::from_f64(1.0);
        }
        self.chain(Scalar::powi(x, exponent), f64::from(exponent) * Scalar::powi(x, exponent - 1))
    }

    #[inline]
    fn powf(self, exponent: Self) -> Self {
        let x = self.value;
        let value = Scalar::powf(x, exponent.value);
        let by_base = exponent.value * Scalar::powf(x, exponent.value - 1.0);
        // A constant exponent asks for no logarithm, which a base of zero does not have.
        let by_exponent = exponent.rate.times_if_moving(value * Scalar::ln(x));
        Self { value, rate: self.rate.times(by_base) + by_exponent }
    }

    #[inline]
    fn sqrt(self) -> Self {
        let root = Scalar::sqrt(self.value);
        self.chain(root, 0.5 / root)
    }

    #[inline]
    fn sin(self) -> Self {
        let (sine, cosine) = Scalar::sin_cos(self.value);
        self.chain(sine, cosine)
    }

    #[inline]
    fn cos(self) -> Self {
        let (sine, cosine) = Scalar::sin_cos(self.value);
        self.chain(cosine, -sine)
    }

    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = Scalar::sin_cos(self.value);
        (self.chain(sine, cosine), self.chain(cosine, -sine))
    }

    #[inline]
    fn tan(self) -> Self {
        let tangent = Scalar::tan(self.value);
        self.chain(tangent, 1.0 + tangent * tangent)
    }

    #[inline]
    fn exp(self) -> Self {
        let value = Scalar::exp(self.value);
        self.chain(value, value)
    }

    #[inline]
    fn ln(self) -> Self {
        self.chain(Scalar::ln(self.value), 1.0 / self.value)
    }

    #[inline]
    fn asin(self) -> Self {
        self.chain(Scalar::asin(self.value), 1.0 / Scalar::sqrt(1.0 - self.value * self.value))
    }

    #[inline]
    fn acos(self) -> Self {
        self.chain(Scalar::acos(self.value), -1.0 / Scalar::sqrt(1.0 - self.value * self.value))
    }

    #[inline]
    fn atan(self) -> Self {
        self.chain(Scalar::atan(self.value), 1.0 / (1.0 + self.value * self.value))
    }

    #[inline]
    fn atan2(self, x: Self) -> Self {
        let squares = self.value * self.value + x.value * x.value;
        Self {
            value: Scalar::atan2(self.value, x.value),
            rate: (self.rate.times(x.value) - x.rate.times(self.value)).times(1.0 / squares),
        }
    }

    #[inline]
    fn sinh(self) -> Self {
        self.chain(Scalar::sinh(self.value), Scalar::cosh(self.value))
    }

    #[inline]
    fn cosh(self) -> Self {
        self.chain(Scalar::cosh(self.value), Scalar::sinh(self.value))
    }

    #[inline]
    fn tanh(self) -> Self {
        let tangent = Scalar::tanh(self.value);
        self.chain(tangent, 1.0 - tangent * tangent)
    }

    #[inline]
    fn abs(self) -> Self {
        self.chain(Scalar::abs(self.value), Scalar::signum(self.value))
    }

    #[inline]
    fn signum(self) -> Self {
        self.chain(Scalar::signum(self.value), 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::{Scalar, Tangent};

    /// Compares the rate with the central difference quotient at two arguments that move at unequal rates.
    #[track_caller]
    fn check(function: impl Fn([Tangent; 2]) -> Tangent, x: [f64; 2]) {
        const RATES: [f64; 2] = [1.3, -0.7];
        const STEP: f64 = 1e-5;
        let at = |s: f64| function([0, 1].map(|i| Tangent::from_f64(x[i] + s * RATES[i]))).value;
        let quotient = (at(STEP) - at(-STEP)) / (2.0 * STEP);
        let rate = function([0, 1].map(|i| Tangent::new(x[i], RATES[i]))).rate;
        assert!(quotient.abs() > 1e-2, "vacuous: {quotient}");
        // Third derivatives times STEP², and round-off over STEP.
        assert!((rate - quotient).abs() <= 1e-8 * (1.0 + rate.abs()), "{rate} instead of {quotient}");
    }

    #[test]
    fn every_operation_has_its_derivative() {
        const X: [f64; 2] = [0.6, 0.3];
        check(|[x, y]| x + y * y, X);
        check(|[x, y]| x - y, X);
        check(|[x, y]| x * y, X);
        check(|[x, y]| x / y, X);
        check(|[x, _]| -x, X);
        check(|[x, _]| x.powi(3), X);
        check(|[x, _]| x.powi(-2), X);
        check(|[x, y]| x.powi(0) + y.powi(1), X);
        check(|[x, y]| x.powf(y), X);
        check(|[x, _]| x.powf(Tangent::from_f64(1.7)), X);
        for function in [Scalar::sqrt, Scalar::sin, Scalar::cos, Scalar::tan, Scalar::exp, Scalar::ln] {
            check(|[x, _]| function(x), X);
        }
        for function in [Scalar::asin, Scalar::acos, Scalar::atan, Scalar::sinh, Scalar::cosh, Scalar::tanh] {
            check(|[x, _]| function(x), X);
        }
        check(|[x, y]| x.sin_cos().0 * y.sin_cos().1, X);
        check(|[x, y]| x.atan2(y), X);
        check(|[x, y]| x.atan2(y), [-0.6, -0.3]);
        check(|[x, y]| x.abs() * y.signum(), [-0.6, -0.3]);
    }

    #[test]
    fn a_power_of_zero_with_a_constant_exponent_has_a_rate() {
        let power = Tangent::new(0.0, 1.0).powf(Tangent::from_f64(1.0));
        assert_eq!((power.value, power.rate), (0.0, 1.0));
        assert_eq!(Tangent::new(0.0, 1.0).powi(1).rate, 1.0);
    }
}
