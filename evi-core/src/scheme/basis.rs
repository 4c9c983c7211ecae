//! The interpolating curve between two configurations, at the nodes of a quadrature rule.
//!
//! With `s = (q₀ + q₁)/2`, `d = q₁ − q₀`, `σ = τ − ½` and `u = ω h`,
//!
//! ```text
//! x(τ)   = cos uσ / cos ½u · s  +  ½ sin uσ / sin ½u · d
//! h v(τ) = −u sin uσ / cos ½u · s  +  ½u cos uσ / sin ½u · d
//! ```
//!
//! which equals `g₁(τ) q₀ + g₂(τ) q₁` with `g₁ = sin(u(1−τ))/sin u`, `g₂ = sin(uτ)/sin u`, but has no cancellation of
//! two terms of size `q/h`, splits even from odd functions of σ, and goes over into the straight line as `u → 0`.
//! The hyperbolic curve is its continuation to imaginary `u`.

use crate::array::Array;
use crate::scalar::Scalar;
use crate::scheme::{Frequency, Quadrature, SchemeError};
use crate::system::MechanicalSystem;

/// Below this |sin u| an interpolant amplifies round-off of its end points a thousandfold: refused as resonant.
pub(super) const SMALLEST_SINE: f64 = 1e-3;
/// Below this kinetic coefficient (1 at u = 0) the step equation loses three digits of the end point: refused.
const SMALLEST_KINETIC_COEFFICIENT: f64 = 1e-3;
/// Below this |u| the curve is straight to the last bit: its deviation is u²/8.
const STRAIGHT: f64 = 1e-9;

/// How one coordinate depends on the two ends of a step, at one node.
///
/// `x = even · s + odd · d` and `h v = even_rate · s + odd_rate · d`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeCoefficients {
    /// Position per half-sum.
    pub even: f64,
    /// Position per difference.
    pub odd: f64,
    /// Velocity times `h` per half-sum.
    pub even_rate: f64,
    /// Velocity times `h` per difference.
    pub odd_rate: f64,
}

impl NodeCoefficients {
    /// The coefficients at `offset = τ − ½` for the phase `u = ω h` (or rate times `h`).
    ///
    /// ```
    /// use evi_core::scheme::{Frequency, NodeCoefficients};
    /// let end = NodeCoefficients::new(Frequency::from(0.3), 1.0, 0.5);
    /// assert!((end.even - 1.0).abs() < 1e-15 && (end.odd - 0.5).abs() < 1e-15);
    /// ```
    pub fn new(frequency: Frequency, h: f64, offset: f64) -> Self {
        let phase = (frequency.value() * h).abs();
        if phase < STRAIGHT {
            return Self::straight(offset);
        }
        // Computed for σ ≥ 0 and mirrored, so that the discrete Lagrangian is symmetric to the last bit.
        let distance = offset.abs();
        let right = match frequency {
            Frequency::Trigonometric(_) => Self::trigonometric(phase, distance),
            Frequency::Hyperbolic(_) => Self::hyperbolic(phase, distance),
        };
        let sign = if offset < 0.0 { -1.0 } else { 1.0 };
        Self { odd: sign * right.odd, even_rate: sign * right.even_rate, ..right }
    }

    /// The coefficients of the straight line.
    pub const fn straight(offset: f64) -> Self {
        Self { even: 1.0, odd: offset, even_rate: 0.0, odd_rate: 1.0 }
    }

    fn trigonometric(u: f64, distance: f64) -> Self {
        let (sine, cosine) = Scalar::sin_cos(u * distance);
        let (half_sine, half_cosine) = Scalar::sin_cos(0.5 * u);
        Self {
            even: cosine / half_cosine,
            odd: 0.5 * sine / half_sine,
            even_rate: -u * sine / half_cosine,
            odd_rate: 0.5 * u * cosine / half_sine,
        }
    }

    /// The ratios of hyperbolic functions with the growing exponential divided out: no overflow at any `u`.
    fn hyperbolic(u: f64, distance: f64) -> Self {
        let decay = Scalar::exp(u * (distance - 0.5));
        let (cosine, sine) = (1.0 + Scalar::exp(-2.0 * u * distance), -libm::expm1(-2.0 * u * distance));
        let (half_cosine, half_sine) = (1.0 + Scalar::exp(-u), -libm::expm1(-u));
        Self {
            even: decay * cosine / half_cosine,
            odd: 0.5 * decay * sine / half_sine,
            even_rate: u * decay * sine / half_cosine,
            odd_rate: 0.5 * u * decay * cosine / half_sine,
        }
    }

    /// `g₁`: position per start of the step.
    #[inline]
    pub fn start(&self) -> f64 {
        0.5 * self.even - self.odd
    }

    /// `g₂`: position per end of the step.
    #[inline]
    pub fn end(&self) -> f64 {
        0.5 * self.even + self.odd
    }

    /// `h g₁'`: velocity times `h` per start of the step.
    #[inline]
    pub fn start_rate(&self) -> f64 {
        0.5 * self.even_rate - self.odd_rate
    }

    /// `h g₂'`: velocity times `h` per end of the step.
    #[inline]
    pub fn end_rate(&self) -> f64 {
        0.5 * self.even_rate + self.odd_rate
    }
}

/// The interpolant's coefficients at every node of a rule, in the storage that the interpolant needs.
pub trait InterpolationTable {
    /// Whether the curves are straight lines, known at compile time.
    const IS_STRAIGHT: bool = false;

    /// The coefficients at a node for a coordinate.
    fn coefficients(&self, node: usize, coordinate: usize) -> NodeCoefficients;

    /// `(x, h v)` at a node from the start `q` of a step and the difference `d` of its ends.
    #[inline]
    fn evaluate(&self, node: usize, coordinate: usize, q: f64, d: f64) -> (f64, f64) {
        let c = self.coefficients(node, coordinate);
        let s = q + 0.5 * d;
        (c.even * s + c.odd * d, c.even_rate * s + c.odd_rate * d)
    }
}

/// A family of curves between two configurations, one frequency per coordinate.
pub trait Interpolant<S: MechanicalSystem> {
    /// Whether the curves are straight lines, known at compile time.
    const IS_STRAIGHT: bool = false;
    /// Whether the curves depend on parameters of the scene, so that a step is a function of these through its tables, too.
    const FOLLOWS_PARAMETERS: bool = false;

    /// The coefficients at `K` nodes.
    type Table<const K: usize>: InterpolationTable;

    /// The frequency of a coordinate's curve, in a scene with these constants.
    fn frequency(&self, constants: &S::PerConstant<f64>, coordinate: usize) -> Frequency;

    /// The rule that this family uses in the place of `quadrature`: the same nodes, weights of its own where it has such.
    ///
    /// # Errors
    /// [`SchemeError`] for nodes that the family has no weights for.
    fn rule<const K: usize>(
        &self,
        _constants: &S::PerConstant<f64>,
        quadrature: &Quadrature<K>,
        _h: f64,
    ) -> Result<Quadrature<K>, SchemeError> {
        Ok(*quadrature)
    }

    /// The coefficients at the nodes of `quadrature` for steps of size `h` of a scene with these constants.
    ///
    /// # Errors
    /// [`SchemeError`] for frequencies that are not numbers, resonant, or blind to the inertia of a coordinate.
    fn table<const K: usize>(
        &self,
        constants: &S::PerConstant<f64>,
        quadrature: &Quadrature<K>,
        h: f64,
    ) -> Result<Self::Table<K>, SchemeError>;
}

/// Straight lines: `u = 0` for every coordinate, the classical variational integrators.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear;

impl<S: MechanicalSystem> Interpolant<S> for Linear {
    const IS_STRAIGHT: bool = true;

    type Table<const K: usize> = LinearTable<K>;

    fn table<const K: usize>(
        &self,
        _constants: &S::PerConstant<f64>,
        quadrature: &Quadrature<K>,
        _h: f64,
    ) -> Result<LinearTable<K>, SchemeError> {
        Ok(LinearTable { offsets: *quadrature.offsets() })
    }

    fn frequency(&self, _constants: &S::PerConstant<f64>, _coordinate: usize) -> Frequency {
        Frequency::ZERO
    }
}

/// Straight lines at `K` nodes.
pub struct LinearTable<const K: usize> {
    offsets: [f64; K],
}

impl<const K: usize> InterpolationTable for LinearTable<K> {
    const IS_STRAIGHT: bool = true;

    #[inline]
    fn coefficients(&self, node: usize, _coordinate: usize) -> NodeCoefficients {
        NodeCoefficients::straight(self.offsets[node])
    }

    #[inline]
    fn evaluate(&self, node: usize, _coordinate: usize, q: f64, d: f64) -> (f64, f64) {
        (q + (0.5 + self.offsets[node]) * d, d)
    }
}

/// One frequency for all coordinates.
impl<S: MechanicalSystem> Interpolant<S> for Frequency {
    type Table<const K: usize> = UniformTable<K>;

    fn table<const K: usize>(
        &self,
        _constants: &S::PerConstant<f64>,
        quadrature: &Quadrature<K>,
        h: f64,
    ) -> Result<UniformTable<K>, SchemeError> {
        Ok(UniformTable { nodes: checked_coefficients(*self, 0, quadrature, h)? })
    }

    fn frequency(&self, _constants: &S::PerConstant<f64>, _coordinate: usize) -> Frequency {
        *self
    }
}

/// The same curve for all coordinates at `K` nodes.
pub struct UniformTable<const K: usize> {
    nodes: [NodeCoefficients; K],
}

impl<const K: usize> InterpolationTable for UniformTable<K> {
    #[inline]
    fn coefficients(&self, node: usize, _coordinate: usize) -> NodeCoefficients {
        self.nodes[node]
    }
}

/// One frequency per coordinate, in the order of the scene's coordinates. Coordinates of one body should share
/// theirs: then rotations of the body about the origin remain a symmetry of the step.
impl<S, const N: usize> Interpolant<S> for [Frequency; N]
where
    S: MechanicalSystem<PerCoordinate<Frequency> = [Frequency; N]>,
{
    type Table<const K: usize> = CoordinateTable<N, K>;

    fn table<const K: usize>(
        &self,
        _constants: &S::PerConstant<f64>,
        quadrature: &Quadrature<K>,
        h: f64,
    ) -> Result<CoordinateTable<N, K>, SchemeError> {
        let mut coordinates = [[NodeCoefficients::straight(0.0); K]; N];
        for i in 0..N {
            coordinates[i] = checked_coefficients(self[i], i, quadrature, h)?;
        }
        Ok(CoordinateTable { coordinates })
    }

    fn frequency(&self, _constants: &S::PerConstant<f64>, coordinate: usize) -> Frequency {
        self[coordinate]
    }
}

/// One curve per coordinate at `K` nodes.
pub struct CoordinateTable<const N: usize, const K: usize> {
    coordinates: [[NodeCoefficients; K]; N],
}

impl<const N: usize, const K: usize> InterpolationTable for CoordinateTable<N, K> {
    #[inline]
    fn coefficients(&self, node: usize, coordinate: usize) -> NodeCoefficients {
        self.coordinates[coordinate][node]
    }
}

/// The coefficients of one coordinate at every node, where they define a step.
pub(crate) fn checked_coefficients<const K: usize>(
    frequency: Frequency,
    coordinate: usize,
    quadrature: &Quadrature<K>,
    h: f64,
) -> Result<[NodeCoefficients; K], SchemeError> {
    let nodes = quadrature.offsets().map(|offset| NodeCoefficients::new(frequency, h, offset));
    check_interpolant(frequency, coordinate, h, quadrature.weights(), &nodes)?;
    Ok(nodes)
}

/// Refuses an interpolant that defines no step, from its coefficients at the nodes of a rule with `weights`.
pub(crate) fn check_interpolant(
    frequency: Frequency,
    coordinate: usize,
    h: f64,
    weights: &[f64],
    nodes: &[NodeCoefficients],
) -> Result<(), SchemeError> {
    let value = frequency.value();
    if !(value.is_finite() && value >= 0.0) {
        return Err(SchemeError::Frequency { coordinate, value });
    }
    let phase = (value * h).abs();
    let sine = Scalar::sin(phase);
    let is_trigonometric = matches!(frequency, Frequency::Trigonometric(_));
    // sin u is also small at u → 0, where the interpolant is the straight line.
    if is_trigonometric && phase > 1.0 && sine.abs() < SMALLEST_SINE {
        return Err(SchemeError::ResonantFrequency { coordinate, phase, sine });
    }
    let kinetic_coefficient = kinetic_coefficient(weights, nodes);
    if kinetic_coefficient.abs() < SMALLEST_KINETIC_COEFFICIENT {
        return Err(SchemeError::VanishingInertia { coordinate, phase, kinetic_coefficient });
    }
    Ok(())
}

/// `Σ wⱼ (−h g₁'(cⱼ)) (h g₂'(cⱼ))`: the share of the mass that ties the end of a free step to its start.
///
/// It vanishes at `u = π/2` for the trapezoid, `2π/3` for Simpson's rule, and only at `π` for the midpoint.
fn kinetic_coefficient(weights: &[f64], nodes: &[NodeCoefficients]) -> f64 {
    weights.iter().zip(nodes).map(|(weight, c)| -weight * c.start_rate() * c.end_rate()).sum()
}

/// Interpolates a whole configuration: `x` and `v` at `node` from the start of a step and the difference of its ends.
#[inline]
pub(crate) fn interpolate<S: MechanicalSystem>(
    table: &impl InterpolationTable,
    node: usize,
    start: &S::PerCoordinate<f64>,
    difference: &S::PerCoordinate<f64>,
    inverse_h: f64,
) -> (S::PerCoordinate<f64>, S::PerCoordinate<f64>) {
    let mut v = S::PerCoordinate::<f64>::from_fn(|_| 0.0);
    let x = S::PerCoordinate::<f64>::from_fn(|i| {
        let (position, rate) = table.evaluate(node, i, start[i], difference[i]);
        v[i] = rate * inverse_h;
        position
    });
    (x, v)
}
