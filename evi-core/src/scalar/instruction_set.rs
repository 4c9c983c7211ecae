//! Which vector instructions code over [`Lanes`](super::Lanes) is compiled for, chosen when the program runs.
//!
//! A [`LaneOperation`] is compiled once per instruction set, with everything in it that is inlined, and [`InstructionSet::run`] calls the copy for
//! the machine. What is not inlined there is code for the instruction set that the whole program is compiled for.

use core::fmt;

/// A set of vector instructions that this machine has.
///
/// With the feature `dispatch` it is found when the program runs; without it, it is what the program is compiled for
/// (`RUSTFLAGS="-C target-cpu=native"`).
#[derive(Clone, Copy, Debug)]
pub struct InstructionSet(Level);

#[derive(Clone, Copy, Debug)]
enum Level {
    /// What the whole program is compiled for.
    Compiled,
    /// AVX2 with fused products, found at run time: x86-64-v3.
    #[cfg(all(feature = "dispatch", target_arch = "x86_64"))]
    Avx2(pulp::x86::V3),
    /// AVX-512, found at run time: x86-64-v4.
    #[cfg(all(feature = "dispatch", target_arch = "x86_64"))]
    Avx512(pulp::x86::V4),
}

/// Work on lanes.
///
/// ```
/// use evi_core::scalar::{InstructionSet, LaneOperation, Lanes};
///
/// struct Square<'a>(&'a mut [Lanes]);
///
/// impl LaneOperation for Square<'_> {
///     type Output = ();
///     #[inline(always)]
///     fn run<const FUSED: bool>(self) {
///         self.0.iter_mut().for_each(|x| *x = *x * *x);
///     }
/// }
///
/// let mut numbers = [Lanes::splat(3.0); 2];
/// InstructionSet::detect().run(Square(&mut numbers));
/// assert_eq!(numbers[1], Lanes::splat(9.0));
/// ```
pub trait LaneOperation {
    /// What it returns.
    type Output;

    /// Does it; `FUSED` says that the machine has an instruction for products with a sum. Implementations are `#[inline(always)]`, as is what they call:
    /// a function that is not inlined is compiled for the whole program, without these instructions, where a fused product is a call. The
    /// standard library's `map` of arrays and `from_fn` are such functions whenever the compiler pleases; loops are not.
    fn run<const FUSED: bool>(self) -> Self::Output;
}

/// A function, as work on lanes.
pub(super) struct Apart<F>(pub(super) F);

impl<R, F: FnOnce() -> R> LaneOperation for Apart<F> {
    type Output = R;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> R {
        (self.0)()
    }
}

/// An operation on a machine with fused products.
#[cfg(all(feature = "dispatch", target_arch = "x86_64"))]
struct Fused<O>(O);

#[cfg(all(feature = "dispatch", target_arch = "x86_64"))]
impl<O: LaneOperation> pulp::NullaryFnOnce for Fused<O> {
    type Output = O::Output;

    #[inline(always)]
    fn call(self) -> O::Output {
        self.0.run::<true>()
    }
}

impl InstructionSet {
    /// Whether code for the whole program may contain fused products.
    const COMPILED_FUSED: bool = cfg!(any(target_feature = "fma", target_arch = "aarch64"));

    /// The best one that lanes have code for.
    pub fn detect() -> Self {
        #[cfg(all(feature = "dispatch", target_arch = "x86_64"))]
        if !Self::COMPILED_FUSED {
            if let Some(avx512) = pulp::x86::V4::try_new() {
                return Self(Level::Avx512(avx512));
            }
            if let Some(avx2) = pulp::x86::V3::try_new() {
                return Self(Level::Avx2(avx2));
            }
        }
        Self(Level::Compiled)
    }

    /// Its name, for reports.
    pub const fn name(&self) -> &'static str {
        match self.0 {
            #[cfg(all(feature = "dispatch", target_arch = "x86_64"))]
            Level::Avx512(_) => "AVX-512, found at run time",
            #[cfg(all(feature = "dispatch", target_arch = "x86_64"))]
            Level::Avx2(_) => "AVX2 + FMA, found at run time",
            Level::Compiled if cfg!(target_feature = "avx512f") => "AVX-512",
            Level::Compiled if cfg!(all(target_feature = "avx2", target_feature = "fma")) => "AVX2 + FMA",
            Level::Compiled if cfg!(target_arch = "x86_64") => "SSE2",
            Level::Compiled if cfg!(target_arch = "aarch64") => "NEON",
            Level::Compiled => "portable",
        }
    }

    /// Numbers that one register holds.
    pub const fn vector_width(&self) -> usize {
        match self.0 {
            #[cfg(all(feature = "dispatch", target_arch = "x86_64"))]
            Level::Avx512(_) => 8,
            #[cfg(all(feature = "dispatch", target_arch = "x86_64"))]
            Level::Avx2(_) => 4,
            Level::Compiled if cfg!(target_feature = "avx512f") => 8,
            Level::Compiled if cfg!(target_feature = "avx") => 4,
            Level::Compiled if cfg!(any(target_arch = "x86_64", target_arch = "aarch64")) => 2,
            Level::Compiled => 1,
        }
    }

    /// Runs `operation` in code for this instruction set.
    #[inline(always)]
    pub fn run<O: LaneOperation>(self, operation: O) -> O::Output {
        match self.0 {
            #[cfg(all(feature = "dispatch", target_arch = "x86_64"))]
            Level::Avx512(avx512) => avx512.vectorize(Fused(operation)),
            #[cfg(all(feature = "dispatch", target_arch = "x86_64"))]
            Level::Avx2(avx2) => avx2.vectorize(Fused(operation)),
            Level::Compiled if Self::COMPILED_FUSED => operation.run::<true>(),
            Level::Compiled => operation.run::<false>(),
        }
    }
}

impl fmt::Display for InstructionSet {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}, {} numbers wide", self.name(), self.vector_width())
    }
}
