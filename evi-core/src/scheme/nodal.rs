//! Curves through the Lobatto nodes of a step, and their rates there: the tables of Galerkin integrators.
//!
//! A curve of `S` intervals is the element of
//!
//! ```text
//! span{1, τ, …, τ^S}                              polynomial
//! span{1, τ, …, τ^(S−2), cos uτ, sin uτ}          mixed, u = ω h
//! ```
//!
//! through given points at `S + 1` nodes. Both spaces contain the constants from `S = 2` on. With the entire functions
//! `f_k(x) = Σⱼ (−u²)ʲ k!/(k+2j)! x^(k+2j)`, `k = S−1, S`, which span the same space with the powers below, a mixed curve is the
//! polynomial `p` through the points plus what `f_k − xᵏ` differs from its own interpolant, times coefficients that are
//! linear in the two highest of `p`. Nothing is divided by `u`: the tables go over into the polynomial ones as `u → 0` without
//! cancellation.

use std::sync::OnceLock;

use super::{Frequency, Linear, Quadrature, SchemeError};
use crate::system::MechanicalSystem;

/// The largest number of intervals between nodes.
pub const MOST_INTERVALS: usize = 8;
const MOST_NODES: usize = MOST_INTERVALS + 1;

/// One value per node, the unused last ones zero.
type Nodes = [f64; MOST_NODES];

/// Below this share of its value at `u = 0` a determinant loses three digits: refused.
const SMALLEST_DETERMINANT: f64 = 1e-3;

/// `h ẋ` at one node as a function of the points of the curve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rates<const S: usize> {
    /// Per difference `x_a − x₀`, `a = 1 .. S`.
    pub(crate) differences: [f64; S],
    /// Per `x₀` at fixed differences. Exactly zero where the space contains the constants.
    pub(crate) start: f64,
}

impl<const S: usize> Rates<S> {
    /// `h ẋ` per point `a` at fixed other points.
    #[inline]
    pub(crate) fn per_point(&self, a: usize) -> f64 {
        let of_difference = self.differences.get(a.wrapping_sub(1)).copied();
        of_difference.unwrap_or_else(|| self.start - self.differences.iter().sum::<f64>())
    }
}

/// The rates at all nodes.
#[derive(Clone, Copy, Debug)]
pub struct NodalTable<const S: usize> {
    first: Rates<S>,
    others: [Rates<S>; S],
}

impl<const S: usize> NodalTable<S> {
    /// The rates at a node, counted from 0 to `S`.
    #[inline]
    pub(crate) fn rates(&self, node: usize) -> &Rates<S> {
        self.others.get(node.wrapping_sub(1)).unwrap_or(&self.first)
    }

    /// The table of `frequency` for steps of size `h`; without a frequency that of polynomials.
    #[cfg(feature = "generic")]
    pub(crate) fn new(frequency: Frequency, coordinate: usize, h: f64) -> Result<Self, SchemeError> {
        if frequency == Frequency::ZERO {
            Ok(Self::polynomial())
        } else {
            Self::mixed(frequency, coordinate, h)
        }
    }

    pub(crate) fn polynomial() -> Self {
        let nodes = LobattoNodes::<S>::new();
        Self::from_matrix(&nodes.differentiation(), |_| 0.0)
    }

    /// The table of `frequency` for steps of size `h`.
    fn mixed(frequency: Frequency, coordinate: usize, h: f64) -> Result<Self, SchemeError> {
        let value = frequency.value();
        if !(value.is_finite() && value >= 0.0) {
            return Err(SchemeError::Frequency { coordinate, value });
        }
        let phase = (value * h).abs();
        let intervals = S as f64;
        // Beyond, the alternating series of the highest functions lose digits; a polynomial then resolves no more than they do.
        let limit = 4.0 * crate::scalar::Scalar::sqrt(intervals * (intervals + 1.0));
        let resolved = phase <= limit;
        if !resolved {
            return Err(SchemeError::UnresolvedFrequency { coordinate, phase, limit });
        }
        let z = match frequency {
            Frequency::Trigonometric(_) => phase * phase,
            Frequency::Hyperbolic(_) => -phase * phase,
        };
        let nodes = LobattoNodes::<S>::new();
        let mut matrix = nodes.differentiation();
        let mut start = [0.0; MOST_NODES];
        let mut determinant = 1.0;
        for k in [S - 1, S] {
            let (excess, excess_rate) = (nodes.map(|x| excess(k, z, x)), nodes.map(|x| excess_rate(k, z, x)));
            // The coefficient of xᵏ in the interpolant of values is the scalar product with these.
            let top = |a: usize| nodes.inverse_products[a] * if k == S { 1.0 } else { nodes.offsets[a] };
            let scale = 1.0 + (0..=S).map(|a| top(a) * excess[a]).sum::<f64>();
            determinant *= scale;
            for j in 0..=S {
                let interpolated: f64 = (0..=S).map(|a| nodes.differentiation_entry(j, a) * excess[a]).sum();
                let defect_rate = (excess_rate[j] - interpolated) / scale;
                for a in 0..=S {
                    matrix[j][a] += defect_rate * top(a);
                }
                // Σ top(a) is the coefficient of xᵏ in a constant: 1 for k = 0, else 0.
                if k == 0 {
                    start[j] = defect_rate;
                }
            }
        }
        let well_posed = determinant.abs() >= SMALLEST_DETERMINANT;
        if !well_posed {
            return Err(SchemeError::IndeterminateCurve { coordinate, phase, determinant });
        }
        let table = Self::from_matrix(&matrix, |j| 0.5 * (start[j] - start[S - j]));
        let kinetic_coefficient =
            table.kinetic_determinant(&nodes) / Self::polynomial().kinetic_determinant(&nodes);
        let has_inertia = kinetic_coefficient.abs() >= SMALLEST_DETERMINANT;
        if !has_inertia {
            return Err(SchemeError::VanishingInertia { coordinate, phase, kinetic_coefficient });
        }
        Ok(table)
    }

    /// From the rates per point, which are made antisymmetric under reversal to the last bit, and the rates of constants.
    fn from_matrix(matrix: &[Nodes; MOST_NODES], start: impl Fn(usize) -> f64) -> Self {
        let rates = |node: usize| Rates {
            differences: core::array::from_fn(|a| 0.5 * (matrix[node][a + 1] - matrix[S - node][S - a - 1])),
            start: start(node),
        };
        Self { first: rates(0), others: core::array::from_fn(|j| rates(j + 1)) }
    }

    /// Determinant of `Σ wⱼ Rⱼₐ Rⱼ_b`, `a = 0 .. S−1`, `b = 1 .. S`: what ties the points after the start of a free step to it.
    fn kinetic_determinant(&self, nodes: &LobattoNodes<S>) -> f64 {
        let mut matrix: [[f64; S]; S] = core::array::from_fn(|a| {
            core::array::from_fn(|b| {
                let per_node =
                    |j: usize| nodes.weights[j] * self.rates(j).per_point(a) * self.rates(j).per_point(b + 1);
                (0..=S).map(per_node).sum()
            })
        });
        let mut determinant = 1.0;
        for k in 0..S {
            let pivot_row = (k..S)
                .fold(k, |best, row| if matrix[row][k].abs() > matrix[best][k].abs() { row } else { best });
            if pivot_row != k {
                matrix.swap(k, pivot_row);
                determinant = -determinant;
            }
            let pivot = matrix[k][k];
            determinant *= pivot;
            if pivot == 0.0 {
                return 0.0;
            }
            for row in k + 1..S {
                let factor = matrix[row][k] / pivot;
                for col in k..S {
                    matrix[row][col] -= factor * matrix[k][col];
                }
            }
        }
        determinant
    }
}

/// The rules of `1 ..` intervals: their nodes are roots that are found once.
static RULES: [OnceLock<(Nodes, Nodes)>; MOST_INTERVALS] = [const { OnceLock::new() }; MOST_INTERVALS];

/// The Lobatto rule of `S + 1` nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LobattoNodes<const S: usize> {
    /// Nodes as offsets from the midpoint.
    pub(crate) offsets: Nodes,
    /// Weights; they add up to 1.
    pub(crate) weights: Nodes,
    /// `1 / Π (x_a − x_b)`, `b ≠ a`.
    inverse_products: Nodes,
}

impl<const S: usize> LobattoNodes<S> {
    const HAS_TABLE: () =
        assert!(1 <= S && S <= MOST_INTERVALS, "a Galerkin integrator has 1 to 8 intervals");

    pub(crate) fn new() -> Self {
        let () = Self::HAS_TABLE;
        let (offsets, weights) = *RULES[S - 1].get_or_init(rule::<S>);
        let mut inverse_products = [0.0; MOST_NODES];
        for a in 0..=S {
            let others = (0..=S).filter(|&b| b != a);
            inverse_products[a] = 1.0 / others.map(|b| offsets[a] - offsets[b]).product::<f64>();
        }
        Self { offsets, weights, inverse_products }
    }

    /// Nodes on `[0, 1]`; what is none has no place.
    #[inline]
    pub(crate) fn node(&self, j: usize) -> f64 {
        self.offsets.get(j).map_or(f64::NAN, |offset| 0.5 + offset)
    }

    /// The weight of a node; what is none has no weight.
    #[inline]
    pub(crate) fn weight(&self, j: usize) -> f64 {
        self.weights.get(j).copied().unwrap_or(f64::NAN)
    }

    fn map(&self, function: impl Fn(f64) -> f64) -> Nodes {
        core::array::from_fn(|a| if a <= S { function(self.offsets[a]) } else { 0.0 })
    }

    /// `ℓ_a'(x_j)` of the Lagrange polynomials, in barycentric form (Berrut & Trefethen, SIAM Rev. 46 (2004) 501, eq. 9.4).
    fn differentiation_entry(&self, j: usize, a: usize) -> f64 {
        let off_diagonal = |a: usize| {
            self.inverse_products[a] / self.inverse_products[j] / (self.offsets[j] - self.offsets[a])
        };
        if a == j { -(0..=S).filter(|&b| b != j).map(off_diagonal).sum::<f64>() } else { off_diagonal(a) }
    }

    fn differentiation(&self) -> [Nodes; MOST_NODES] {
        core::array::from_fn(|j| {
            core::array::from_fn(|a| if j <= S && a <= S { self.differentiation_entry(j, a) } else { 0.0 })
        })
    }

    /// `ℓ_a(x)` of the Lagrange polynomials through the nodes `0 .. last`.
    pub(crate) fn lagrange(&self, last: usize, a: usize, x: f64) -> f64 {
        let others = (0..=last).filter(|&b| b != a);
        others.map(|b| (x - self.offsets[b]) / (self.offsets[a] - self.offsets[b])).product()
    }
}

/// Nodes and weights of `S + 1` nodes.
fn rule<const S: usize>() -> (Nodes, Nodes) {
    match S {
        1 => padded(&Quadrature::<2>::lobatto()),
        2 => padded(&Quadrature::<3>::lobatto()),
        3 => padded(&Quadrature::<4>::lobatto()),
        4 => padded(&Quadrature::<5>::lobatto()),
        5 => padded(&Quadrature::<6>::lobatto()),
        6 => padded(&Quadrature::<7>::lobatto()),
        7 => padded(&Quadrature::<8>::lobatto()),
        _ => padded(&Quadrature::<9>::lobatto()),
    }
}

fn padded<const K: usize>(rule: &Quadrature<K>) -> (Nodes, Nodes) {
    let pad = |values: &[f64; K]| core::array::from_fn(|j| if j < K { values[j] } else { 0.0 });
    (pad(rule.offsets()), pad(rule.weights()))
}

/// `f_k(x) − xᵏ = Σ_{j≥1} (−z)ʲ k!/(k+2j)! x^(k+2j)`.
fn excess(k: usize, z: f64, x: f64) -> f64 {
    series(k, z, x, crate::scalar::Scalar::powi(x, k as i32))
}

/// Its derivative, `Σ_{j≥1} (−z)ʲ k!/(k+2j−1)! x^(k+2j−1)`.
fn excess_rate(k: usize, z: f64, x: f64) -> f64 {
    // k f_{k−1}, whose first term is that of xᵏ; for k = 0 the derivative of cos.
    if k == 0 { -z * (x + series(1, z, x, x)) } else { k as f64 * excess(k - 1, z, x) }
}

/// `Σ_{j≥1} (−z x²)ʲ k!/(k+2j)!` times `power`.
fn series(k: usize, z: f64, x: f64, power: f64) -> f64 {
    /// More terms than any phase within the limit needs.
    const TERMS: usize = 80;
    let (mut sum, mut term) = (0.0, power);
    for j in 1..TERMS {
        let degree = (k + 2 * j) as f64;
        term *= -z * x * x / (degree * (degree - 1.0));
        sum += term;
        if term.abs() <= 1e-3 * f64::EPSILON * sum.abs() {
            break;
        }
    }
    sum
}

/// The curves of a Galerkin integrator: polynomials, or mixed ones with a frequency for all coordinates or one for each.
pub trait NodalCurves<System: MechanicalSystem> {
    /// Whether all curves are polynomials.
    const ARE_POLYNOMIALS: bool = false;

    /// The tables of all coordinates.
    type Tables<const S: usize>: NodalTables<S>;

    /// The tables for steps of size `h`.
    ///
    /// # Errors
    /// [`SchemeError`] for frequencies that are not numbers, do not determine a curve, or are blind to the inertia of a
    /// coordinate.
    fn tables<const S: usize>(&self, h: f64) -> Result<Self::Tables<S>, SchemeError>;
}

/// One table per coordinate.
pub trait NodalTables<const S: usize> {
    /// The table of a coordinate.
    fn table(&self, coordinate: usize) -> &NodalTable<S>;
}

impl<const S: usize> NodalTables<S> for NodalTable<S> {
    #[inline]
    fn table(&self, _coordinate: usize) -> &NodalTable<S> {
        self
    }
}

impl<const S: usize, const N: usize> NodalTables<S> for [NodalTable<S>; N] {
    #[inline]
    fn table(&self, coordinate: usize) -> &NodalTable<S> {
        &self[coordinate]
    }
}

/// Polynomials; the straight line for one interval.
impl<System: MechanicalSystem> NodalCurves<System> for Linear {
    const ARE_POLYNOMIALS: bool = true;

    type Tables<const S: usize> = NodalTable<S>;

    fn tables<const S: usize>(&self, _h: f64) -> Result<NodalTable<S>, SchemeError> {
        Ok(NodalTable::polynomial())
    }
}

impl<System: MechanicalSystem> NodalCurves<System> for Frequency {
    type Tables<const S: usize> = NodalTable<S>;

    fn tables<const S: usize>(&self, h: f64) -> Result<NodalTable<S>, SchemeError> {
        NodalTable::mixed(*self, 0, h)
    }
}

impl<System, const N: usize> NodalCurves<System> for [Frequency; N]
where
    System: MechanicalSystem<PerCoordinate<Frequency> = [Frequency; N]>,
{
    type Tables<const S: usize> = [NodalTable<S>; N];

    fn tables<const S: usize>(&self, h: f64) -> Result<[NodalTable<S>; N], SchemeError> {
        let mut tables = [NodalTable::polynomial(); N];
        for (coordinate, table) in tables.iter_mut().enumerate() {
            *table = NodalTable::mixed(self[coordinate], coordinate, h)?;
        }
        Ok(tables)
    }
}
