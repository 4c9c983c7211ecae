//! Numbers with 71 digits, for the kernels of a scene.

use std::ops::{Add, Div, Mul, Neg, Sub};

use evi_core::scalar::Scalar;
use f256::f256;

/// A number of IEEE octuple precision; its operations and functions are rounded once.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Octuple(f256);

impl Octuple {
    /// The nearest `f64`.
    pub fn rounded(self) -> f64 {
        self.0.to_string().parse().expect("the digits of a number")
    }
}

macro_rules! operators {
    ($($Trait:ident::$method:ident),*) => {
        $(impl $Trait for Octuple {
            type Output = Self;

            fn $method(self, other: Self) -> Self {
                Self($Trait::$method(self.0, other.0))
            }
        })*
    };
}
operators!(Add::add, Sub::sub, Mul::mul, Div::div);

impl Neg for Octuple {
    type Output = Self;

    fn neg(self) -> Self {
        Self(-self.0)
    }
}

macro_rules! functions {
    ($($method:ident),*) => {
        $(fn $method(self) -> Self {
            Self(self.0.$method())
        })*
    };
}

impl Scalar for Octuple {
    fn from_f64(value: f64) -> Self {
        Self(value.into())
    }

    fn powf(self, exponent: Self) -> Self {
        Self(self.0.powf(&exponent.0))
    }

    fn atan2(self, x: Self) -> Self {
        Self(self.0.atan2(&x.0))
    }

    functions!(sqrt, sin, cos, tan, exp, ln, asin, acos, atan, abs);

    fn sinh(self) -> Self {
        (self.exp() - (-self).exp()) / Self::from_f64(2.0)
    }

    fn cosh(self) -> Self {
        (self.exp() + (-self).exp()) / Self::from_f64(2.0)
    }

    fn tanh(self) -> Self {
        self.sinh() / self.cosh()
    }

    fn signum(self) -> Self {
        Self::from_f64(if self.0.is_sign_negative() { -1.0 } else { 1.0 })
    }
}
