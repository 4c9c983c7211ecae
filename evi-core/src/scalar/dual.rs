//! [`Scalar`] for the dual numbers of num-dual: forward-mode derivatives of the generic copy.

use num_dual::{Dual64, DualNum, HyperDual64};
use num_traits::Signed;

use super::Scalar;

macro_rules! dual_scalar {
    ($($dual:ty),*) => {$(
        impl Scalar for $dual {
            #[inline]
            fn from_f64(value: f64) -> Self {
                Self::from(value)
            }
            #[inline]
            fn powf(self, exponent: Self) -> Self {
                self.powd(exponent)
            }
            #[inline]
            fn atan2(self, x: Self) -> Self {
                DualNum::atan2(&self, x)
            }
            #[inline]
            fn abs(self) -> Self {
                Signed::abs(&self)
            }
            #[inline]
            fn signum(self) -> Self {
                Signed::signum(&self)
            }
            dual_scalar!(@functions sqrt sin cos tan exp ln asin acos atan sinh cosh tanh);
        }
    )*};
    (@functions $($function:ident)*) => {$(
        #[inline]
        fn $function(self) -> Self {
            DualNum::$function(&self)
        }
    )*};
}

dual_scalar!(Dual64, HyperDual64);
