//! Compensated summation: the digits that a state loses are kept for the next step.

use super::{OneStep, Scheme, StepError, Tally};
use crate::array::Array;
use crate::mechanics::{LostDigits, Mechanics, State};
use crate::memory::{Memory, memory};
use crate::scheme::SchemeError;
use crate::system::MechanicalSystem;

/// A scheme whose steps can keep the digits that adding their changes to a state loses.
///
/// A composition is compensated as a whole, so that digits pass from stage to stage; stages that each keep their own are refused, as are
/// schemes that form their momenta from large terms:
///
/// ```compile_fail,E0599
/// # use evi_core::prelude::*;
/// let refused = Evi::midpoint(0.1).compensated().composed(Composition::suzuki_4());
/// ```
///
/// ```compile_fail,E0599
/// # use evi_core::{baseline::Rk4, prelude::*};
/// let refused = Rk4::new(0.1).compensated();
/// ```
pub trait Compensable: Sized {
    /// Takes the same steps with compensated summation.
    ///
    /// Of the changes of a step, which are of size `h`, plain summation loses digits of the size of round-off of the state. Compensated, what is
    /// left is round-off of the changes, smaller by the factor `h`: with it the energy error of long runs in small steps falls, where
    /// the truncation error is below it. A step takes somewhat longer; schemes without it pay nothing.
    ///
    /// ```
    /// use evi_core::prelude::*;
    /// let midpoint = Evi::midpoint(0.01).compensated();
    /// let order_8 = Evi::midpoint(0.01).composed(Composition::kahan_li_8()).compensated();
    /// # let _ = (midpoint, order_8);
    /// ```
    fn compensated(self) -> Compensated<Self> {
        Compensated { scheme: self }
    }
}

/// A one-step map that can keep lost digits.
pub trait CompensableStep<S: MechanicalSystem>: OneStep<S> {
    /// Overwrites `state` with the state one step later, and `lost` with what it has lost: from the state and what that had lost.
    ///
    /// # Errors
    /// [`StepError`] as for [`OneStep::advance`]; neither `state` nor `lost` has changed then.
    fn advance_compensated(
        &mut self,
        state: &mut State<S>,
        lost: &mut LostDigits<S>,
        tally: &mut impl Tally,
    ) -> Result<(), StepError>;
}

/// A scheme with compensated summation; made by [`Compensable::compensated`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compensated<B> {
    scheme: B,
}

impl<S, B> Scheme<S> for Compensated<B>
where
    S: MechanicalSystem,
    B: Scheme<S, Step: CompensableStep<S>>,
{
    type Step = CompensatedStep<S, B::Step>;

    fn prepare(&self, mechanics: Mechanics<S>) -> Result<Self::Step, SchemeError> {
        Ok(CompensatedStep { map: self.scheme.prepare(mechanics)?, reached: None })
    }
}

/// The one-step map of a [`Compensated`] scheme, with the digits that the state which it has reached has lost.
///
/// They belong to that state and no other: a step from any other one starts with none lost.
pub struct CompensatedStep<S: MechanicalSystem, M> {
    map: M,
    reached: Option<Reached<S>>,
}

/// The end of a step.
struct Reached<S: MechanicalSystem> {
    q: S::PerCoordinate<f64>,
    p: S::PerCoordinate<f64>,
    lost: LostDigits<S>,
}

impl<S: MechanicalSystem> Reached<S> {
    fn none() -> Self {
        let none = S::PerCoordinate::<f64>::from_fn(|_| 0.0);
        Self { q: none.clone(), p: none, lost: LostDigits::none() }
    }

    /// Time and inputs may have been set anew since.
    fn is(&self, state: &State<S>) -> bool {
        // Equality of bits: digits lost by one state are wrong for its neighbour.
        self.q.as_ref() == state.q().as_ref() && self.p.as_ref() == state.p().as_ref()
    }
}

impl<S: MechanicalSystem, M> CompensatedStep<S, M> {
    /// What `state` has lost: digits if the last step has led there, else zeros.
    pub fn lost_digits(&self, state: &State<S>) -> LostDigits<S> {
        match &self.reached {
            Some(reached) if reached.is(state) => reached.lost.clone(),
            _ => LostDigits::none(),
        }
    }
}

impl<S: MechanicalSystem, M: CompensableStep<S>> OneStep<S> for CompensatedStep<S, M> {
    fn h(&self) -> f64 {
        self.map.h()
    }

    fn mechanics(&self) -> &Mechanics<S> {
        self.map.mechanics()
    }

    #[inline]
    fn advance(&mut self, state: &mut State<S>, tally: &mut impl Tally) -> Result<(), StepError> {
        let mut lost = self.lost_digits(state);
        self.map.advance_compensated(state, &mut lost, tally)?;
        self.reached = Some(Reached { q: state.q().clone(), p: state.p().clone(), lost });
        Ok(())
    }
}

memory!([S: MechanicalSystem, M: Memory] CompensatedStep<S, M>, |words| Self { map, reached } => {
    words.part(map);
    words.optional(reached, Reached::none);
});

memory!([S: MechanicalSystem] Reached<S>, |words| Self { q, p, lost } => {
    words.numbers(q);
    words.numbers(p);
    words.part(lost);
});
