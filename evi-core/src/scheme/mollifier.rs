//! Averages of the fast motion, in which a mollified impulse method evaluates its slow potential.

use super::entire::sinc;

/// The filter `φ(hW)` through which a scheme sees what is left of the potential: `U(φ(hW) q)` in the place of `U(q)`, with the force
/// `φ(hW)ᵀ U'(φ(hW) q)`.
///
/// Each averages the motion of the quadratic part over a window of time around the node, and damps the forces on fast modes, from
/// which the resonances of the impulse method come (García-Archilla, Sanz-Serna, Skeel, SIAM J. Sci. Comput. 20 (1998) 930; Hairer,
/// Lubich, Wanner, Geometric Numerical Integration, sec. XIII.1). Slow modes are changed by `O(h²)`: the order stays 2.
///
/// The filter of a variational scheme acts on positions, and the force gets its transpose, so that `ψ = sinc · φ` (ibid., sec.
/// XIII.2.2). Gautschi's methods, `ψ = sinc²(·/2)` with another `φ`, break this condition: they are not symplectic, no action
/// generates them, and they are not offered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mollifier {
    /// `φ = sinc ½ξ`: the mean over one step.
    ShortAverage,
    /// `φ = sinc ξ`: the mean over two steps, which vanishes at the resonances of the impulse method.
    LongAverage,
    /// `φ = sinc² ½ξ`: the mean over two steps with weights that fall linearly to their ends.
    LinearAverage,
}

impl Mollifier {
    /// `φ` of a mode with `z = ξ² = κ h²`; hyperbolic functions for `z < 0`.
    pub(crate) fn filter(self, z: f64) -> f64 {
        match self {
            Self::ShortAverage => sinc(0.25 * z),
            Self::LongAverage => sinc(z),
            Self::LinearAverage => {
                let mean = sinc(0.25 * z);
                mean * mean
            }
        }
    }
}
