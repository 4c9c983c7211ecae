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

    /// Evaluates a kernel that is too large to be inlined wherever it is called. Vector lanes compile it in a function of its own for every set of
    /// instructions that [`InstructionSet`] may find.
    #[inline(always)]
    fn compiled_apart<R>(kernel: impl FnOnce() -> R) -> R {
        kernel()
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
#[cfg(feature = "std")]
mod instruction_set;
mod lanes;
#[cfg(feature = "std")]
mod rates;
mod tangent;

#[cfg(feature = "std")]
pub use instruction_set::{InstructionSet, LaneOperation};
pub use lanes::{LANES, Lanes};
#[cfg(feature = "std")]
pub(crate) use rates::Rates;
#[cfg(feature = "std")]
pub(crate) use tangent::Rate;
pub(crate) use tangent::Tangent;

#[cfg(test)]
mod tests {
    use super::Scalar;

    /// Bases of both signs, none with short powers.
    const BASES: [f64; 6] = [-2.7, -1.1, -0.3, 0.3, 1.1, 2.7];

    /// `|exponent|` multiplications and a division, each within half an ulp of its result: 10 half ulps at most.
    fn check_power(power: f64, exact: f64, epsilon: f64) {
        let error = (power - exact).abs() / exact.abs();
        assert!(error <= 5.0 * epsilon, "{power} for {exact}: {:.1} ulp", error / epsilon);
    }

    #[test]
    fn integer_powers_agree_with_the_elementary_power() {
        for base in BASES {
            for exponent in -9..=9 {
                let sign = if exponent % 2 == 0 { 1.0 } else { base.signum() };
                let exact = sign * base.abs().powf(f64::from(exponent));
                check_power(Scalar::powi(base, exponent), exact, f64::EPSILON);
                let single = Scalar::powi(base as f32, exponent);
                let exact = sign * f64::from(base as f32).abs().powf(f64::from(exponent));
                check_power(f64::from(single), exact, f64::from(f32::EPSILON));
            }
        }
    }

    #[test]
    fn powers_of_two_are_exact() {
        for exponent in -1022..=1023 {
            assert_eq!(Scalar::powi(2.0_f64, exponent).log2(), f64::from(exponent));
        }
    }

    #[test]
    fn the_zeroth_power_is_one_and_a_negative_power_of_zero_infinite() {
        for base in [0.0, -3.0, f64::INFINITY, f64::NAN] {
            assert_eq!(Scalar::powi(base, 0), 1.0);
        }
        assert_eq!(Scalar::powi(0.0_f64, 3), 0.0);
        assert_eq!(Scalar::powi(0.0_f64, -1), f64::INFINITY);
        assert_eq!(Scalar::powi(-0.0_f64, -3), f64::NEG_INFINITY);
        assert_eq!(Scalar::powi(1.0_f64, i32::MIN), 1.0);
    }

    /// A row per function: name, this trait, the standard library, and an argument in its domain.
    macro_rules! check_functions {
        ($float:ident; $($function:ident at $($argument:expr),+;)*) => {$(
            let ours = <$float as Scalar>::$function($($argument),+);
            let std = $float::$function($($argument),+);
            // The platform's function with `std`, within two ulps the same with libm.
            assert!(
                (ours - std).abs() <= 2.0 * $float::EPSILON * std.abs() && std != 0.0,
                "{}: {ours} for {std}", stringify!($function)
            );
        )*};
    }

    #[test]
    fn functions_of_f64_are_those_of_the_standard_library() {
        check_functions!(f64;
            powf at 2.3, -1.7; sqrt at 2.3; sin at 2.3; cos at 2.3; tan at 2.3; exp at 2.3; ln at 2.3;
            asin at 0.6; acos at 0.6; atan at 2.3; atan2 at -2.3, -0.7; sinh at 2.3; cosh at 2.3; tanh at 0.6;
            abs at -2.3; signum at -2.3;
        );
    }

    #[test]
    fn functions_of_f32_are_those_of_the_standard_library() {
        check_functions!(f32;
            powf at 2.3, -1.7; sqrt at 2.3; sin at 2.3; cos at 2.3; tan at 2.3; exp at 2.3; ln at 2.3;
            asin at 0.6; acos at 0.6; atan at 2.3; atan2 at -2.3, -0.7; sinh at 2.3; cosh at 2.3; tanh at 0.6;
            abs at -2.3; signum at -2.3;
        );
    }

    #[test]
    fn sin_cos_is_sine_and_cosine() {
        // Equality of bits: the pair is made of the two functions.
        assert_eq!(Scalar::sin_cos(2.3_f64), (Scalar::sin(2.3_f64), Scalar::cos(2.3_f64)));
    }

    #[test]
    fn a_power_of_a_negative_base_and_a_root_of_a_negative_number_are_not_numbers() {
        assert!(Scalar::powf(-2.0_f64, 0.5).is_nan());
        assert!(Scalar::sqrt(-2.0_f64).is_nan());
    }

    #[test]
    fn the_sign_of_zero_is_kept() {
        assert_eq!((Scalar::signum(0.0_f64), Scalar::signum(-0.0_f64)), (1.0, -1.0));
    }

    #[test]
    fn literals_are_rounded_to_the_type() {
        assert_eq!(f64::from_f64(0.1), 0.1);
        assert_eq!(f32::from_f64(0.1), 0.1_f32);
        assert_eq!(f32::from_f64(1e300), f32::INFINITY);
    }
}
