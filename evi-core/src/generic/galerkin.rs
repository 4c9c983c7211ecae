//! The Galerkin variational integrator of the generic path.
//!
//! In: intervals, frequency and step size, as for [`Galerkin`](crate::integrator::Galerkin). Out: nodes, weights and the rates of the curves
//! for a number of coordinates, or why they define no step.

use nalgebra::DMatrix;

use super::GenericSystem;
use super::galerkin_step::GalerkinPoints;
use super::scheme::{Frequencies, GenericScheme};
use super::step::Equations;
use crate::scheme::{Frequency, LobattoNodes, NodalTable, SchemeError, checked_step_size};

/// The Galerkin variational integrator for a [`GenericSystem`]: the scheme of [`Galerkin`](crate::integrator::Galerkin), solved by Newton's
/// iteration on dense matrices of a size known at run time, with derivatives by dual numbers.
///
/// Of order `2K` for `K` intervals, symplectic, time-symmetric, its inner points on the constraints; polynomials by default.
#[derive(Clone, Debug, PartialEq)]
pub struct GenericGalerkin {
    intervals: usize,
    h: f64,
    frequencies: Frequencies,
}

impl GenericGalerkin {
    /// The member with 1 to 8 intervals between Lobatto nodes, for steps of size `h` (units of time; negative steps go back in time).
    pub const fn new(intervals: usize, h: f64) -> Self {
        Self { intervals, h, frequencies: Frequencies::Uniform(Frequency::ZERO) }
    }

    /// Gives every coordinate the same frequency.
    #[must_use]
    pub fn frequency(self, frequency: impl Into<Frequency>) -> Self {
        Self { frequencies: Frequencies::Uniform(frequency.into()), ..self }
    }

    /// Gives coordinate `i` the frequency `frequencies[i]`.
    #[must_use]
    pub fn frequencies(self, frequencies: impl Into<Vec<Frequency>>) -> Self {
        Self { frequencies: Frequencies::PerCoordinate(frequencies.into()), ..self }
    }

    fn curves<const K: usize>(&self, n_coordinates: usize) -> Result<Curves, SchemeError> {
        let h = checked_step_size(self.h)?;
        self.frequencies.check(n_coordinates)?;
        let rates = |i| Ok(Rates::new(&NodalTable::<K>::new(self.frequencies.of(i), i, h)?));
        let nodes = LobattoNodes::<K>::new();
        let is_end = |b: usize| if b + 1 == K { 1.0 } else { 0.0 };
        Ok(Curves {
            h,
            nodes: (0..=K).map(|j| nodes.node(j)).collect(),
            weights: nodes.weights[..=K].to_vec(),
            rates: (0..n_coordinates).map(rates).collect::<Result<_, SchemeError>>()?,
            continued_differences: DMatrix::from_fn(K, K, |b, a| {
                nodes.lagrange(K, b + 1, 1.0 + nodes.offsets[a + 1]) - is_end(b)
            }),
            continued_impulses: DMatrix::from_fn(K, K, |b, a| {
                nodes.weights[a] / nodes.weights[b] * nodes.lagrange(K - 1, b, 1.0 + nodes.offsets[a])
            }),
        })
    }
}

impl GenericScheme for GenericGalerkin {
    fn step_size(&self) -> f64 {
        self.h
    }

    fn prepare(&self, system: &impl GenericSystem) -> Result<Equations, SchemeError> {
        let n = system.n_coordinates();
        let curves = match self.intervals {
            1 => self.curves::<1>(n),
            2 => self.curves::<2>(n),
            3 => self.curves::<3>(n),
            4 => self.curves::<4>(n),
            5 => self.curves::<5>(n),
            6 => self.curves::<6>(n),
            7 => self.curves::<7>(n),
            8 => self.curves::<8>(n),
            intervals => Err(SchemeError::Intervals { intervals }),
        }?;
        Ok(Equations::Galerkin(Box::new(GalerkinPoints::new(system, curves))))
    }
}

/// The curves of a step through `K + 1` nodes.
pub(super) struct Curves {
    pub(super) h: f64,
    /// Nodes on `[0, 1]`.
    pub(super) nodes: Vec<f64>,
    /// Weights; they add up to 1.
    pub(super) weights: Vec<f64>,
    /// Per coordinate.
    pub(super) rates: Vec<Rates>,
    /// Difference `a` of the next step, on the polynomial through the last, per difference `b` of that: entry `(b, a)`.
    pub(super) continued_differences: DMatrix<f64>,
    /// The same of impulses.
    pub(super) continued_impulses: DMatrix<f64>,
}

impl Curves {
    /// Number of intervals, `K`.
    pub(super) fn intervals(&self) -> usize {
        self.nodes.len() - 1
    }
}

/// `h ẋ` at the nodes as a function of the points of the curve; see [`NodalTable`].
pub(super) struct Rates {
    /// Per point `b`, `b = 0 .. K`, at fixed other points.
    pub(super) per_point: DMatrix<f64>,
    /// Per `x₀` at fixed differences.
    pub(super) start: Vec<f64>,
}

impl Rates {
    fn new<const K: usize>(table: &NodalTable<K>) -> Self {
        Self {
            per_point: DMatrix::from_fn(K + 1, K + 1, |j, a| table.rates(j).per_point(a)),
            start: (0..=K).map(|j| table.rates(j).start).collect(),
        }
    }
}
