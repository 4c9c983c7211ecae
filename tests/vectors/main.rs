//! Vectors, arrays, sums and families: scenes that are unrolled, scenes that stay loops, and scenes that are written number by number
//! have the same kernels. Bodies in directors are rigid bodies.

mod bodies;
mod dense;
mod frequencies;
mod loops;
mod unrolled;
mod watched;
