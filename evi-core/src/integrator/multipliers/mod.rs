//! A kick, a drift and a kick with constraints: Newton's iteration on the multipliers alone.
//!
//! In: a [`KickDriftKick`], whose end point is affine in the impulse `ℓ = Λ/h` of the constraint force. Out: the `ℓ` for which
//! `φ(q₁(ℓ)) = 0`, and the state there. From the impulse that the previous steps predict, one or two corrections with one
//! matrix `G₁ D G₀ᵀ` do, as a rule; where they do not, the step is taken anew, with a fresh matrix for each correction.
//!
//! Here `φ` and `G` are those of the scene over their content (`JacobianPattern::content`), and `ℓ` is larger by that factor.

mod attempt;
mod bend;
mod careful;
mod history;
mod span;

use self::attempt::Attempt;
#[cfg(feature = "std")]
pub(crate) use self::attempt::TRUSTED;
use self::bend::Bend;
use self::history::History;
use self::span::{Span, drift_of, move_by};
use super::StepError;
use crate::array::Array;
use crate::mechanics::{KickDriftKick, Lost, Mechanics, NOTHING, RoundOff, State, Sum, over_content};
use crate::memory::memory;
use crate::newton::Tally;
use crate::system::MechanicalSystem;

/// A step without its constraint forces, with the impulses that it has needed so far.
pub(crate) struct MultiplierStep<S: MechanicalSystem, F> {
    free: F,
    /// Of the constraints.
    bend: Bend<S>,
    history: History<S>,
}

impl<S: MechanicalSystem, F: KickDriftKick<S>> MultiplierStep<S, F> {
    pub(crate) fn new(mechanics: &Mechanics<S>, free: F) -> Self {
        let bend = Bend::new(mechanics, |i| free.drift().at(i, i));
        Self { free, bend, history: History::none() }
    }

    /// The step without its constraint forces.
    pub(crate) const fn free(&self) -> &F {
        &self.free
    }

    /// `ℓ` of the last step that was taken.
    #[cfg(feature = "std")]
    pub(crate) fn last_impulse(&self) -> S::PerConstraint<f64> {
        over_content::<S>(self.history.previous[0].clone())
    }

    /// Overwrites `state` with the state one step of size `h` later, and returns what its positions and momenta have lost.
    ///
    /// Where two corrections do not suffice nothing is carried over from them: on the way that most steps take, no value lies in memory for the
    /// sake of the other one.
    #[inline(always)]
    pub(crate) fn advance<R: RoundOff<S>>(
        &mut self,
        mechanics: &Mechanics<S>,
        h: f64,
        state: &mut State<S>,
        round_off: R,
        tally: &mut impl Tally,
    ) -> Result<[Lost<S, R>; 2], StepError> {
        if S::N_CONSTRAINTS == 0 {
            let free = &self.free;
            let kick = free.start_kick(mechanics, state.t, &state.q);
            let momentum = round_off.momentum(&state.p).plus(&kick);
            let difference = drift_of(free, &momentum);
            let (q, lost_q) = round_off.position(&state.q).plus(&difference).split();
            let t = state.t + h;
            let (p, lost_p) = momentum.plus(&free.end_kick(mechanics, t, &q)).split();
            state.replace(t, q, free.legendre().velocity(&p), p)?;
            return Ok([lost_q, lost_p]);
        }
        match self.follow(mechanics, h, state, round_off, tally) {
            Some(lost) => Ok(lost),
            None => self.search(mechanics, h, state, round_off, tally),
        }
    }

    /// The step from the predicted impulse, if one or two corrections with one matrix suffice; if not, `state` has not changed.
    #[inline(always)]
    fn follow<R: RoundOff<S>>(
        &mut self,
        mechanics: &Mechanics<S>,
        h: f64,
        state: &mut State<S>,
        round_off: R,
        tally: &mut impl Tally,
    ) -> Option<[Lost<S, R>; 2]> {
        let Self { free, bend, history } = self;
        let span = Span::new(mechanics, &*free, h, state, round_off, &history.predicted);
        let Attempt { q, correction, corrections } = span.attempt(&history.predicted, bend)?;
        let Span { t_end: t, momentum, .. } = span;
        let (q, lost_q) = q.split();
        // The kick first, which waits for no correction where it is the same everywhere.
        let mut momentum = momentum.plus(&free.end_kick(mechanics, t, &q));
        move_by::<S, _>(&mut momentum, &correction.pull);
        let (v, momentum) =
            free.legendre().project_as_expected(mechanics, (t, &q), &history.expected, momentum, tally)?;
        if !Attempt::<S, R::Sum>::VOUCHES_FOR_POSITIONS && !is_finite::<S>(&q) {
            return None;
        }
        let (p, lost_p) = momentum.split();
        tally.count_corrections(corrections);
        (state.q, state.v, state.p) = (q, v, p);
        history.remember(Array::from_fn(|c| history.predicted[c] + correction.impulse[c]));
        // Last, so that the optimiser sees who overwrites it.
        state.t = t;
        Some([lost_q, lost_p])
    }

    /// The step by Newton's iteration with a fresh matrix for each correction.
    #[cold]
    #[inline(never)]
    fn search<R: RoundOff<S>>(
        &mut self,
        mechanics: &Mechanics<S>,
        h: f64,
        state: &mut State<S>,
        round_off: R,
        tally: &mut impl Tally,
    ) -> Result<[Lost<S, R>; 2], StepError> {
        let Self { free, history, .. } = self;
        Span::new(mechanics, &*free, h, state, round_off, &history.predicted).search(history, state, tally)
    }
}

/// Whether every number is: a sum is finite only if all of its terms are.
#[inline(always)]
fn is_finite<S: MechanicalSystem>(q: &S::PerCoordinate<f64>) -> bool {
    let mut sum = NOTHING;
    for i in 0..S::N_COORDINATES {
        sum += q[i];
    }
    sum.abs() < f64::INFINITY
}

memory!([S: MechanicalSystem, F] MultiplierStep<S, F>, |words| Self { free: _, bend: _, history } => { words.part(history) });
