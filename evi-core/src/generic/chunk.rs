//! Chunks of infinitesimals.
//!
//! In: a value and the direction it is moved in. Out: a dual number; and back, its derivatives added to vectors and
//! matrices. Which chunks are evaluated at what point is left to [`derivatives`](super::derivatives).

use nalgebra::{Const, DMatrix, SVector, U1};
use num_dual::{Derivative, DualSVec64, HyperDualSVec64};

/// Infinitesimals per evaluation in each of the two directions.
///
/// Midpoint step with 1, 2, 4, 8: double pendulum (n = 4) 2.74, 4.79, 2.64, 5.33 µs; chain of 5 links (n = 10) 23.9, 21.4,
/// 14.5, 21.4 µs; of 10 links 177, 128, 60, 80 µs; only at n = 1 is 1 faster (0.30 against 0.56 µs). The kernel of one node
/// alone, on the double pendulum: 120 ns by `HyperDual64` for each of the 16 entries of `D₁D₂L_d` in turn, 80 to 120 ns
/// by this for all, 280 to 380 ns by `HyperDual64` for the 36 of the Hessian in (q, v), 600 to 1270 ns by one
/// `Dual2SVec64<8>` for that Hessian. (x86-64, baseline instruction set, rustc 1.95, a shared machine; a specialised step
/// took 0.9 µs in the same minutes.)
pub(super) const CHUNK: usize = 4;

/// A number with one chunk of infinitesimals `ε`: first derivatives.
pub(super) type Gradient = DualSVec64<CHUNK>;
/// A number with a chunk `ε`, a chunk `δ` and all products `ε δ`: mixed second derivatives.
pub(super) type Mixed = HyperDualSVec64<CHUNK, CHUNK>;

/// The infinitesimal of variable `i` in the chunk that begins at `first`; none outside the chunk or along zero, so that
/// constants stay constants.
#[inline]
pub(super) fn infinitesimal(i: usize, first: usize, seed: f64) -> Derivative<f64, Const<CHUNK>, U1> {
    // Exact zero: a direction that leaves the argument alone.
    if !(first..first + CHUNK).contains(&i) || seed == 0.0 {
        return Derivative::none();
    }
    let mut unit = SVector::<f64, CHUNK>::zeros();
    unit[i - first] = seed;
    Derivative::some(unit)
}

/// Variable `i` with an infinitesimal in the chunk of rows and one in the chunk of columns.
#[inline]
pub(super) fn mixed(
    value: f64,
    i: usize,
    (row, along_row): (usize, f64),
    (col, along_col): (usize, f64),
) -> Mixed {
    let columns = infinitesimal(i, col, along_col).0.map(|unit| unit.transpose());
    Mixed::new(value, infinitesimal(i, row, along_row), Derivative::new(columns), Derivative::none())
}

#[inline]
pub(super) fn add_scaled(chunk: Derivative<f64, Const<CHUNK>, U1>, weight: f64, sum: &mut [f64]) {
    if let Some(chunk) = chunk.0 {
        for (sum, value) in sum.iter_mut().zip(chunk.iter()) {
            *sum += weight * value;
        }
    }
}

/// Adds `weight` times the second derivatives in `value` to the entries of `block` from `(row, col)` on; `block` may be the
/// corner of a larger matrix, to which infinitesimals of absent variables add nothing.
#[inline]
pub(super) fn add_block(value: &Mixed, weight: f64, (row, col): (usize, usize), block: &mut DMatrix<f64>) {
    let Some(second) = &value.eps1eps2.0 else { return };
    for j in 0..CHUNK.min(block.ncols() - col) {
        for i in 0..CHUNK.min(block.nrows() - row) {
            block[(row + i, col + j)] += weight * second[(i, j)];
        }
    }
}

/// Adds the transposed second derivatives in `value` to the entries of `block` from `(col, row)` on.
#[inline]
pub(super) fn add_transposed_block(value: &Mixed, (row, col): (usize, usize), block: &mut DMatrix<f64>) {
    let Some(second) = &value.eps1eps2.0 else { return };
    for j in 0..CHUNK.min(block.nrows() - col) {
        for i in 0..CHUNK.min(block.ncols() - row) {
            block[(col + j, row + i)] += second[(i, j)];
        }
    }
}

/// A value that moves at `rate` along the first infinitesimal `δ`.
#[inline]
pub(super) fn moved(value: f64, rate: f64) -> Mixed {
    mixed(value, 0, (0, 0.0), (0, rate))
}

/// Subtracts the derivatives by `ε` and the first `δ`.
#[inline]
pub(super) fn subtract_first_column(value: &Mixed, sum: &mut [f64]) {
    if let Some(second) = &value.eps1eps2.0 {
        for (sum, value) in sum.iter_mut().zip(second.column(0).iter()) {
            *sum -= value;
        }
    }
}
