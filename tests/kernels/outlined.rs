//! Hyperdual numbers whose operations are calls.

use super::*;

/// A hyperdual number whose operations are calls instead of inlined: the generic copies are many, and
/// compiling them is most of what this test costs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outlined(pub(super) HyperDual64);

impl Outlined {
    /// `value + first ε₁ + second ε₂`.
    pub(super) fn new(value: f64, first: f64, second: f64) -> Self {
        Self(HyperDual64::new(value, first, second, 0.0))
    }
}

/// Hands operations on to the implementation for `HyperDual64`.
macro_rules! outlined {
    (operators $($operator:ident $method:ident),*) => {$(
        impl $operator for Outlined {
            type Output = Self;
            #[inline(never)]
            fn $method(self, other: Self) -> Self {
                Self($operator::$method(self.0, other.0))
            }
        }
    )*};
    (functions $($function:ident($($argument:ident: $kind:ty),*)),*) => {$(
        #[inline(never)]
        fn $function(self $(, $argument: $kind)*) -> Self {
            Self(Scalar::$function(self.0 $(, $argument.0)*))
        }
    )*};
}

outlined!(operators Add add, Sub sub, Mul mul, Div div);

impl Neg for Outlined {
    type Output = Self;
    #[inline(never)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Scalar for Outlined {
    fn from_f64(value: f64) -> Self {
        Self(Scalar::from_f64(value))
    }
    #[inline(never)]
    fn powi(self, exponent: i32) -> Self {
        Self(Scalar::powi(self.0, exponent))
    }
    outlined!(functions powf(exponent: Self), atan2(x: Self));
    outlined!(functions sqrt(), sin(), cos(), tan(), exp(), ln(), asin(), acos());
    outlined!(functions atan(), sinh(), cosh(), tanh(), abs(), signum());
}
