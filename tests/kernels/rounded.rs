//! Numbers with a bound of their own rounding errors.

use super::*;

/// A number with a bound of its rounding error, to first order.
///
/// Running error analysis (Higham, Accuracy and Stability of Numerical Algorithms, 3.3): every operation
/// hands on the errors of its operands, scaled by its slopes, and adds its own rounding. Outlined like the
/// numbers above.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rounded {
    pub(super) value: f64,
    pub(super) error: f64,
}

impl Rounded {
    pub(super) fn exact(value: f64) -> Self {
        Self { value, error: 0.0 }
    }

    /// A result with the errors that its operands hand on; its own rounding is at most one unit in the last
    /// place.
    pub(super) fn new(value: f64, handed_on: f64) -> Self {
        Self { value, error: handed_on + f64::EPSILON * value.abs() }
    }

    pub(super) fn function(self, function: fn(f64) -> f64, slope: f64) -> Self {
        Self::new(function(self.value), slope.abs() * self.error)
    }
}

impl Add for Rounded {
    type Output = Self;
    #[inline(never)]
    fn add(self, other: Self) -> Self {
        Self::new(self.value + other.value, self.error + other.error)
    }
}

impl Sub for Rounded {
    type Output = Self;
    #[inline(never)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.value - other.value, self.error + other.error)
    }
}

impl Mul for Rounded {
    type Output = Self;
    #[inline(never)]
    fn mul(self, other: Self) -> Self {
        let handed_on = self.value.abs() * other.error + other.value.abs() * self.error;
        Self::new(self.value * other.value, handed_on)
    }
}

impl Div for Rounded {
    type Output = Self;
    #[inline(never)]
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        Self::new(quotient, (self.error + quotient.abs() * other.error) / other.value.abs())
    }
}

impl Neg for Rounded {
    type Output = Self;
    #[inline(never)]
    fn neg(self) -> Self {
        Self { value: -self.value, error: self.error }
    }
}

impl Scalar for Rounded {
    /// A number in a kernel may be the rounded result of folding several.
    #[inline(never)]
    fn from_f64(value: f64) -> Self {
        Self::new(value, 0.0)
    }
    #[inline(never)]
    fn powf(self, exponent: Self) -> Self {
        let power = self.value.powf(exponent.value);
        let slope_of_base = exponent.value * self.value.powf(exponent.value - 1.0);
        let slope_of_exponent = power * self.value.ln();
        let handed_on = slope_of_base.abs() * self.error + slope_of_exponent.abs() * exponent.error;
        Self::new(power, handed_on)
    }
    #[inline(never)]
    fn sqrt(self) -> Self {
        self.function(f64::sqrt, 0.5 / self.value.sqrt())
    }
    #[inline(never)]
    fn sin(self) -> Self {
        self.function(f64::sin, self.value.cos())
    }
    #[inline(never)]
    fn cos(self) -> Self {
        self.function(f64::cos, self.value.sin())
    }
    #[inline(never)]
    fn tan(self) -> Self {
        self.function(f64::tan, self.value.cos().powi(-2))
    }
    #[inline(never)]
    fn exp(self) -> Self {
        self.function(f64::exp, self.value.exp())
    }
    #[inline(never)]
    fn ln(self) -> Self {
        self.function(f64::ln, 1.0 / self.value)
    }
    #[inline(never)]
    fn asin(self) -> Self {
        self.function(f64::asin, 1.0 / (1.0 - self.value.powi(2)).sqrt())
    }
    #[inline(never)]
    fn acos(self) -> Self {
        self.function(f64::acos, 1.0 / (1.0 - self.value.powi(2)).sqrt())
    }
    #[inline(never)]
    fn atan(self) -> Self {
        self.function(f64::atan, 1.0 / (1.0 + self.value.powi(2)))
    }
    #[inline(never)]
    fn atan2(self, x: Self) -> Self {
        let radius_squared = self.value.powi(2) + x.value.powi(2);
        let handed_on = (self.value.abs() * x.error + x.value.abs() * self.error) / radius_squared;
        Self::new(self.value.atan2(x.value), handed_on)
    }
    #[inline(never)]
    fn sinh(self) -> Self {
        self.function(f64::sinh, self.value.cosh())
    }
    #[inline(never)]
    fn cosh(self) -> Self {
        self.function(f64::cosh, self.value.sinh())
    }
    #[inline(never)]
    fn tanh(self) -> Self {
        self.function(f64::tanh, self.value.cosh().powi(-2))
    }
    #[inline(never)]
    fn abs(self) -> Self {
        Self { value: self.value.abs(), error: self.error }
    }
    #[inline(never)]
    fn signum(self) -> Self {
        // Next to the kink the sign itself is uncertain.
        let error = if self.value.abs() <= self.error { 2.0 } else { 0.0 };
        Self { value: self.value.signum(), error }
    }
}
