//! Storage with a length known to its type.
//!
//! The derive chooses one such type per index set of a scene (coordinates, constraints, unknowns, ...). The
//! integrators only see this trait, so that they need neither generic-const expressions nor nalgebra bounds.

use core::ops::IndexMut;

/// `LEN` values of type `X`, indexed from 0.
pub trait Array<X>: Clone + AsRef<[X]> + AsMut<[X]> + IndexMut<usize, Output = X> {
    /// Number of elements.
    const LEN: usize;

    /// The array whose element `i` is `element(i)`.
    fn from_fn(element: impl FnMut(usize) -> X) -> Self;
}

impl<X: Clone, const N: usize> Array<X> for [X; N] {
    const LEN: usize = N;

    #[inline]
    fn from_fn(element: impl FnMut(usize) -> X) -> Self {
        core::array::from_fn(element)
    }
}
