//! The states of eight members, side by side.

use crate::array::Array;
use crate::mechanics::State;
use crate::scalar::{LANES, Lanes};
use crate::system::MechanicalSystem;

use super::mask::LaneMask;

/// Zeros; written as a copy, since what builds an array from a function is not always inlined.
#[inline(always)]
pub(super) fn nothing<A: Array<Lanes>>() -> A {
    A::filled(Lanes::ZERO)
}

/// Arrays side by side, the `i`-th number of a lane's array from `number(lane, i)`.
pub(super) fn side_by_side<A: Array<Lanes>>(number: impl Fn(usize, usize) -> f64) -> A {
    A::from_fn(|i| Lanes::new(core::array::from_fn(|lane| number(lane, i))))
}

/// `x` in the chosen lanes, what `kept` was elsewhere.
#[inline(always)]
pub(super) fn blend<A: Array<Lanes>>(mask: LaneMask, x: &A, kept: &mut A) {
    for i in 0..A::LEN {
        kept[i] = mask.select(x[i], kept[i]);
    }
}

/// Configurations, velocities and momenta of eight members at the same time.
pub struct LaneState<S: MechanicalSystem> {
    pub(super) t: f64,
    pub(super) q: S::PerCoordinate<Lanes>,
    pub(super) v: S::PerCoordinate<Lanes>,
    pub(super) p: S::PerCoordinate<Lanes>,
}

// Written out, since a derive would demand the same of `S`, which is a type-level name only.
impl<S: MechanicalSystem> Clone for LaneState<S> {
    fn clone(&self) -> Self {
        Self { t: self.t, q: self.q.clone(), v: self.v.clone(), p: self.p.clone() }
    }
}

impl<S: MechanicalSystem> LaneState<S> {
    /// These states at time `t`.
    pub(super) fn of(t: f64, states: [&State<S>; LANES]) -> Self {
        Self {
            t,
            q: side_by_side(|lane, i| states[lane].q[i]),
            v: side_by_side(|lane, i| states[lane].v[i]),
            p: side_by_side(|lane, i| states[lane].p[i]),
        }
    }

    /// Overwrites `state` with that of one lane.
    pub(super) fn write(&self, lane: usize, state: &mut State<S>) {
        state.t = self.t;
        for i in 0..S::N_COORDINATES {
            state.q[i] = self.q[i].to_array()[lane];
            state.v[i] = self.v[i].to_array()[lane];
            state.p[i] = self.p[i].to_array()[lane];
        }
    }

    /// Overwrites one lane with `state`; time is common to all.
    pub(super) fn read(&mut self, lane: usize, state: &State<S>) {
        for i in 0..S::N_COORDINATES {
            self.q[i] = self.q[i].with(lane, state.q[i]);
            self.v[i] = self.v[i].with(lane, state.v[i]);
            self.p[i] = self.p[i].with(lane, state.p[i]);
        }
    }

    /// Overwrites the lanes that are not in `failed`, among those of `active` only where the end is finite; returns the lanes of `active`
    /// that stay where they were.
    #[inline(always)]
    pub(super) fn replace(
        &mut self,
        q: S::PerCoordinate<Lanes>,
        v: S::PerCoordinate<Lanes>,
        p: S::PerCoordinate<Lanes>,
        active: LaneMask,
        failed: LaneMask,
    ) -> LaneMask {
        // A sum is finite only if all of its terms are.
        let mut sum = Lanes::ZERO;
        for i in 0..S::N_COORDINATES {
            sum = sum + (q[i] + v[i] + p[i]);
        }
        // Of what is finite this is zero, of all else no number.
        let vanishing = sum * Lanes::ZERO;
        let mut failed = failed;
        if !LaneMask::is_everywhere_at_most(vanishing, Lanes::ZERO) {
            failed = active.without(LaneMask::at_most(vanishing, Lanes::ZERO)).or(failed);
        }
        if failed.is_any() {
            let taken = LaneMask::ALL.without(failed);
            blend(taken, &q, &mut self.q);
            blend(taken, &v, &mut self.v);
            blend(taken, &p, &mut self.p);
        } else {
            (self.q, self.v, self.p) = (q, v, p);
        }
        failed
    }

    /// Time.
    pub const fn t(&self) -> f64 {
        self.t
    }

    /// Configurations.
    pub const fn q(&self) -> &S::PerCoordinate<Lanes> {
        &self.q
    }

    /// Velocities.
    pub const fn v(&self) -> &S::PerCoordinate<Lanes> {
        &self.v
    }

    /// Momenta.
    pub const fn p(&self) -> &S::PerCoordinate<Lanes> {
        &self.p
    }
}
