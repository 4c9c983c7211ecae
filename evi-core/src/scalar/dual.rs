//! [`Scalar`] for the dual numbers of num-dual: forward-mode derivatives of the generic copy.

use num_dual::{Dual64, DualNum, DualSVec64, HyperDual64, HyperDualSVec64};
use num_traits::Signed;

use super::Scalar;

macro_rules! dual_scalar {
    ($([$($size:ident)*] $dual:ty),*) => {$(
        impl<$(const $size: usize),*> Scalar for $dual {
            #[inline]
            fn from_f64(value: f64) -> Self {
                Self::from(value)
            }
            /// One chain rule instead of a product per bit of the exponent; a negative power is a reciprocal, as for
            /// floats.
            #[inline]
            fn powi(self, exponent: i32) -> Self {
                /// The second derivative's factor `k (k − 1)` is an `i32` up to here.
                const LARGEST: i32 = 46_340;
                if exponent < 0 {
                    return Self::from(1.0) / Scalar::powi(self, exponent.saturating_neg());
                }
                if exponent > LARGEST {
                    let half = Scalar::powi(self, exponent / 2);
                    return if exponent % 2 == 0 { half * half } else { half * half * self };
                }
                DualNum::powi(&self, exponent)
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

dual_scalar!([] Dual64, [] HyperDual64, [N] DualSVec64<N>, [M N] HyperDualSVec64<M, N>);
