//! Eight numbers side by side: a [`Scalar`] whose operations are those of eight vector lanes.
//!
//! The operations are loops over an array, which the compiler turns into vector instructions of the width that the function around
//! them may use ([`InstructionSet`](super::InstructionSet)): therefore each of them is inlined there. Elementary functions are those
//! of `f64`, lane by lane, to the last bit.

use core::ops::{Add, Div, Mul, Neg, Sub};

use super::Scalar;

/// Number of lanes: two registers of AVX2, four of SSE2.
pub const LANES: usize = 8;

/// Eight numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Lanes([f64; LANES]);

impl Lanes {
    /// Eight zeros.
    pub const ZERO: Self = Self([0.0; LANES]);

    /// The numbers, lane by lane.
    #[inline(always)]
    pub const fn new(lanes: [f64; LANES]) -> Self {
        Self(lanes)
    }

    /// The same number in every lane.
    #[inline(always)]
    pub const fn splat(value: f64) -> Self {
        Self([value; LANES])
    }

    /// The lanes.
    #[inline(always)]
    pub const fn to_array(self) -> [f64; LANES] {
        self.0
    }

    /// The lanes with another number in one of them.
    #[inline(always)]
    #[must_use]
    pub const fn with(self, lane: usize, value: f64) -> Self {
        let mut lanes = self.0;
        lanes[lane] = value;
        Self(lanes)
    }

    /// `self · factor + term`, rounded once if `FUSED`: the caller knows whether the machine has an instruction for it.
    #[cfg(feature = "std")]
    #[inline(always)]
    #[must_use]
    pub fn times_plus<const FUSED: bool>(self, factor: Self, term: Self) -> Self {
        let mut result = [0.0; LANES];
        for lane in 0..LANES {
            result[lane] = if FUSED {
                self.0[lane].mul_add(factor.0[lane], term.0[lane])
            } else {
                self.0[lane] * factor.0[lane] + term.0[lane]
            };
        }
        Self(result)
    }

    /// The larger number of every lane; of a NaN in `self` nothing remains, one in `other` stays.
    #[inline(always)]
    #[must_use]
    pub const fn larger(self, other: Self) -> Self {
        let mut result = [0.0; LANES];
        let mut lane = 0;
        while lane < LANES {
            result[lane] = if self.0[lane] > other.0[lane] { self.0[lane] } else { other.0[lane] };
            lane += 1;
        }
        Self(result)
    }

    /// The largest lane; which one of them it is if some are NaN is not said.
    #[inline(always)]
    pub const fn largest(self) -> f64 {
        let x = self.0;
        let pairs = [larger(x[0], x[1]), larger(x[2], x[3]), larger(x[4], x[5]), larger(x[6], x[7])];
        larger(larger(pairs[0], pairs[1]), larger(pairs[2], pairs[3]))
    }

    /// The sum of all lanes.
    #[inline(always)]
    pub const fn sum(self) -> f64 {
        let x = self.0;
        ((x[0] + x[1]) + (x[2] + x[3])) + ((x[4] + x[5]) + (x[6] + x[7]))
    }

    #[inline(always)]
    fn map(self, function: impl Fn(f64) -> f64) -> Self {
        let mut result = [0.0; LANES];
        for lane in 0..LANES {
            result[lane] = function(self.0[lane]);
        }
        Self(result)
    }

    #[inline(always)]
    fn zip(self, other: Self, function: impl Fn(f64, f64) -> f64) -> Self {
        let mut result = [0.0; LANES];
        for lane in 0..LANES {
            result[lane] = function(self.0[lane], other.0[lane]);
        }
        Self(result)
    }
}

/// As the machine takes it: one instruction, where `f64::max` looks for a NaN.
#[inline(always)]
const fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// A row per operator: trait, method, operator.
macro_rules! operators {
    ($($trait:ident $method:ident $operator:tt),*) => {$(
        impl $trait for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $operator b)
            }
        }
    )*};
}

operators!(Add add +, Sub sub -, Mul mul *, Div div /);

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|x| -x)
    }
}

/// The functions of `f64` in every lane.
macro_rules! elementary {
    ($($function:ident)*) => {
        impl Scalar for Lanes {
            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                Self::splat(value)
            }
            #[inline(always)]
            fn powi(self, exponent: i32) -> Self {
                self.map(|x| Scalar::powi(x, exponent))
            }
            #[inline(always)]
            fn powf(self, exponent: Self) -> Self {
                self.zip(exponent, Scalar::powf)
            }
            #[inline(always)]
            fn atan2(self, x: Self) -> Self {
                self.zip(x, Scalar::atan2)
            }
            $(
                #[inline(always)]
                fn $function(self) -> Self {
                    self.map(Scalar::$function)
                }
            )*
        }
    };
}

elementary!(sqrt sin cos tan exp ln asin acos atan sinh cosh tanh abs signum);

#[cfg(test)]
mod tests {
    use super::*;

    const X: Lanes = Lanes::new([0.3, -1.2, 0.7, 0.0, 5.0, -0.1, 2.5, 1e-3]);
    const Y: Lanes = Lanes::new([1.5, 0.4, -2.0, 3.0, -0.7, 1e3, 0.25, -9.0]);

    /// Equality of bits, NaN included: a lane is an `f64`.
    #[track_caller]
    fn check(lanes: Lanes, scalar: impl Fn(f64, f64) -> f64) {
        for lane in 0..LANES {
            let (ours, theirs) = (lanes.0[lane], scalar(X.0[lane], Y.0[lane]));
            assert!(ours == theirs || (ours.is_nan() && theirs.is_nan()), "lane {lane}: {ours} for {theirs}");
        }
    }

    #[test]
    fn every_lane_is_a_number() {
        check(X + Y, |x, y| x + y);
        check(X - Y, |x, y| x - y);
        check(X * Y, |x, y| x * y);
        check(X / Y, |x, y| x / y);
        check(-X, |x, _| -x);
        check(X.larger(Y), f64::max);
        check(X.powi(3), |x, _| Scalar::powi(x, 3));
        check(X.powi(-2), |x, _| Scalar::powi(x, -2));
        check(Scalar::powf(X, Y), Scalar::powf);
        check(Scalar::atan2(X, Y), Scalar::atan2);
        check(Lanes::from_f64(0.1), |_, _| 0.1);
    }

    macro_rules! check_functions {
        ($($function:ident)*) => {$( check(Scalar::$function(X), |x, _| Scalar::$function(x)); )*};
    }

    #[test]
    fn functions_are_those_of_f64() {
        check_functions!(sqrt sin cos tan exp ln asin acos atan sinh cosh tanh abs signum);
        check(X.sin_cos().0, |x, _| Scalar::sin(x));
        check(X.sin_cos().1, |x, _| Scalar::cos(x));
    }

    #[test]
    fn lanes_are_replaced_compared_and_added_up() {
        assert_eq!(X.with(2, 7.0), Lanes::new([0.3, -1.2, 7.0, 0.0, 5.0, -0.1, 2.5, 1e-3]));
        assert_eq!(X.largest(), 5.0);
        let counting = Lanes::new(core::array::from_fn(|lane| lane as f64));
        assert_eq!(counting.sum(), 28.0);
    }

    #[cfg(feature = "std")]
    #[test]
    fn a_fused_product_is_rounded_once() {
        check(X.times_plus::<true>(Y, X), |x, y| x.mul_add(y, x));
        check(X.times_plus::<false>(Y, X), |x, y| x * y + x);
    }
}
