//! SHAKE: leapfrog with position constraints.

use super::constrained_drift::{ConstrainedDrift, DriftStart};
use crate::array::Array;
use crate::integrator::{OneStep, Scheme, StepError, Tally};
use crate::mechanics::{Mechanics, State};
use crate::memory::memory;
use crate::scheme::{SchemeError, checked_step_size};
use crate::system::MechanicalSystem;

/// SHAKE (Ryckaert, Ciccotti, Berendsen, J. Comput. Phys. 23 (1977) 327; Hairer, Lubich, Wanner, Geometric Numerical Integration,
/// sec. VII.1.4) for scenes with constant mass matrix and `L = ½vᵀMv − V(t, q)`: Verlet's leapfrog with constraint forces where the
/// step begins,
///
/// ```text
/// v₊ = v₋ + h M⁻¹(f(q₀) − G₀ᵀ λ₀)     q₁ = q₀ + h v₊     φ(q₁) = 0
/// ```
///
/// from `v₊ = v₀ + ½h M⁻¹(f(q₀) − G₀ᵀ λ₀)` in the first step. Positions are those of [`Rattle`](super::Rattle), to round-off.
///
/// The velocity of a state is `v = ½(v₋ + v₊) = (q₁ − q₋₁)/2h`, as usual for Verlet, and `p = M v`: of order 2, but **not** on the
/// hidden constraints, which it violates by `O(h²)`. `v₊` takes the multipliers of the following step, so that a step ends when the
/// next position is known: one force and one solution for the multipliers per step all the same, since the map keeps what it has
/// found; a step fails where the next position is not found. From a state that is not the one that it ended with, the map starts
/// afresh, by a half kick.
///
/// Forces that depend on velocities are refused, as by RATTLE.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shake {
    h: f64,
}

impl Shake {
    /// Steps of size `h`.
    pub const fn new(h: f64) -> Self {
        Self { h }
    }
}

impl<S: MechanicalSystem> Scheme<S> for Shake {
    type Step = ShakeStep<S>;

    fn prepare(&self, mechanics: Mechanics<S>) -> Result<ShakeStep<S>, SchemeError> {
        let h = checked_step_size(self.h)?;
        Ok(ShakeStep { drift: ConstrainedDrift::new("SHAKE", mechanics, h)?, ahead: None })
    }
}

/// The one-step map of [`Shake`].
pub struct ShakeStep<S: MechanicalSystem> {
    drift: ConstrainedDrift<S>,
    ahead: Option<Ahead<S>>,
}

/// What a step has found of the one that follows.
struct Ahead<S: MechanicalSystem> {
    /// The state that the step has ended with.
    from: State<S>,
    leap: Leap<S>,
}

/// `v₊` and `q₁`.
struct Leap<S: MechanicalSystem> {
    v: S::PerCoordinate<f64>,
    q: S::PerCoordinate<f64>,
}

// Written out, since a derive would demand the same of `S`.
impl<S: MechanicalSystem> Clone for Leap<S> {
    fn clone(&self) -> Self {
        Self { v: self.v.clone(), q: self.q.clone() }
    }
}

impl<S: MechanicalSystem> OneStep<S> for ShakeStep<S> {
    fn h(&self) -> f64 {
        self.drift.h()
    }

    fn mechanics(&self) -> &Mechanics<S> {
        self.drift.mechanics()
    }

    fn advance(&mut self, state: &mut State<S>, tally: &mut impl Tally) -> Result<(), StepError> {
        let h = self.h();
        let t = state.t + h;
        let Leap { v: arriving, q } = match &self.ahead {
            Some(ahead) if ahead.is_of(state) => ahead.leap.clone(),
            _ => self.leap_from(state, tally)?,
        };
        let end = DriftStart { t, q: &q };
        let mut leaving = self.drift.kicked(h, end, &arriving, &state.inputs);
        let next = self.drift.drift(end, &mut leaving, tally)?;
        let v: S::PerCoordinate<f64> = Array::from_fn(|i| 0.5 * (arriving[i] + leaving[i]));
        let p = self.mechanics().momentum_at(t, &q, &v);
        state.replace(t, q, v, p)?;
        self.ahead = Some(Ahead { from: state.clone(), leap: Leap { v: leaving, q: next } });
        Ok(())
    }
}

impl<S: MechanicalSystem> ShakeStep<S> {
    /// The first leap, by a half kick.
    fn leap_from(&mut self, state: &State<S>, tally: &mut impl Tally) -> Result<Leap<S>, StepError> {
        let start = DriftStart { t: state.t, q: &state.q };
        let mut v = self.drift.kicked(0.5 * self.h(), start, &state.v, &state.inputs);
        self.drift.forget_impulses();
        let q = self.drift.drift(start, &mut v, tally)?;
        // Those of whole kicks are twice as large.
        self.drift.forget_impulses();
        Ok(Leap { v, q })
    }
}

impl<S: MechanicalSystem> Ahead<S> {
    /// Whether `state` is where this begins, to the last bit but for its time, which a run counts in steps.
    fn is_of(&self, state: &State<S>) -> bool {
        let State { t: _, q, v, p, inputs } = &self.from;
        q.as_ref() == state.q.as_ref()
            && v.as_ref() == state.v.as_ref()
            && p.as_ref() == state.p.as_ref()
            && inputs.as_ref() == state.inputs.as_ref()
    }
}

memory!([S: MechanicalSystem] ShakeStep<S>, |words| Self { drift, ahead } => {
    words.part(drift);
    words.optional(ahead, || {
        let none = S::PerCoordinate::<f64>::from_fn(|_| 0.0);
        Ahead { from: State::blank(), leap: Leap { v: none.clone(), q: none } }
    });
});

memory!([S: MechanicalSystem] Ahead<S>, |words| Self { from, leap: Leap { v, q } } => {
    words.part(from);
    words.numbers(v);
    words.numbers(q);
});
