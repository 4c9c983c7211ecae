//! Eight numbers side by side: a [`Scalar`] whose operations are those of eight vector lanes.
//!
//! The operations are loops over an array, which the compiler turns into vector instructions of the width that the function around
//! them may use ([`InstructionSet`](super::InstructionSet)): therefore each of them is inlined there. Sine and cosine
//! are computed for all lanes together, within an ulp; the other elementary functions are those of `f64`, lane by lane.

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

    /// The same numbers, from memory, where a register of all of them has been written.
    ///
    /// The compiler puts lanes into registers by looking backwards from where neighbours in memory are written. From sums over lanes, and from products
    /// with single lanes, it looks for other neighbours, and finds pairs of coordinates instead of eight nodes: a step of the double pendulum then takes
    /// a third longer. A lane that is to be spread over a register is read from memory anyway.
    #[inline(always)]
    #[must_use]
    pub const fn stored(self) -> Self {
        core::hint::black_box(self)
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
        let x = self.stored().0;
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
            #[cfg(feature = "std")]
            #[inline(always)]
            fn compiled_apart<R>(kernel: impl FnOnce() -> R) -> R {
                super::InstructionSet::detect().run(super::instruction_set::Apart(kernel))
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
            #[inline(always)]
            fn sin(self) -> Self {
                sine_cosine(self).0
            }
            #[inline(always)]
            fn cos(self) -> Self {
                sine_cosine(self).1
            }
            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                sine_cosine(self)
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

elementary!(sqrt tan exp ln asin acos atan sinh cosh tanh abs signum);

/// Sine and cosine of every lane: within an ulp of those of `f64` for angles up to 1e6, beyond the same; a zero
/// may lose its sign.
#[inline(always)]
fn sine_cosine(x: Lanes) -> (Lanes, Lanes) {
    /// Whole multiples of π/2 up to here have exact products with its first two parts.
    const LARGEST: f64 = 1e6;
    // Written so that a NaN takes the other way.
    let is_small = x.map(|x| if x.abs() <= LARGEST { 0.0 } else { 1.0 }).largest() == 0.0;
    if !is_small {
        return (x.map(Scalar::sin), x.map(Scalar::cos));
    }
    let (mut sine, mut cosine) = (Lanes::ZERO, Lanes::ZERO);
    for lane in 0..LANES {
        (sine.0[lane], cosine.0[lane]) = small_sine_cosine(x.0[lane]);
    }
    (sine, cosine)
}

/// Without branches, so that the lanes stay together: reduction by multiples of π/2 in three parts (Cody & Waite, Software Manual for the Elementary
/// Functions, 1980), polynomials and constants of fdlibm (`k_sin.c`, `k_cos.c`, `e_rem_pio2.c`; Sun Microsystems, 1993).
#[inline(always)]
fn small_sine_cosine(x: f64) -> (f64, f64) {
    const PI_HALVES: [f64; 3] =
        [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];
    const SINE: [f64; 6] = [
        -0.166_666_666_666_666_32,
        0.008_333_333_333_322_49,
        -0.000_198_412_698_298_579_5,
        2.755_731_370_707_006_8e-6,
        -2.505_076_025_340_686_3e-8,
        1.589_690_995_211_55e-10,
    ];
    const COSINE: [f64; 6] = [
        0.041_666_666_666_666_6,
        -0.001_388_888_888_887_411,
        2.480_158_728_947_673e-5,
        -2.755_731_435_139_066_3e-7,
        2.087_572_321_298_175e-9,
        -1.135_964_755_778_819_5e-11,
    ];
    /// Added to a number, leaves its nearest whole number in the last bits.
    const TO_WHOLE: f64 = 6_755_399_441_055_744.0;
    let shifted = x * core::f64::consts::FRAC_2_PI + TO_WHOLE;
    let quadrant = shifted.to_bits();
    let multiple = shifted - TO_WHOLE;
    let first = x - multiple * PI_HALVES[0];
    let second = multiple * PI_HALVES[1];
    let rest = first - second;
    let y = ((first - rest) - second) - multiple * PI_HALVES[2];
    let r = rest + y;
    let y = (rest - r) + y;
    let z = r * r;
    let cube = z * r;
    let s = SINE[1] + z * (SINE[2] + z * (SINE[3] + z * (SINE[4] + z * SINE[5])));
    let sine = r - ((z * (0.5 * y - cube * s) - y) - cube * SINE[0]);
    let c = z
        * (COSINE[0] + z * (COSINE[1] + z * (COSINE[2] + z * (COSINE[3] + z * (COSINE[4] + z * COSINE[5])))));
    let half = 0.5 * z;
    let w = 1.0 - half;
    let cosine = w + (((1.0 - w) - half) + (z * c - r * y));
    // Odd quadrants exchange the two; the second bit turns a sign.
    let odd = 0_u64.wrapping_sub(quadrant & 1);
    let (s, c) = (sine.to_bits(), cosine.to_bits());
    let sine_sign = (quadrant & 2) << 62;
    let cosine_sign = (quadrant.wrapping_add(1) & 2) << 62;
    (
        f64::from_bits(((s & !odd) | (c & odd)) ^ sine_sign),
        f64::from_bits(((c & !odd) | (s & odd)) ^ cosine_sign),
    )
}

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
        check_functions!(sqrt tan exp ln asin acos atan sinh cosh tanh abs signum);
    }

    /// Distance in units of the last place of the larger of the two.
    fn ulps(a: f64, b: f64) -> f64 {
        if a == b || (a.is_nan() && b.is_nan()) {
            return 0.0;
        }
        let size = a.abs().max(b.abs());
        (a - b).abs() / (f64::from_bits(size.to_bits() + 1) - size)
    }

    #[test]
    fn sine_and_cosine_are_within_an_ulp_of_those_of_f64() {
        let mut largest = 0.0_f64;
        // Steps that share nothing with π, over ten decades and both signs; multiples of π/4 as floats.
        for k in 0..200_000_i32 {
            let scale = 10.0_f64.powi(k % 13 - 6);
            let x = Lanes::new(core::array::from_fn(|lane| {
                let x = 0.618_033_988_749_894_9 * f64::from(k * 8 + lane as i32);
                if k % 17 == 0 {
                    f64::from(k) * core::f64::consts::FRAC_PI_4
                } else {
                    scale * (x - x.floor() - 0.5)
                }
            }));
            let (sine, cosine) = x.sin_cos();
            for lane in 0..LANES {
                largest = largest.max(ulps(sine.0[lane], Scalar::sin(x.0[lane])));
                largest = largest.max(ulps(cosine.0[lane], Scalar::cos(x.0[lane])));
            }
        }
        println!("{largest} ulp");
        assert!(largest <= 1.0, "{largest} ulp");
    }

    #[test]
    fn angles_without_end_are_those_of_f64() {
        let x = X.with(3, f64::NAN).with(4, f64::INFINITY).with(5, -3e7).with(6, -0.0);
        for lane in 0..LANES {
            assert!(ulps(x.sin().0[lane], Scalar::sin(x.0[lane])) == 0.0);
            assert!(ulps(x.cos().0[lane], Scalar::cos(x.0[lane])) == 0.0);
        }
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
