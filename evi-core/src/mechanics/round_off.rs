//! What becomes of the digits that are lost when the small change of a step is added to a large number.
//!
//! A step of size `h` changes positions and momenta by a fraction `h` of what they are: of each change, `1/h` in units of round-off is
//! lost. Kept and added to the next change they leave round-off of the changes themselves, smaller by the factor `h` (Kahan, Comm. ACM 8
//! (1965) 40; Hairer, McLachlan, Razakarivony, BIT 48 (2008) 231, for symplectic integrators).
//!
//! A step adds to a [`Sum`] and does not see which of the two it is: [`Rounded`] rounds after every term, and is what was there
//! before; [`Extended`] adds up the terms of the step, the lost digits first.

use core::borrow::Borrow;

use crate::array::Array;
use crate::memory::memory;
use crate::system::MechanicalSystem;

/// Positions or momenta while a step adds to them.
pub(crate) trait Sum<S: MechanicalSystem>: Sized {
    /// Digits that a sum loses.
    type Lost;

    /// The sum, and what it has lost.
    fn split(self) -> (S::PerCoordinate<f64>, Self::Lost);

    /// The sum.
    fn value(&self) -> impl Borrow<S::PerCoordinate<f64>>;

    /// What the next term is added to.
    fn terms_mut(&mut self) -> &mut S::PerCoordinate<f64>;

    /// What the next term is added to, to read.
    fn terms(&self) -> &S::PerCoordinate<f64>;

    /// The sum whose `terms` are those of this one and more.
    #[must_use]
    fn with(self, terms: S::PerCoordinate<f64>) -> Self;

    /// The sum with one more term.
    #[inline(always)]
    #[must_use]
    fn plus(self, term: &S::PerCoordinate<f64>) -> Self {
        let terms = Array::from_fn(|i| self.terms()[i] + term[i]);
        self.with(terms)
    }
}

/// What a step does with lost digits.
pub(crate) trait RoundOff<S: MechanicalSystem>: Copy {
    /// What positions and momenta are added up in.
    type Sum: Sum<S>;

    /// The sum of `q₀` and what follows.
    fn position(self, q: &S::PerCoordinate<f64>) -> Self::Sum;

    /// The sum of `p₀` and what follows.
    fn momentum(self, p: &S::PerCoordinate<f64>) -> Self::Sum;

    /// The sum of `p₀` and the change of momentum over a step: from the momentum at its `end`, or from the `gain`, whose terms are small.
    fn end_momentum(
        self,
        p: &S::PerCoordinate<f64>,
        end: impl FnOnce() -> S::PerCoordinate<f64>,
        gain: impl FnOnce() -> S::PerCoordinate<f64>,
    ) -> Self::Sum;
}

/// The digits that a sum loses.
pub(crate) type Lost<S, R> = <<R as RoundOff<S>>::Sum as Sum<S>>::Lost;

/// Lost digits are dropped.
#[derive(Clone, Copy)]
pub(crate) struct Dropped;

/// The digits that the positions and momenta of a state have lost: `q + e_q` and `p + e_p` are the more accurate ones.
pub struct LostDigits<S: MechanicalSystem> {
    q: S::PerCoordinate<f64>,
    p: S::PerCoordinate<f64>,
}

/// A sum that is rounded after every term.
pub(crate) struct Rounded<S: MechanicalSystem>(pub(crate) S::PerCoordinate<f64>);

/// A large value, and what is added to it.
pub(crate) struct Extended<S: MechanicalSystem> {
    start: S::PerCoordinate<f64>,
    added: S::PerCoordinate<f64>,
}

impl<S: MechanicalSystem> LostDigits<S> {
    pub(crate) const fn new(q: S::PerCoordinate<f64>, p: S::PerCoordinate<f64>) -> Self {
        Self { q, p }
    }

    /// None: of a state that nothing was added to.
    pub(crate) fn none() -> Self {
        let none = S::PerCoordinate::<f64>::from_fn(|_| 0.0);
        Self { q: none.clone(), p: none }
    }

    /// What `q` has lost.
    pub const fn q(&self) -> &S::PerCoordinate<f64> {
        &self.q
    }

    /// What `p` has lost.
    pub const fn p(&self) -> &S::PerCoordinate<f64> {
        &self.p
    }
}

impl<S: MechanicalSystem> RoundOff<S> for Dropped {
    type Sum = Rounded<S>;

    #[inline(always)]
    fn position(self, q: &S::PerCoordinate<f64>) -> Rounded<S> {
        Rounded(q.clone())
    }

    #[inline(always)]
    fn momentum(self, p: &S::PerCoordinate<f64>) -> Rounded<S> {
        Rounded(p.clone())
    }

    #[inline(always)]
    fn end_momentum(
        self,
        _p: &S::PerCoordinate<f64>,
        end: impl FnOnce() -> S::PerCoordinate<f64>,
        _gain: impl FnOnce() -> S::PerCoordinate<f64>,
    ) -> Rounded<S> {
        Rounded(end())
    }
}

impl<S: MechanicalSystem> RoundOff<S> for &LostDigits<S> {
    type Sum = Extended<S>;

    #[inline]
    fn position(self, q: &S::PerCoordinate<f64>) -> Extended<S> {
        Extended { start: q.clone(), added: self.q.clone() }
    }

    #[inline]
    fn momentum(self, p: &S::PerCoordinate<f64>) -> Extended<S> {
        Extended { start: p.clone(), added: self.p.clone() }
    }

    #[inline]
    fn end_momentum(
        self,
        p: &S::PerCoordinate<f64>,
        _end: impl FnOnce() -> S::PerCoordinate<f64>,
        gain: impl FnOnce() -> S::PerCoordinate<f64>,
    ) -> Extended<S> {
        self.momentum(p).plus(&gain())
    }
}

impl<S: MechanicalSystem> Sum<S> for Rounded<S> {
    type Lost = ();

    #[inline(always)]
    fn split(self) -> (S::PerCoordinate<f64>, ()) {
        (self.0, ())
    }

    #[inline(always)]
    fn value(&self) -> impl Borrow<S::PerCoordinate<f64>> {
        &self.0
    }

    #[inline(always)]
    fn terms(&self) -> &S::PerCoordinate<f64> {
        &self.0
    }

    #[inline(always)]
    fn with(self, terms: S::PerCoordinate<f64>) -> Self {
        Self(terms)
    }

    #[inline(always)]
    fn terms_mut(&mut self) -> &mut S::PerCoordinate<f64> {
        &mut self.0
    }
}

impl<S: MechanicalSystem> Extended<S> {
    #[inline]
    fn rounded(&self) -> S::PerCoordinate<f64> {
        Array::from_fn(|i| self.start[i] + self.added[i])
    }
}

impl<S: MechanicalSystem> Sum<S> for Extended<S> {
    type Lost = S::PerCoordinate<f64>;

    /// The exact difference of the sum and its value (Knuth, The Art of Computer Programming 2, sec. 4.2.2, thm. B), whichever of
    /// the two terms is the larger one.
    #[inline]
    fn split(self) -> (S::PerCoordinate<f64>, S::PerCoordinate<f64>) {
        let value = self.rounded();
        let lost = Array::from_fn(|i| {
            let added = value[i] - self.start[i];
            (self.start[i] - (value[i] - added)) + (self.added[i] - added)
        });
        (value, lost)
    }

    #[inline]
    fn value(&self) -> impl Borrow<S::PerCoordinate<f64>> {
        self.rounded()
    }

    #[inline]
    fn terms(&self) -> &S::PerCoordinate<f64> {
        &self.added
    }

    #[inline]
    fn with(self, terms: S::PerCoordinate<f64>) -> Self {
        Self { added: terms, ..self }
    }

    #[inline]
    fn terms_mut(&mut self) -> &mut S::PerCoordinate<f64> {
        &mut self.added
    }
}

// Written out, since a derive would demand the same of `S`, which is a type-level name only.
impl<S: MechanicalSystem> Clone for LostDigits<S> {
    fn clone(&self) -> Self {
        Self { q: self.q.clone(), p: self.p.clone() }
    }
}

memory!([S: MechanicalSystem] LostDigits<S>, |words| Self { q, p } => {
    words.numbers(q);
    words.numbers(p);
});
