//! A kick, a drift and a kick with constraints: Newton's iteration on the multipliers alone.
//!
//! In: a [`KickDriftKick`], whose end point is affine in the impulse `ℓ = Λ/h` of the constraint force. Out: the `ℓ` for which
//! `φ(q₁(ℓ)) = 0`, and the state there. From the impulse that the previous steps predict, one or two corrections with one
//! matrix `G₁ D G₀ᵀ` do, as a rule; where they do not, Newton's iteration goes on with a fresh matrix for each.

mod attempt;
mod careful;
mod history;
mod span;

#[cfg(feature = "std")]
pub(crate) use self::attempt::TRUSTED;
use self::attempt::{Attempt, round_off_of};
use self::history::History;
use self::span::{Span, drift_of, move_by};
use super::StepError;
use crate::array::Array;
use crate::mechanics::{KickDriftKick, Lost, Mechanics, RoundOff, State, Sum};
use crate::memory::memory;
use crate::newton::Tally;
use crate::system::MechanicalSystem;

/// A step without its constraint forces, with the impulses that it has needed so far.
pub(crate) struct MultiplierStep<S: MechanicalSystem, F> {
    free: F,
    /// What is round-off of the residuals of the constraints, where it is the same for every configuration on them.
    allowed: Option<S::PerConstraint<f64>>,
    history: History<S>,
}

/// The end of a step on the constraints.
struct Landing<S: MechanicalSystem, Q> {
    q: Q,
    /// What was added to the impulse that the span begins with; in the end, the whole impulse.
    impulse: S::PerConstraint<f64>,
    /// Factors of `G M⁻¹ Gᵀ` there.
    gram: S::GramFactors,
    /// Number of corrections that led there.
    corrections: usize,
}

impl<S: MechanicalSystem, F: KickDriftKick<S>> MultiplierStep<S, F> {
    pub(crate) fn new(mechanics: &Mechanics<S>, free: F) -> Self {
        let allowed = mechanics.constant_reach().map(|reach| round_off_of(&reach));
        Self { free, allowed, history: History::none() }
    }

    /// The step without its constraint forces.
    pub(crate) const fn free(&self) -> &F {
        &self.free
    }

    /// `ℓ` of the last step that was taken.
    #[cfg(feature = "std")]
    pub(crate) const fn last_impulse(&self) -> &S::PerConstraint<f64> {
        &self.history.previous[0]
    }

    /// Overwrites `state` with the state one step of size `h` later, and returns what its positions and momenta have lost.
    ///
    /// What follows where two corrections do not suffice takes copies, and ends the step by itself: on the way that most steps
    /// take no value lies in memory for its sake.
    #[inline(always)]
    pub(crate) fn advance<R: RoundOff<S>>(
        &mut self,
        mechanics: &Mechanics<S>,
        h: f64,
        state: &mut State<S>,
        round_off: R,
        tally: &mut impl Tally,
    ) -> Result<[Lost<S, R>; 2], StepError> {
        let Self { free, allowed, history } = self;
        if S::N_CONSTRAINTS == 0 {
            let kick = free.start_kick(mechanics, state.t, &state.q);
            let momentum = round_off.momentum(&state.p).plus(&kick);
            let difference = drift_of(&*free, &momentum);
            let (q, lost_q) = round_off.position(&state.q).plus(&difference).split();
            let t = state.t + h;
            let (p, lost_p) = momentum.plus(&free.end_kick(mechanics, t, &q)).split();
            state.replace(t, q, free.legendre().velocity(&p), p)?;
            return Ok([lost_q, lost_p]);
        }
        let mut span = Span::new(mechanics, &*free, h, state, round_off, &history.predicted);
        let Some(attempt) = span.attempt(&history.predicted, allowed.as_ref(), tally) else {
            return span.land_slowly(None, history, state, tally);
        };
        if attempt.is_solved
            && let Ok(gram) = free.legendre().factor_usual_gram(mechanics, &attempt.jacobian, tally)
        {
            let Attempt { q, correction, corrections, .. } = attempt;
            move_by::<S, _>(&mut span.momentum, &correction.pull);
            // As good a guess as that from the impulse itself, and known at the start of the step.
            let expected = history.expected_end_impulse(&history.predicted);
            let impulse = Array::from_fn(|c| history.predicted[c] + correction.impulse[c]);
            let landing = Landing { q, impulse, gram, corrections };
            return span.land(landing, &expected, history, state, tally);
        }
        span.land_slowly(Some(attempt), history, state, tally)
    }
}

impl<S: MechanicalSystem, F: KickDriftKick<S>, R: RoundOff<S>> Span<'_, S, F, R> {
    /// Ends the step: overwrites `state` with the end on the constraints.
    #[inline(always)]
    fn land(
        self,
        Landing { q: position, impulse, gram, corrections }: Landing<S, R::Sum>,
        expected: &S::PerConstraint<f64>,
        history: &mut History<S>,
        state: &mut State<S>,
        tally: &mut impl Tally,
    ) -> Result<[Lost<S, R>; 2], StepError> {
        let Self { mechanics, free, t_end: t, momentum, .. } = self;
        tally.count_corrections(corrections);
        let (q, lost_q) = position.split();
        let momentum = momentum.plus(&free.end_kick(mechanics, t, &q));
        let (_, jacobian) = S::constraint_derivatives(&mechanics.constants, t, &q);
        let (v, momentum) = free.legendre().project(mechanics, &gram, &jacobian, expected, momentum);
        let (p, lost_p) = momentum.split();
        state.replace(t, q, v, p)?;
        history.remember(impulse);
        Ok([lost_q, lost_p])
    }
}

memory!([S: MechanicalSystem, F] MultiplierStep<S, F>, |words| Self { free: _, allowed: _, history } => { words.part(history) });
