//! Orthonormal bases, by Gram and Schmidt's process, twice each ("twice is enough": Giraud, Langou, Rozložník, van den Eshof,
//! Numer. Math. 101 (2005) 87), which makes them orthonormal to round-off however nearly dependent the vectors are.

use core::{mem, slice};

use crate::array::Array;
use crate::scalar::Scalar;

/// Of vectors that are this fraction of the longest or longer, the first is taken.
const AS_LONG: f64 = 0.5;

/// `x · y`.
#[inline]
pub(crate) fn product<V: Array<f64>>(x: &V, y: &V) -> f64 {
    x.as_ref().iter().zip(y.as_ref()).map(|(x, y)| x * y).sum()
}

/// Subtracts from `x` what the orthonormal `basis` spans of it.
fn remove<V: Array<f64>>(basis: &[V], x: &mut V) {
    for known in basis {
        let share = product(known, x);
        for (x, known) in x.as_mut().iter_mut().zip(known.as_ref()) {
            *x -= share * known;
        }
    }
}

/// Sets `basis[at]` to the direction of what the vectors before it do not span of `x`, and returns the length of that.
fn extend<V: Array<f64>>(basis: &mut [V], at: usize, x: &V) -> f64 {
    let Some((known, [next, ..])) = basis.split_at_mut_checked(at) else { return 0.0 };
    *next = x.clone();
    let mut rest = 0.0;
    for pass in 0..2 {
        remove(known, next);
        let length = Scalar::sqrt(product(next, next));
        // In the second pass only round-off is left to remove.
        rest = if pass == 0 { length } else { rest };
        let scale = if length > 0.0 { 1.0 / length } else { 0.0 };
        for x in next.as_mut() {
            *x *= scale;
        }
    }
    rest
}

/// Overwrites `basis[..rank]` with an orthonormal basis of `rank` of the `vectors`, and the first of `order` with those, always one next of which
/// about as much is left as of any other: an elimination with pivoting by columns. Returns the smallest of these rests; the vectors
/// are overwritten with what is left of them.
pub(crate) fn span<V: Array<f64>>(
    vectors: &mut [V],
    rank: usize,
    basis: &mut [V],
    order: &mut [usize],
) -> f64 {
    let mut smallest = f64::INFINITY;
    for k in 0..rank {
        let Some(rests) = vectors.get_mut(k..) else { break };
        let lengths = rests.iter().map(|rest| product(rest, rest));
        let longest = lengths.clone().fold(0.0, |longest: f64, length| longest.max(length));
        // Of none, where none is a number: the first.
        let ahead = lengths.take_while(|length| *length < AS_LONG * AS_LONG * longest).count();
        // The others keep their order.
        last_to_front(rests.iter_mut().take(ahead + 1));
        last_to_front(order.iter_mut().skip(k).take(ahead + 1));
        let Some((chosen, others)) = rests.split_first_mut() else { break };
        let left = extend(basis, k, chosen);
        let Some(direction) = basis.get(k) else { break };
        for rest in others {
            remove(slice::from_ref(direction), rest);
        }
        // Written so that a NaN survives.
        smallest = if left >= smallest || smallest.is_nan() { smallest } else { left };
    }
    smallest
}

/// Moves the last element before the others.
fn last_to_front<'a, X: 'a>(mut elements: impl Iterator<Item = &'a mut X>) {
    if let Some(first) = elements.next() {
        for element in elements {
            mem::swap(first, element);
        }
    }
}

/// Overwrites `basis[..rank]` with an orthonormal basis of the first `rank` vectors, in their order.
pub(crate) fn in_order<V: Array<f64>>(vectors: &[V], rank: usize, basis: &mut [V]) {
    for (k, vector) in vectors.iter().enumerate().take(rank) {
        extend(basis, k, vector);
    }
}

/// Completes an orthonormal basis of which the first `rank` vectors are there.
pub(crate) fn complete<V: Array<f64>>(rank: usize, basis: &mut [V]) {
    for k in rank..basis.len() {
        // The axis of which the basis so far spans the least.
        let spanned = |axis: usize| basis.iter().take(k).map(|x| x[axis] * x[axis]).sum::<f64>();
        let next = (1..V::LEN).fold(0, |best, axis| if spanned(axis) < spanned(best) { axis } else { best });
        extend(basis, k, &V::from_fn(|i| if i == next { 1.0 } else { 0.0 }));
    }
}
