//! The classical Runge-Kutta method on the index-1 equations.

use crate::array::Array;
use crate::integrator::{OneStep, Scheme, StepError, Tally};
use crate::mechanics::{Mechanics, State};
use crate::memory::memory;
use crate::scheme::{SchemeError, checked_step_size};
use crate::system::MechanicalSystem;

/// Kutta's method of order 4 (Hairer, Nørsett, Wanner, Solving ODEs I, sec. II.1) for `q̈ = a(t, q, v)`, where the
/// accelerations solve the index-1 equations with multipliers and forces. Explicit, not symplectic; the constraints are
/// differentiated twice and drift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rk4 {
    h: f64,
}

impl Rk4 {
    /// Steps of size `h`.
    pub const fn new(h: f64) -> Self {
        Self { h }
    }
}

impl<S: MechanicalSystem> Scheme<S> for Rk4 {
    type Step = Rk4Step<S>;

    fn prepare(&self, mechanics: Mechanics<S>) -> Result<Rk4Step<S>, SchemeError> {
        Ok(Rk4Step { mechanics, h: checked_step_size(self.h)? })
    }
}

/// The one-step map of [`Rk4`].
pub struct Rk4Step<S: MechanicalSystem> {
    mechanics: Mechanics<S>,
    h: f64,
}

/// `(q̇, v̇)` at a stage.
struct Slope<S: MechanicalSystem> {
    q: S::PerCoordinate<f64>,
    v: S::PerCoordinate<f64>,
}

impl<S: MechanicalSystem> Rk4Step<S> {
    fn slope(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
        v: S::PerCoordinate<f64>,
        inputs: &S::PerInput<f64>,
        tally: &mut impl Tally,
    ) -> Result<Slope<S>, StepError> {
        let acceleration = self
            .mechanics
            .acceleration_tallied(t, q, &v, inputs, tally)
            .map_err(|matrix| StepError::Singular { t, correction: 0, matrix })?;
        Ok(Slope { v: acceleration.acceleration, q: v })
    }

    /// The slope at the end of a line of length `length` along `along`.
    fn slope_after(
        &self,
        state: &State<S>,
        length: f64,
        along: &Slope<S>,
        tally: &mut impl Tally,
    ) -> Result<Slope<S>, StepError> {
        let q = Array::from_fn(|i| state.q[i] + length * along.q[i]);
        let v = Array::from_fn(|i| state.v[i] + length * along.v[i]);
        self.slope(state.t + length, &q, v, &state.inputs, tally)
    }
}

impl<S: MechanicalSystem> OneStep<S> for Rk4Step<S> {
    fn h(&self) -> f64 {
        self.h
    }

    fn mechanics(&self) -> &Mechanics<S> {
        &self.mechanics
    }

    fn advance(&mut self, state: &mut State<S>, tally: &mut impl Tally) -> Result<(), StepError> {
        let h = self.h;
        let k1 = self.slope(state.t, &state.q, state.v.clone(), &state.inputs, tally)?;
        let k2 = self.slope_after(state, 0.5 * h, &k1, tally)?;
        let k3 = self.slope_after(state, 0.5 * h, &k2, tally)?;
        let k4 = self.slope_after(state, h, &k3, tally)?;
        let mean = |k1: f64, k2: f64, k3: f64, k4: f64| (k1 + 2.0 * (k2 + k3) + k4) / 6.0;
        let t = state.t + h;
        let q = Array::from_fn(|i| state.q[i] + h * mean(k1.q[i], k2.q[i], k3.q[i], k4.q[i]));
        let v = Array::from_fn(|i| state.v[i] + h * mean(k1.v[i], k2.v[i], k3.v[i], k4.v[i]));
        let p = self.mechanics.momentum_at(t, &q, &v);
        state.replace(t, q, v, p)
    }
}

memory!([S: MechanicalSystem] Rk4Step<S>, |_words| Self { mechanics: _, h: _ } => {});
