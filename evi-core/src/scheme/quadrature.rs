//! Interpolatory quadrature rules on `[0, 1]`.
//!
//! In: the number of nodes, or the nodes. Out: nodes `cⱼ` and weights `wⱼ` with `Σ wⱼ cⱼᵏ = 1/(k+1)`,
//! `k = 0 .. S−1`. Nodes are kept as offsets from the midpoint, `σⱼ = cⱼ − ½`, and mirror-symmetric rules are
//! mirror-symmetric to the last bit, so that the steps built on them are time-symmetric to round-off.

use core::f64::consts::PI;

use crate::scalar::Scalar;

/// A quadrature rule with `S` nodes on `[0, 1]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadrature<const S: usize> {
    offsets: [f64; S],
    weights: [f64; S],
}

/// Nodes that define no quadrature rule.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum QuadratureError {
    /// A node is not a number in `[0, 1]`.
    #[error("node {index} must lie in [0, 1], got {node:?}")]
    OutsideUnitInterval {
        /// Index of the node.
        index: usize,
        /// The node.
        node: f64,
    },
    /// Two nodes coincide.
    #[error("nodes {first} and {second} coincide at {node:?}")]
    CoincidingNodes {
        /// Index of one node.
        first: usize,
        /// Index of the other node.
        second: usize,
        /// The node.
        node: f64,
    },
}

impl Quadrature<1> {
    /// The midpoint rule.
    pub const fn midpoint() -> Self {
        Self { offsets: [0.0], weights: [1.0] }
    }
}

impl<const S: usize> Quadrature<S> {
    const HAS_NODES: () = assert!(S > 0, "a quadrature rule needs at least one node");

    /// Equally spaced nodes from 0 to 1 (closed Newton-Cotes): the midpoint for `S = 1`, then trapezoid,
    /// Simpson, ... From `S = 9` on some weights are negative; prefer [`lobatto`](Self::lobatto) there.
    pub fn uniform() -> Self {
        let intervals = (S.max(2) - 1) as f64;
        Self::with_symmetric_offsets(|j| if S == 1 { 0.0 } else { j as f64 / intervals - 0.5 })
    }

    /// Gauss-Legendre nodes: exact for polynomials of degree `2S − 1`.
    pub fn gauss() -> Self {
        Self::with_symmetric_offsets(|j| 0.5 * gauss_root(S, j))
    }

    /// Gauss-Lobatto nodes, which contain 0 and 1: exact for degree `2S − 3`; the midpoint for `S = 1`.
    pub fn lobatto() -> Self {
        Self::with_symmetric_offsets(|j| match j {
            _ if S == 1 => 0.0,
            0 => -0.5,
            _ if j == S - 1 => 0.5,
            _ => 0.5 * lobatto_root(S - 1, j),
        })
    }

    /// The rule on the given nodes. Nodes that mirror each other up to rounding are made to do so exactly.
    ///
    /// # Errors
    /// [`QuadratureError`] for nodes outside `[0, 1]` or nodes that coincide.
    pub fn interpolatory(nodes: [f64; S]) -> Result<Self, QuadratureError> {
        for (index, &node) in nodes.iter().enumerate() {
            if !(0.0..=1.0).contains(&node) {
                return Err(QuadratureError::OutsideUnitInterval { index, node });
            }
            // Equality of bits: nodes that differ at all define weights, however large.
            if let Some(first) = nodes[..index].iter().position(|&earlier| earlier == node) {
                return Err(QuadratureError::CoincidingNodes { first, second: index, node });
            }
        }
        let offsets = nodes.map(|node| node - 0.5);
        // Decimal nodes such as 0.2 and 0.8 mirror each other only up to their rounding.
        let mirrored = (0..S).all(|j| (offsets[j] + offsets[S - 1 - j]).abs() <= 0.5 * f64::EPSILON);
        Ok(if mirrored { Self::with_symmetric_offsets(|j| offsets[j]) } else { Self::with_offsets(offsets) })
    }

    /// Nodes as offsets from the midpoint, `σⱼ = cⱼ − ½`, in `[−½, ½]`.
    pub const fn offsets(&self) -> &[f64; S] {
        &self.offsets
    }

    /// Nodes `cⱼ` in `[0, 1]`.
    pub fn nodes(&self) -> [f64; S] {
        self.offsets.map(|offset| 0.5 + offset)
    }

    /// Weights `wⱼ`.
    pub const fn weights(&self) -> &[f64; S] {
        &self.weights
    }

    /// Whether the rule is its own mirror image, so that a step built on it is time-symmetric.
    pub fn is_symmetric(&self) -> bool {
        // Equality of bits, which `with_offsets` establishes.
        (0..S).all(|j| {
            self.offsets[j] == -self.offsets[S - 1 - j] && self.weights[j] == self.weights[S - 1 - j]
        })
    }

    /// Whether the one node is in the middle of a step.
    pub(crate) fn is_midpoint(&self) -> bool {
        // Equality of bits, as below.
        self.offsets.as_slice() == [0.0] && self.weights.as_slice() == [1.0]
    }

    /// Whether the nodes are the ends of a step. Their weights are then ½ each, up to rounding.
    pub(crate) fn is_trapezoid(&self) -> bool {
        // Equality of bits: other nodes are another rule, however near.
        self.offsets.as_slice() == [-0.5, 0.5]
    }

    /// `Σ wⱼ σⱼ²`: 1/12 for every rule of degree 2, 1/4 for the trapezoid, 0 for the midpoint.
    pub fn second_moment(&self) -> f64 {
        self.weights.iter().zip(&self.offsets).map(|(weight, offset)| weight * offset * offset).sum()
    }

    /// The same nodes with other weights.
    pub(crate) const fn with_weights(&self, weights: [f64; S]) -> Self {
        Self { offsets: self.offsets, weights }
    }

    /// Mirrors the left half of the offsets, so that symmetry holds bitwise.
    fn with_symmetric_offsets(offset: impl Fn(usize) -> f64) -> Self {
        Self::with_offsets(core::array::from_fn(|j| match (2 * j + 1).cmp(&S) {
            core::cmp::Ordering::Less => offset(j),
            core::cmp::Ordering::Equal => 0.0,
            core::cmp::Ordering::Greater => -offset(S - 1 - j),
        }))
    }

    fn with_offsets(offsets: [f64; S]) -> Self {
        let () = Self::HAS_NODES;
        let computed = interpolatory_weights(&offsets);
        let symmetric = (0..S).all(|j| offsets[j] == -offsets[S - 1 - j]);
        let mirrored = core::array::from_fn(|j| 0.5 * (computed[j] + computed[S - 1 - j]));
        Self { offsets, weights: if symmetric { mirrored } else { computed } }
    }
}

/// `wⱼ = ∫₀¹ ℓⱼ` for the Lagrange polynomials `ℓⱼ` of the nodes, by the Gauss rule with as many nodes.
///
/// Solving the Vandermonde system for the same weights loses a digit per node.
fn interpolatory_weights<const S: usize>(offsets: &[f64; S]) -> [f64; S] {
    let mut weights = [0.0; S];
    for k in 0..S {
        let root = gauss_root(S, k);
        let (_, slope) = legendre(S, root);
        let gauss_weight = 1.0 / ((1.0 - root * root) * slope * slope);
        for j in 0..S {
            let lagrange: f64 = (0..S)
                .filter(|&i| i != j)
                .map(|i| (0.5 * root - offsets[i]) / (offsets[j] - offsets[i]))
                .product();
            weights[j] += gauss_weight * lagrange;
        }
    }
    weights
}

/// Root `j` of the Legendre polynomial `P_n`, ascending (first guess: Abramowitz & Stegun 22.16.6).
fn gauss_root(n: usize, j: usize) -> f64 {
    let guess = -Scalar::cos(PI * (j as f64 + 0.75) / (n as f64 + 0.5));
    newton_root(guess, |x| legendre(n, x))
}

/// Root `j` of `(1 − x²) P'_n`, ascending, for `0 < j < n` (first guess: the extrema of a Chebyshev polynomial).
fn lobatto_root(n: usize, j: usize) -> f64 {
    let guess = -Scalar::cos(PI * j as f64 / n as f64);
    newton_root(guess, |x| {
        let (value, slope) = legendre(n, x);
        // Legendre's differential equation, (1 − x²) P'' = 2 x P' − n (n + 1) P.
        (slope, (2.0 * x * slope - (n * (n + 1)) as f64 * value) / (1.0 - x * x))
    })
}

/// The Legendre polynomial `P_n(x)` and its derivative for `|x| < 1` (Abramowitz & Stegun 8.5.3, 8.5.4).
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut value) = (0.0, 1.0);
    for k in 0..n {
        let k = k as f64;
        (previous, value) = (value, ((2.0 * k + 1.0) * x * value - k * previous) / (k + 1.0));
    }
    (value, n as f64 * (x * value - previous) / (x * x - 1.0))
}

/// A simple root near `guess` of a function given with its derivative.
fn newton_root(guess: f64, function: impl Fn(f64) -> (f64, f64)) -> f64 {
    /// Both first guesses above are good to 1/n², from where Newton needs four steps.
    const ITERATIONS: usize = 10;
    let mut root = guess;
    for _ in 0..ITERATIONS {
        let (value, slope) = function(root);
        root -= value / slope;
    }
    root
}
