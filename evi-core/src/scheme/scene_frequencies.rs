//! The frequencies that a scene gives its coordinates.

use super::basis::checked_coefficients;
use super::{Frequency, Interpolant, InterpolationTable, NodeCoefficients, Quadrature, SchemeError};
use crate::array::Array;
use crate::system::HasFrequencies;

/// One frequency per coordinate, from the scene's items `frequency(..)`: constant over a run, since it depends on parameters
/// alone; straight lines for coordinates without one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneFrequencies;

impl<S: HasFrequencies> Interpolant<S> for SceneFrequencies {
    const FOLLOWS_PARAMETERS: bool = true;

    type Table<const K: usize> = SceneTable<S, K>;

    fn frequency(&self, constants: &S::PerConstant<f64>, coordinate: usize) -> Frequency {
        Frequency::from(S::frequencies(constants)[coordinate])
    }

    fn table<const K: usize>(
        &self,
        constants: &S::PerConstant<f64>,
        quadrature: &Quadrature<K>,
        h: f64,
    ) -> Result<SceneTable<S, K>, SchemeError> {
        let frequencies = S::frequencies(constants);
        let mut coordinates =
            S::PerCoordinate::<[NodeCoefficients; K]>::from_fn(|_| [NodeCoefficients::straight(0.0); K]);
        for i in 0..S::N_COORDINATES {
            coordinates[i] = checked_coefficients(Frequency::from(frequencies[i]), i, quadrature, h)?;
        }
        Ok(SceneTable { coordinates })
    }
}

/// One curve per coordinate at `K` nodes.
pub struct SceneTable<S: HasFrequencies, const K: usize> {
    coordinates: S::PerCoordinate<[NodeCoefficients; K]>,
}

impl<S: HasFrequencies, const K: usize> InterpolationTable for SceneTable<S, K> {
    #[inline]
    fn coefficients(&self, node: usize, coordinate: usize) -> NodeCoefficients {
        self.coordinates[coordinate][node]
    }
}
