//! Curves of a frequency about a reference configuration other than 0.

use super::{Frequency, Interpolant, InterpolationTable, NodeCoefficients, Quadrature, SchemeError};
use crate::system::MechanicalSystem;

/// Interpolates `q − q_ref` in the place of `q`: `x = q_ref + g₁ (q₀ − q_ref) + g₂ (q₁ − q_ref)`.
///
/// A scene at rest at `q_ref` stays there, and an oscillation about `q_ref` is followed as one about 0 is without it. Made by
/// [`Evi::about`](crate::integrator::Evi::about).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct About<F, const N: usize> {
    pub(crate) interpolant: F,
    pub(crate) reference: [f64; N],
}

impl<S, F, const N: usize> Interpolant<S> for About<F, N>
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Interpolant<S>,
{
    const FOLLOWS_PARAMETERS: bool = F::FOLLOWS_PARAMETERS;

    type Table<const K: usize> = AboutTable<F::Table<K>, N>;

    fn frequency(&self, constants: &S::PerConstant<f64>, coordinate: usize) -> Frequency {
        self.interpolant.frequency(constants, coordinate)
    }

    fn rule<const K: usize>(
        &self,
        constants: &S::PerConstant<f64>,
        quadrature: &Quadrature<K>,
        h: f64,
    ) -> Result<Quadrature<K>, SchemeError> {
        self.interpolant.rule(constants, quadrature, h)
    }

    fn table<const K: usize>(
        &self,
        constants: &S::PerConstant<f64>,
        quadrature: &Quadrature<K>,
        h: f64,
    ) -> Result<AboutTable<F::Table<K>, N>, SchemeError> {
        if let Some(coordinate) = self.reference.iter().position(|value| !value.is_finite()) {
            return Err(SchemeError::Reference { coordinate, value: self.reference[coordinate] });
        }
        Ok(AboutTable { table: self.interpolant.table(constants, quadrature, h)?, reference: self.reference })
    }
}

/// The coefficients of curves about a reference configuration.
pub struct AboutTable<T, const N: usize> {
    table: T,
    reference: [f64; N],
}

impl<T: InterpolationTable, const N: usize> InterpolationTable for AboutTable<T, N> {
    const IS_STRAIGHT: bool = T::IS_STRAIGHT;

    #[inline]
    fn coefficients(&self, node: usize, coordinate: usize) -> NodeCoefficients {
        self.table.coefficients(node, coordinate)
    }

    #[inline]
    fn evaluate(&self, node: usize, coordinate: usize, q: f64, d: f64) -> (f64, f64) {
        let reference = self.reference[coordinate];
        let (x, rate) = self.table.evaluate(node, coordinate, q - reference, d);
        (reference + x, rate)
    }
}
