//! The numbers that a Lagrangian is written in.
//!
//! Emitted kernels and the generic copy of a user's expressions are generic over [`Scalar`], so that one piece
//! of code serves `f64`, `f32`, dual numbers and vector lanes. One implementation per number type, below.

use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// A real number type with the elementary functions of the attribute grammar.
pub trait Scalar:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The number nearest to `value`.
    fn from_f64(value: f64) -> Self;

    /// `self` to the power of an integer, by repeated squaring.
    #[inline]
    fn powi(self, exponent: i32) -> Self {
        let mut power = Self::from_f64(1.0);
        let (mut square, mut remaining) = (self, exponent.unsigned_abs());
        while remaining > 0 {
            if remaining & 1 == 1 {
                power = power * square;
            }
            square = square * square;
            remaining >>= 1;
        }
        if exponent < 0 { Self::from_f64(1.0) / power } else { power }
    }

    /// `(sin self, cos self)`.
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        (self.sin(), self.cos())
    }

    /// `self` to the power `exponent`; NaN for a negative base.
    fn powf(self, exponent: Self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Sine of an angle in radians.
    fn sin(self) -> Self;
    /// Cosine of an angle in radians.
    fn cos(self) -> Self;
    /// Tangent of an angle in radians.
    fn tan(self) -> Self;
    /// Exponential function.
    fn exp(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// Arc sine, in radians.
    fn asin(self) -> Self;
    /// Arc cosine, in radians.
    fn acos(self) -> Self;
    /// Arc tangent, in radians.
    fn atan(self) -> Self;
    /// Angle of the point `(x, self)`, in radians.
    fn atan2(self, x: Self) -> Self;
    /// Hyperbolic sine.
    fn sinh(self) -> Self;
    /// Hyperbolic cosine.
    fn cosh(self) -> Self;
    /// Hyperbolic tangent.
    fn tanh(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// Sign of `self`: the derivative of [`abs`](Scalar::abs); 1 at +0, -1 at -0.
    fn signum(self) -> Self;
}

/// Implements [`Scalar`] for a primitive float; each row is `method(arguments) = function of libm`.
macro_rules! primitive_scalar {
    ($float:ident: $($method:ident($($argument:ident),*) = $libm:ident),* $(,)?) => {
        impl Scalar for $float {
            #[inline]
            fn from_f64(value: f64) -> Self {
                value as $float
            }
            $(
                #[inline]
                fn $method(self $(, $argument: Self)*) -> Self {
                    #[cfg(feature = "std")]
                    { $float::$method(self $(, $argument)*) }
                    #[cfg(not(feature = "std"))]
                    { libm::$libm(self $(, $argument)*) }
                }
            )*
            #[inline]
            fn abs(self) -> Self {
                $float::abs(self)
            }
            #[inline]
            fn signum(self) -> Self {
                $float::signum(self)
            }
        }
    };
}

primitive_scalar!(f64:
    powf(exponent) = pow, sqrt() = sqrt, sin() = sin, cos() = cos, tan() = tan, exp() = exp, ln() = log,
    asin() = asin, acos() = acos, atan() = atan, atan2(x) = atan2, sinh() = sinh, cosh() = cosh, tanh() = tanh);
primitive_scalar!(f32:
    powf(exponent) = powf, sqrt() = sqrtf, sin() = sinf, cos() = cosf, tan() = tanf, exp() = expf, ln() = logf,
    asin() = asinf, acos() = acosf, atan() = atanf, atan2(x) = atan2f, sinh() = sinhf, cosh() = coshf,
    tanh() = tanhf);

#[cfg(feature = "generic")]
mod dual;
