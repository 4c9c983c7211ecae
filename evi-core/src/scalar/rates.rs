//! Rates along several directions side by side, for derivatives by many parameters in one evaluation.

use core::ops::{Add, Neg, Sub};

use super::tangent::Rate;

/// Rates along several directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rates<const W: usize>(pub(crate) [f64; W]);

impl<const W: usize> Rates<W> {
    /// One in a direction, zero in the others.
    pub(crate) fn unit(direction: usize) -> Self {
        Self(core::array::from_fn(|k| if k == direction { 1.0 } else { 0.0 }))
    }
}

impl<const W: usize> Add for Rates<W> {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self(core::array::from_fn(|k| self.0[k] + other.0[k]))
    }
}

impl<const W: usize> Sub for Rates<W> {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self(core::array::from_fn(|k| self.0[k] - other.0[k]))
    }
}

impl<const W: usize> Neg for Rates<W> {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self(self.0.map(|rate| -rate))
    }
}

impl<const W: usize> Rate for Rates<W> {
    const ZERO: Self = Self([0.0; W]);

    #[inline]
    fn times(self, factor: f64) -> Self {
        Self(self.0.map(|rate| rate * factor))
    }

    #[inline]
    fn times_if_moving(self, factor: f64) -> Self {
        Self(self.0.map(|rate| rate.times_if_moving(factor)))
    }
}

#[cfg(test)]
mod tests {
    use super::Rates;
    use crate::scalar::{Rate, Scalar, Tangent};

    #[test]
    fn rates_side_by_side_are_those_of_each_direction() {
        const X: [f64; 2] = [0.6, 0.3];
        const RATES: [[f64; 2]; 2] = [[1.3, -0.7], [0.4, 0.0]];
        fn function<R: Rate>([x, y]: [Tangent<R>; 2]) -> Tangent<R> {
            (x / y - x.powf(y) * y.sin()).atan2(-x) + x.powi(3).sqrt()
        }
        let together = function([0, 1].map(|i| Tangent::new(X[i], Rates(RATES.map(|rates| rates[i])))));
        for k in 0..2 {
            let alone = function([0, 1].map(|i| Tangent::new(X[i], RATES[k][i])));
            // The same operations in the same order.
            assert_eq!((together.value, together.rate.0[k]), (alone.value, alone.rate));
        }
    }
}
