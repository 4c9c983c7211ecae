//! A point of a motion.

use core::fmt;

use crate::array::Array;
use crate::memory::memory;
use crate::system::MechanicalSystem;

/// Time, configuration, momentum, the velocity that belongs to the momentum, and the inputs of the step that begins here.
///
/// `p = ∂L/∂v(t, q, v)`, `φ(t, q) = 0` and `G v + ∂φ/∂t = 0` to round-off; only a start or a step makes a state.
// Aligned, so that instructions on two numbers take them from where they are.
#[repr(C, align(16))]
pub struct State<S: MechanicalSystem> {
    pub(crate) q: S::PerCoordinate<f64>,
    pub(crate) v: S::PerCoordinate<f64>,
    pub(crate) p: S::PerCoordinate<f64>,
    pub(crate) t: f64,
    pub(crate) inputs: S::PerInput<f64>,
}

impl<S: MechanicalSystem> State<S> {
    /// Zeros, for numbers to come.
    pub(crate) fn blank() -> Self {
        let none = S::PerCoordinate::<f64>::from_fn(|_| 0.0);
        Self { t: 0.0, q: none.clone(), v: none.clone(), p: none, inputs: Array::from_fn(|_| 0.0) }
    }

    /// Time.
    pub const fn t(&self) -> f64 {
        self.t
    }

    /// Configuration.
    pub const fn q(&self) -> &S::PerCoordinate<f64> {
        &self.q
    }

    /// Velocity.
    pub const fn v(&self) -> &S::PerCoordinate<f64> {
        &self.v
    }

    /// Momentum.
    pub const fn p(&self) -> &S::PerCoordinate<f64> {
        &self.p
    }

    /// The inputs, in the order of [`INPUTS`](MechanicalSystem::INPUTS): constant over the step that begins here, and over the
    /// following ones until they are set anew.
    pub const fn inputs(&self) -> &S::PerInput<f64> {
        &self.inputs
    }
}

// Written out, since a derive would demand the same of `S`, which is a type-level name only.
impl<S: MechanicalSystem> Clone for State<S> {
    fn clone(&self) -> Self {
        Self {
            t: self.t,
            q: self.q.clone(),
            v: self.v.clone(),
            p: self.p.clone(),
            inputs: self.inputs.clone(),
        }
    }
}

impl<S: MechanicalSystem> fmt::Debug for State<S> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut state = formatter.debug_struct("State");
        state.field("t", &self.t);
        state.field("q", &self.q.as_ref()).field("v", &self.v.as_ref()).field("p", &self.p.as_ref());
        if S::N_INPUTS > 0 {
            state.field("inputs", &self.inputs.as_ref());
        }
        state.finish()
    }
}

impl<S: MechanicalSystem> PartialEq for State<S> {
    /// Equality of every number.
    fn eq(&self, other: &Self) -> bool {
        self.t == other.t
            && self.q.as_ref() == other.q.as_ref()
            && self.v.as_ref() == other.v.as_ref()
            && self.p.as_ref() == other.p.as_ref()
            && self.inputs.as_ref() == other.inputs.as_ref()
    }
}

memory!([S: MechanicalSystem] State<S>, |words| Self { t, q, v, p, inputs } => {
    words.number(t);
    words.numbers(q);
    words.numbers(v);
    words.numbers(p);
    words.numbers(inputs);
});
