//! Vectors, arrays, sums and families: scenes that are unrolled, scenes that stay loops, and scenes that are written number by number
//! have the same kernels.

mod dense;
mod loops;
mod unrolled;
