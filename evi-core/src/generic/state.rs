//! A point of a motion on the generic path.

use nalgebra::DMatrix;

use super::GenericSystem;

/// A point of a motion; constraints and hidden constraints hold to round-off.
pub(super) struct GenericState {
    pub(super) t: f64,
    pub(super) q: Vec<f64>,
    pub(super) v: Vec<f64>,
    pub(super) p: Vec<f64>,
    /// Constant over the step that begins here.
    pub(super) inputs: Vec<f64>,
    /// `G(t, q)`: the end of one step is the start of the next.
    pub(super) jacobian: DMatrix<f64>,
}

impl GenericState {
    pub(super) fn zero(system: &impl GenericSystem) -> Self {
        let n = system.n_coordinates();
        let zeros = || vec![0.0; n];
        let jacobian = DMatrix::zeros(system.n_constraints(), n);
        let inputs = vec![0.0; system.n_inputs()];
        Self { t: 0.0, q: zeros(), v: zeros(), p: zeros(), inputs, jacobian }
    }

    /// A state of no system, which takes the place of one that is lent. Without memory.
    pub(super) fn empty() -> Self {
        let [q, v, p, inputs] = [Vec::new(), Vec::new(), Vec::new(), Vec::new()];
        Self { t: 0.0, q, v, p, inputs, jacobian: DMatrix::zeros(0, 0) }
    }

    pub(super) fn is_finite(&self) -> bool {
        [&self.q, &self.v, &self.p].into_iter().flatten().all(|number| number.is_finite())
    }
}
