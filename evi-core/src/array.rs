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

    /// The array of equal elements.
    fn filled(element: X) -> Self
    where
        X: Copy;
}

impl<X: Clone, const N: usize> Array<X> for [X; N] {
    const LEN: usize = N;

    #[inline]
    fn from_fn(element: impl FnMut(usize) -> X) -> Self {
        core::array::from_fn(element)
    }

    #[inline(always)]
    fn filled(element: X) -> Self
    where
        X: Copy,
    {
        [element; N]
    }
}

#[cfg(test)]
mod tests {
    use super::Array;

    #[test]
    fn an_array_knows_its_length_and_is_filled_by_index() {
        assert_eq!(<[f64; 3] as Array<f64>>::LEN, 3);
        assert_eq!(<[usize; 3] as Array<usize>>::from_fn(|i| 10 * i), [0, 10, 20]);
    }

    #[test]
    fn an_empty_index_set_asks_for_no_element() {
        let empty = <[f64; 0] as Array<f64>>::from_fn(|i| unreachable!("element {i} of none"));
        assert_eq!(empty.as_ref(), &[] as &[f64]);
    }
}
