//! The frequency of an interpolating curve.

/// Frequency of the two functions that a coordinate is interpolated with; constant over a run.
///
/// It should be that of an oscillation about 0, with `ω h` well below π/2: what does not oscillate so is better interpolated
/// on a straight line ([`ZERO`](Frequency::ZERO)), and is unstable with a large frequency and several nodes.
///
/// A frequency that follows the state would make the step non-symplectic, hence there is no such variant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Frequency {
    /// `cos ωt, sin ωt` with the angular frequency ω ≥ 0 in radians per unit of time; linear at ω = 0.
    Trigonometric(f64),
    /// `cosh rt, sinh rt` with the rate r ≥ 0 per unit of time; linear at r = 0.
    Hyperbolic(f64),
}

impl Frequency {
    /// The linear interpolant.
    pub const ZERO: Self = Self::Trigonometric(0.0);

    /// The angular frequency or rate.
    pub const fn value(self) -> f64 {
        match self {
            Self::Trigonometric(value) | Self::Hyperbolic(value) => value,
        }
    }
}

impl From<f64> for Frequency {
    /// A trigonometric frequency.
    fn from(omega: f64) -> Self {
        Self::Trigonometric(omega)
    }
}
