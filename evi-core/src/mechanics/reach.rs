//! What a step is found to the round-off of.
//!
//! In: how long a configuration is and the way from there in a step, with units `√Mᵢᵢ` and in plain numbers. Out: the reach `r` in the metric of the masses,
//! whose round-off ends an iteration, and the units in which corrections are compared with it:
//!
//! ```text
//! r(q, d) = max(min(|q| + |d|, 8 |d|), (|q| + |d|)/16)        sᵢ = max(√Mᵢᵢ, r_M / 16 r₁)
//! ```
//!
//! with `r_M` in the metric and `r₁` in plain numbers: a correction counts by the measure in which it is longer.

use super::relative;
use crate::linear::largest_magnitude;
use crate::newton::LIGHT;
use crate::scalar::{Lanes, Scalar};
use crate::system::MechanicalSystem;

/// A step of an eighth of the configuration is not short.
pub(crate) const LONG: f64 = 8.0;
/// Points are sums of a configuration: closer is not to be had.
pub(crate) const CLOSEST: f64 = 1.0 / 16.0;

/// A length, measured twice: in the metric of the mass matrix, which does not see what is light beside the rest, and in plain numbers, which do not see
/// what has large units.
#[derive(Clone, Copy, Default)]
pub(crate) struct Length {
    pub(crate) metric: f64,
    plain: f64,
}

impl Length {
    /// The larger one of this and of a coordinate with this unit, `√Mᵢᵢ`.
    #[inline(always)]
    pub(crate) fn with(self, unit: f64, x: f64) -> Self {
        let x = x.abs();
        Self { metric: larger(unit * x, self.metric), plain: larger(x, self.plain) }
    }

    /// The longest coordinate, where units are `1/scale`; NaN if one is.
    pub(crate) fn in_units(x: &[f64], scale: &[f64]) -> Self {
        Self::of(x.iter().copied(), scale)
    }

    /// The same of `a − b`.
    pub(crate) fn between(a: &[f64], b: &[f64], scale: &[f64]) -> Self {
        Self::of(a.iter().zip(b).map(|(a, b)| a - b), scale)
    }

    fn of(x: impl Iterator<Item = f64> + Clone, scale: &[f64]) -> Self {
        Self {
            metric: largest_magnitude(x.clone().zip(scale).map(|(x, scale)| x / scale)),
            plain: largest_magnitude(x),
        }
    }

    /// The longest of `√Σ xᵢ²` over all nodes, where `inertia` is the metric.
    #[inline(always)]
    pub(crate) fn of_nodes<S: MechanicalSystem>(
        inertia: &S::PerCoordinate<Lanes>,
        x: &S::PerCoordinate<Lanes>,
    ) -> Self {
        let (mut metric, mut plain) = (Lanes::ZERO, Lanes::ZERO);
        for i in 0..S::N_COORDINATES {
            let square = x[i] * x[i];
            metric = metric + inertia[i] * square;
            plain = plain + square;
        }
        let [metric, plain] = [metric, plain].map(|squares| Scalar::sqrt(squares.largest()));
        Self { metric, plain }
    }

    /// The longer one by each measure; NaN if one is.
    pub(crate) fn or(self, other: Self) -> Self {
        self.map(other, |a, b| largest_magnitude([a, b]))
    }

    /// This times `factor`, which is positive.
    #[inline(always)]
    pub(crate) fn times(self, factor: f64) -> Self {
        Self { metric: factor * self.metric, plain: factor * self.plain }
    }

    /// This over `reference`, by the measure in which it is longer.
    pub(crate) fn relative_to(self, reference: Self) -> f64 {
        let Self { metric, plain } = self.map(reference, relative);
        largest_magnitude([metric, LIGHT * plain])
    }

    /// What a step is found to the round-off of that begins at a configuration of this length, and goes so far: points are found to the round-off of the
    /// configuration, to less in steps that are short beside it, since what points are off by, velocities are off by the `h`-th part of.
    #[inline(always)]
    pub(crate) fn reach(self, way: Self) -> Self {
        self.map(way, |here, way| {
            let here = here + way;
            let limited = if LONG * way < here { LONG * way } else { here };
            larger(limited, CLOSEST * here)
        })
    }

    /// The unit that a coordinate has at least, for its displacements to be compared with this reach in the metric: those of what is lighter count in plain
    /// numbers.
    #[inline(always)]
    pub(crate) fn least_unit(self) -> f64 {
        if self.plain > 0.0 { LIGHT * self.metric / self.plain } else { 0.0 }
    }

    /// The metric, but for what is lighter: [`least_unit`](Self::least_unit).
    #[inline(always)]
    pub(crate) fn with_light<S: MechanicalSystem>(
        self,
        mut inertia: S::PerCoordinate<Lanes>,
    ) -> S::PerCoordinate<Lanes> {
        let least = Lanes::splat(self.least_unit() * self.least_unit());
        for i in 0..S::N_COORDINATES {
            inertia[i] = inertia[i].larger(least);
        }
        inertia
    }

    #[inline(always)]
    fn map(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self { metric: f(self.metric, other.metric), plain: f(self.plain, other.plain) }
    }
}

/// Whether one of these units may be below [`Length::least_unit`].
pub(crate) fn has_light(units: &[f64]) -> bool {
    let largest = largest_magnitude(units.iter().copied());
    units.iter().any(|unit| *unit < LIGHT * largest)
}

/// As the machine takes it: one instruction, where `f64::max` looks for a NaN.
#[inline(always)]
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// `√mass` as a power of two.
pub(crate) fn unit(mass: f64) -> f64 {
    Scalar::sqrt(mass.abs()).log2().round().exp2()
}
