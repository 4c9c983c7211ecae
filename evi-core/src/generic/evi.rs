//! The exponential variational integrator of the generic path.
//!
//! In: quadrature, frequency and step size, as for [`Evi`](crate::integrator::Evi). Out: the weights and directions of
//! every node for a number of coordinates, or why they define no step.

use super::GenericSystem;
use super::derivatives::Seed;
use super::evi_step::EviStages;
use super::scheme::{Frequencies, GenericScheme};
use super::step::Equations;
use crate::integrator::Composition;
use crate::scheme::{
    Frequency, NodeCoefficients, Quadrature, SchemeError, check_interpolant, checked_step_size,
};

/// The exponential variational integrator for a [`GenericSystem`]: the scheme of [`Evi`](crate::integrator::Evi),
/// on matrices of a size known at run time, with derivatives by dual numbers.
///
/// Symplectic and of order 2 for symmetric nodes as `Evi` is; linear interpolation by default.
///
/// ```
/// use evi_core::generic::{GenericEvi, GenericScheme, GenericSystem};
/// use evi_core::scalar::Scalar;
///
/// /// A chain of masses `m` on springs of stiffness `k`, between two walls.
/// struct Springs { masses: usize, m: f64, k: f64 }
///
/// impl GenericSystem for Springs {
///     fn n_coordinates(&self) -> usize { self.masses }
///     fn n_constraints(&self) -> usize { 0 }
///     fn lagrangian<T: Scalar>(&self, _t: T, q: &[T], v: &[T]) -> T {
///         let mut kinetic = T::from_f64(0.0);
///         let mut potential = q[self.masses - 1].powi(2);
///         for i in 0..self.masses {
///             kinetic = kinetic + v[i].powi(2);
///             potential = potential + if i == 0 { q[0] } else { q[i] - q[i - 1] }.powi(2);
///         }
///         T::from_f64(0.5 * self.m) * kinetic - T::from_f64(0.5 * self.k) * potential
///     }
///     fn constraints<T: Scalar>(&self, _t: T, _q: &[T], _residuals: &mut [T]) {}
/// }
///
/// let masses = 5;
/// let springs = Springs { masses, m: 1.0, k: 4.0 };
/// let mut run = GenericEvi::midpoint(0.01).start(springs, &vec![0.1; masses], &vec![0.0; masses])?;
/// let energy = run.energy();
/// run.advance_to(10.0)?;
/// assert!((run.energy() - energy).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct GenericEvi {
    offsets: Vec<f64>,
    weights: Vec<f64>,
    h: f64,
    frequencies: Frequencies,
    /// Fractions of a step that its stages take.
    fractions: Vec<f64>,
    /// Whether the nodes mirror each other, which compositions need.
    symmetry: Result<(), SchemeError>,
}

impl GenericEvi {
    /// The implicit midpoint member, `S = 1`, for steps of size `h` (units of time; negative steps go back in time).
    pub fn midpoint(h: f64) -> Self {
        Self::new(&Quadrature::midpoint(), h)
    }

    /// The member on Simpson's rule, `S = 3` equally spaced points.
    pub fn simpson(h: f64) -> Self {
        Self::new(&Quadrature::<3>::uniform(), h)
    }

    /// The member on the nodes of `quadrature`, with linear interpolation.
    pub fn new<const K: usize>(quadrature: &Quadrature<K>, h: f64) -> Self {
        Self {
            offsets: quadrature.offsets().to_vec(),
            weights: quadrature.weights().to_vec(),
            h,
            frequencies: Frequencies::Uniform(Frequency::ZERO),
            fractions: vec![1.0],
            symmetry: quadrature.check_symmetry(),
        }
    }

    /// Takes the steps of this scheme as the stages of a composition, for order 4, 6 or 8 from symmetric nodes, as
    /// [`Symmetric::composed`](crate::integrator::Symmetric::composed) does. The step size stays what it was.
    #[must_use]
    pub fn composed<const N: usize>(self, composition: Composition<N>) -> Self {
        let stages =
            |fraction: &f64| self.fractions.iter().map(move |inner| fraction * inner).collect::<Vec<_>>();
        let fractions = composition.fractions().iter().flat_map(stages).collect();
        Self { fractions, ..self }
    }

    /// Interpolates every coordinate with the same frequency.
    #[must_use]
    pub fn frequency(self, frequency: impl Into<Frequency>) -> Self {
        Self { frequencies: Frequencies::Uniform(frequency.into()), ..self }
    }

    /// Interpolates coordinate `i` with `frequencies[i]`. Coordinates of one body should share theirs.
    #[must_use]
    pub fn frequencies(self, frequencies: impl Into<Vec<Frequency>>) -> Self {
        Self { frequencies: Frequencies::PerCoordinate(frequencies.into()), ..self }
    }
}

impl GenericScheme for GenericEvi {
    fn step_size(&self) -> f64 {
        self.h
    }

    fn prepare(&self, system: &impl GenericSystem) -> Result<Equations, SchemeError> {
        Ok(Equations::Evi(Box::new(EviStages::new(system, self.stages(system.n_coordinates())?))))
    }
}

impl GenericEvi {
    /// The nodes of every stage of a step for `n` coordinates.
    fn stages(&self, n_coordinates: usize) -> Result<Vec<Nodes>, SchemeError> {
        checked_step_size(self.h)?;
        if self.fractions.len() > 1 {
            self.symmetry?;
        }
        self.fractions.iter().map(|fraction| self.nodes(n_coordinates, fraction * self.h)).collect()
    }

    /// The nodes of a stage of size `h`.
    fn nodes(&self, n_coordinates: usize, h: f64) -> Result<Nodes, SchemeError> {
        let h = checked_step_size(h)?;
        let mut nodes = Nodes { h, nodes: Vec::new() };
        for (&offset, &weight) in self.offsets.iter().zip(&self.weights) {
            nodes.nodes.push(Node { offset, weight, coefficients: vec![], starts: vec![], ends: vec![] });
        }
        self.frequencies.check(n_coordinates)?;
        for i in 0..n_coordinates {
            let frequency = self.frequencies.of(i);
            let coefficients: Vec<_> =
                self.offsets.iter().map(|&offset| NodeCoefficients::new(frequency, h, offset)).collect();
            check_interpolant(frequency, i, h, &self.weights, &coefficients)?;
            for (node, c) in nodes.nodes.iter_mut().zip(coefficients) {
                node.coefficients.push(c);
                node.starts.push(Seed { q: h * c.start(), v: c.start_rate() });
                node.ends.push(Seed { q: h * c.end(), v: c.end_rate() });
            }
        }
        Ok(nodes)
    }
}

/// The nodes of a stage of size `h`.
pub(super) struct Nodes {
    pub(super) h: f64,
    pub(super) nodes: Vec<Node>,
}

/// One node of a step, for every coordinate.
pub(super) struct Node {
    /// `σ = c − ½`.
    pub(super) offset: f64,
    pub(super) weight: f64,
    coefficients: Vec<NodeCoefficients>,
    /// `h ∂(x, v)/∂q₀`: along these, `∂L/∂ε` is the node's part of `D₁L_d`.
    pub(super) starts: Vec<Seed>,
    /// `h ∂(x, v)/∂q₁`: along these, `∂L/∂ε` is the node's part of `D₂L_d`.
    pub(super) ends: Vec<Seed>,
}

impl Node {
    /// Overwrites `x` and `v` with position and velocity at this node of the curve from `q` to `q + difference`.
    pub(super) fn interpolate(&self, h: f64, q: &[f64], difference: &[f64], x: &mut [f64], v: &mut [f64]) {
        let inverse_h = 1.0 / h;
        for (i, c) in self.coefficients.iter().enumerate() {
            let (s, d) = (q[i] + 0.5 * difference[i], difference[i]);
            x[i] = c.even * s + c.odd * d;
            v[i] = (c.even_rate * s + c.odd_rate * d) * inverse_h;
        }
    }
}
