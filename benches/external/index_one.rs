//! A scene as an ordinary differential equation, `y = (q, v)`, or `y = (q, v, t)` where the solver cannot be trusted with the time.

use std::cell::Cell;

use evi_core::array::Array;
use evi_core::linear::SingularMatrix;
use evi_core::mechanics::Mechanics;
use evi_core::system::MechanicalSystem;

/// `q̇ = v`, `v̇ = a(t, q, v)`, the inputs zero.
pub(crate) struct IndexOne<S: MechanicalSystem> {
    pub(crate) mechanics: Mechanics<S>,
    inputs: S::PerInput<f64>,
    /// Time and matrix of the first evaluation that had no accelerations, since it was last taken.
    singular: Cell<Option<(f64, SingularMatrix)>>,
}

impl<S: MechanicalSystem> IndexOne<S> {
    pub(crate) fn new(system: &S) -> Self {
        let mechanics = Mechanics::new(system);
        Self { mechanics, inputs: Array::from_fn(|_| 0.0), singular: Cell::new(None) }
    }

    /// Writes the slope at `y` into `slope`, with the time in `y` where it has one: not a number where there are no accelerations, so that any solver rejects the step.
    #[inline(always)]
    pub(crate) fn slope(&self, t: f64, y: &[f64], slope: &mut [f64]) {
        let n = S::N_COORDINATES;
        let (q, v) = split::<S>(y);
        let t = y.get(2 * n).copied().unwrap_or(t);
        match self.mechanics.acceleration_with(t, &q, &v, &self.inputs) {
            Ok(motion) => {
                slope[..n].copy_from_slice(v.as_ref());
                slope[n..2 * n].copy_from_slice(motion.acceleration.as_ref());
                slope[2 * n..].fill(1.0);
            }
            Err(matrix) => {
                self.singular.set(self.singular.get().or(Some((t, matrix))));
                slope.fill(f64::NAN);
            }
        }
    }

    /// What has gone wrong since this was last asked.
    pub(crate) fn take_singular(&self) -> Option<(f64, SingularMatrix)> {
        self.singular.take()
    }
}

/// `(q, v)` of `y`.
#[inline(always)]
pub(crate) fn split<S: MechanicalSystem>(y: &[f64]) -> (S::PerCoordinate<f64>, S::PerCoordinate<f64>) {
    (Array::from_fn(|i| y[i]), Array::from_fn(|i| y[S::N_COORDINATES + i]))
}
