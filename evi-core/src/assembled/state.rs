//! A point of the motion of an assembled scene.

use crate::memory::memory;

/// Time, configuration, momentum, and the velocity that belongs to the momentum: `p = ∂L/∂v(t, q, v)`, `φ(t, q) = 0` and `G v + ∂φ/∂t = 0` to
/// round-off; only a start or a step makes a state.
#[derive(Clone, Debug, PartialEq)]
pub struct AssembledState {
    pub(super) t: f64,
    pub(super) q: Vec<f64>,
    pub(super) v: Vec<f64>,
    pub(super) p: Vec<f64>,
    pub(super) inputs: Vec<f64>,
}

memory!([] AssembledState, |words| Self { t, q, v, p, inputs } => {
    words.number(t);
    for values in [q, v, p, inputs] {
        words.slice(values);
    }
});

impl AssembledState {
    /// Zeros, for numbers to come.
    pub(super) fn blank(n_coordinates: usize, n_inputs: usize) -> Self {
        let none = || vec![0.0; n_coordinates];
        Self { t: 0.0, q: none(), v: none(), p: none(), inputs: vec![0.0; n_inputs] }
    }

    /// Overwrites every number.
    pub(super) fn copy_from(&mut self, other: &Self) {
        self.t = other.t;
        self.q.copy_from_slice(&other.q);
        self.v.copy_from_slice(&other.v);
        self.p.copy_from_slice(&other.p);
        self.inputs.copy_from_slice(&other.inputs);
    }

    /// Time.
    pub const fn t(&self) -> f64 {
        self.t
    }

    /// Configuration.
    pub fn q(&self) -> &[f64] {
        &self.q
    }

    /// Velocity.
    pub fn v(&self) -> &[f64] {
        &self.v
    }

    /// Inputs of the step that begins here.
    pub fn inputs(&self) -> &[f64] {
        &self.inputs
    }

    /// Momentum.
    pub fn p(&self) -> &[f64] {
        &self.p
    }
}
