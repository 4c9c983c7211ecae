//! Trigonometrically fitted weights: the oscillator of the interpolant's own frequency, integrated exactly.

use super::{Frequency, Interpolant, Quadrature, SchemeError, UniformTable, entire};
use crate::system::MechanicalSystem;

/// One frequency for all coordinates, and weights that fit it.
///
/// On nodes `−σ, 0, σ` around the middle of a step the weights solve
///
/// ```text
/// Σ wⱼ = 1        Σ wⱼ cos 2uσⱼ = sin u / u        u = ω h
/// ```
///
/// so that the action of a step is that of `L = ½ v² − ½ ω² q²` without error: the scheme reproduces this oscillator to round-off
/// in position, momentum and energy. `w = (1 − sin u/u) / (4 sin² uσ)` at either end, Simpson's `1/6` as `u → 0`. For anything else they
/// are weights of order 2 like others. Made by [`Evi::fitted`](crate::integrator::Evi::fitted).
///
/// There is one set of weights, hence one frequency. Weights of its own for every coordinate would be no quadrature of `L`, unless
/// `L` is a sum over the coordinates; what is quadratic in several coordinates with several frequencies is integrated exactly by
/// [`Evi::stiffness`](crate::integrator::Evi::stiffness).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitted {
    pub(crate) frequency: Frequency,
}

impl<S: MechanicalSystem> Interpolant<S> for Fitted {
    type Table<const K: usize> = UniformTable<K>;

    fn rule<const K: usize>(
        &self,
        _constants: &S::PerConstant<f64>,
        quadrature: &Quadrature<K>,
        h: f64,
    ) -> Result<Quadrature<K>, SchemeError> {
        quadrature.fitted_to(self.frequency, h)
    }

    fn table<const K: usize>(
        &self,
        constants: &S::PerConstant<f64>,
        quadrature: &Quadrature<K>,
        h: f64,
    ) -> Result<UniformTable<K>, SchemeError> {
        Interpolant::<S>::table(&self.frequency, constants, quadrature, h)
    }

    fn frequency(&self, _constants: &S::PerConstant<f64>, _coordinate: usize) -> Frequency {
        self.frequency
    }
}

impl<const K: usize> Quadrature<K> {
    /// The rule on the same three nodes that is exact for `1`, `cos 2u(τ − ½)` and `sin 2u(τ − ½)`, `u = ω h`; for `cosh` and
    /// `sinh` of a hyperbolic frequency.
    ///
    /// # Errors
    /// [`SchemeError::UnsupportedStructure`] unless there are three nodes, of which the outer ones mirror each other.
    pub fn fitted_to(&self, frequency: Frequency, h: f64) -> Result<Self, SchemeError> {
        if !(K == 3 && self.is_symmetric()) {
            let (scheme, requirement) = ("a fitted rule", "three nodes that mirror each other");
            return Err(SchemeError::UnsupportedStructure { scheme, requirement });
        }
        let (outer, z) = (self.offsets()[0], entire::squared_phase(frequency, h));
        let half_chord = outer * entire::sinc(z * outer * outer);
        let weight = 0.25 * entire::sinc_defect(z) / (half_chord * half_chord);
        Ok(self.with_weights(core::array::from_fn(|j| if j == 1 { 1.0 - 2.0 * weight } else { weight })))
    }
}
