//! Curves of an [`Evi`] beyond one frequency per coordinate: fitted weights, a reference, and what is refused.

use super::Evi;
use crate::scheme::{About, Fitted, Frequency, Interpolant, Quadrature, SchemeError, growth_rate};
use crate::system::MechanicalSystem;

impl Evi<3, Frequency> {
    /// Weights fitted to the frequency, in the place of those of the rule: an oscillator of this frequency is reproduced to
    /// round-off in position, momentum and energy. See [`Fitted`].
    ///
    /// ```
    /// use evi_core::prelude::*;
    /// let scheme = Evi::simpson(0.5).frequency(2.0).fitted();
    /// # let _ = scheme;
    /// ```
    pub fn fitted(self) -> Evi<3, Fitted> {
        let frequency = self.interpolant;
        self.on(Fitted { frequency })
    }
}

impl<const K: usize> Evi<K, Frequency> {
    /// Interpolates `q − reference` in the place of `q`; see [`About`].
    ///
    /// ```
    /// use evi_core::prelude::*;
    /// let scheme = Evi::simpson(0.01).frequency(3.13).about([0.0, -1.0, 0.0, -2.0]);
    /// # let _ = scheme;
    /// ```
    pub fn about<const N: usize>(self, reference: [f64; N]) -> Evi<K, About<Frequency, N>> {
        self.referred_to(reference)
    }
}

impl<const K: usize, const N: usize> Evi<K, [Frequency; N]> {
    /// Interpolates `q − reference` in the place of `q`; see [`About`].
    pub fn about(self, reference: [f64; N]) -> Evi<K, About<[Frequency; N], N>> {
        self.referred_to(reference)
    }
}

impl Evi<3, Fitted> {
    /// Interpolates `q − reference` in the place of `q`; see [`About`].
    pub fn about<const N: usize>(self, reference: [f64; N]) -> Evi<3, About<Fitted, N>> {
        self.referred_to(reference)
    }
}

impl<const K: usize, F> Evi<K, F> {
    /// Takes a frequency also for coordinates that nothing holds, whose motions then grow ([`growth_rate`] tells how fast): to
    /// study that growth.
    pub fn allow_soft_modes(self) -> Self {
        Self { allows_soft_modes: true, ..self }
    }

    /// The same nodes and step size with other curves.
    pub(super) fn on<G>(self, interpolant: G) -> Evi<K, G> {
        let Self { quadrature, h, allows_soft_modes, .. } = self;
        Evi { quadrature, h, interpolant, allows_soft_modes }
    }

    fn referred_to<const N: usize>(self, reference: [f64; N]) -> Evi<K, About<F, N>> {
        let Self { quadrature, h, interpolant, allows_soft_modes } = self;
        Evi { quadrature, h, interpolant: About { interpolant, reference }, allows_soft_modes }
    }
}

/// Refuses a frequency of a coordinate that neither `L` nor a constraint depends on, where the rule makes it grow.
pub(super) fn check_soft_coordinates<S: MechanicalSystem, const K: usize>(
    interpolant: &impl Interpolant<S>,
    constants: &S::PerConstant<f64>,
    rule: &Quadrature<K>,
    h: f64,
) -> Result<(), SchemeError> {
    for coordinate in 0..S::N_COORDINATES {
        let frequency = interpolant.frequency(constants, coordinate);
        // The frequency itself is judged with the table.
        if S::STRUCTURE.is_free(coordinate) && frequency.value() != 0.0 {
            let growth_rate = growth_rate(frequency, rule, h, 0.0);
            if growth_rate > 0.0 {
                let (coordinate, frequency) = (S::COORDINATES[coordinate], frequency.value());
                return Err(SchemeError::SoftCoordinate { coordinate, frequency, growth_rate });
            }
        }
    }
    Ok(())
}
