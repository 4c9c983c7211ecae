//! Eight members' steps of a kick, a drift and a kick with constraints: Newton's iteration on the multipliers alone, member by lane.
//!
//! In and out as of `integrator/multipliers`, whose iteration this is: one correction with the matrix `G₁ D G₀ᵀ` at the predicted end, a second where
//! a lane needs it, and Newton's iteration with fresh matrices for the lanes that this does not solve. Whatever a lane needs, it alone gets:
//! what is computed for a neighbour's sake is blended out, so that a member moves as it would in any other company.

use super::kicks::LaneKicks;
use super::lane_map::LaneMap;
use super::lane_matrix::LaneLu;
use super::lane_span::{Drift, LaneStep};
use super::lane_state::{LaneState, blend, nothing};
use super::mask::LaneMask;
use super::multiplier_search::{correct, iterate_apart};
use super::projection::project;
use crate::mechanics::{AsMass, Mechanics, State};
use crate::scalar::{LANES, Lanes};
use crate::system::MechanicalSystem;

/// The step of eight members, with the impulses that they have needed so far.
pub(super) struct MultiplierLanes<S: MechanicalSystem, K: LaneKicks<S>> {
    step: LaneStep<S, K>,
    history: History<S>,
    /// `G₁ D G₀ᵀ` and `G M⁻¹ Gᵀ` of scenes with many constraints; those of others need not leave the registers.
    chord: LaneLu<S>,
    gram: LaneLu<S>,
}

/// The impulses of the last steps.
struct History<S: MechanicalSystem> {
    /// What a cubic through the last four predicts.
    predicted: S::PerConstraint<Lanes>,
    /// Those of the last three, newest first.
    previous: [S::PerConstraint<Lanes>; 3],
}

impl<S: MechanicalSystem, K: LaneKicks<S>> MultiplierLanes<S, K> {
    pub(super) fn new(h: f64, mechanics: [&Mechanics<S>; LANES], members: [&K::Member; LANES]) -> Self {
        Self {
            step: LaneStep::new(h, mechanics, members),
            history: History { predicted: nothing(), previous: core::array::from_fn(|_| nothing()) },
            chord: LaneLu::new::<Drift<S, K>>(),
            gram: LaneLu::new::<AsMass>(),
        }
    }
}

impl<S: MechanicalSystem> History<S> {
    /// What the impulses at the end are near to: averages of the multipliers with the weights `1 − τ` and `τ`, those of steps belong to the times
    /// ⅓ h and ⅔ h.
    #[inline(always)]
    fn at_end<const FUSED: bool>(&self, impulse: &S::PerConstraint<Lanes>) -> S::PerConstraint<Lanes> {
        let mut expected: S::PerConstraint<Lanes> = nothing();
        for c in 0..S::N_CONSTRAINTS {
            let change = impulse[c] - self.previous[0][c];
            expected[c] = Lanes::splat(1.0 / 3.0).times_plus::<FUSED>(change, impulse[c]);
        }
        expected
    }

    /// Takes note of the impulses of a step.
    #[inline(always)]
    fn record<const FUSED: bool>(&mut self, impulse: &S::PerConstraint<Lanes>) {
        let (four, six) = (Lanes::splat(4.0), Lanes::splat(6.0));
        let [first, second, third] = &mut self.previous;
        for c in 0..S::N_CONSTRAINTS {
            let old = six.times_plus::<FUSED>(first[c], third[c]);
            self.predicted[c] = four.times_plus::<FUSED>(impulse[c] + second[c], -old);
            (third[c], second[c], first[c]) = (second[c], first[c], impulse[c]);
        }
    }
}

impl<S: MechanicalSystem, K: LaneKicks<S>> LaneMap<S> for MultiplierLanes<S, K> {
    #[inline(always)]
    fn advance<const FUSED: bool>(&mut self, state: &mut LaneState<S>, active: LaneMask) -> LaneMask {
        let Self { step, history, chord, gram } = self;
        let t_end = Lanes::splat(state.t + step.h);
        let constants = step.slopes.constants();
        let span = step.span::<FUSED>(state);
        if S::N_CONSTRAINTS == 0 {
            let mut q: S::PerCoordinate<Lanes> = nothing();
            for i in 0..S::N_COORDINATES {
                q[i] = state.q[i] + span.drifted[i];
            }
            let p = step.kicks.kicked_at_end::<FUSED>(constants, t_end, &q, &span.kicked);
            let v = step.legendre.velocity::<FUSED>(&p);
            return state.replace(q, v, p, active, LaneMask::NONE);
        }
        let (small_chord, small_gram) = (&mut LaneLu::small(), &mut LaneLu::small());
        let (chord, gram) = if LaneLu::<S>::IS_SMALL { (small_chord, small_gram) } else { (chord, gram) };
        let (mut ends, unsolved) = correct::<S, K, FUSED>(step, &span, &history.predicted, chord, active);
        let mut base = history.predicted.clone();
        let mut failed = LaneMask::NONE;
        if let Some(unsolved) = unsolved {
            let wanted = active.without(unsolved.solved);
            if wanted.is_any() {
                let (landed, found) =
                    iterate_apart(step, state, ends.impulse.clone(), wanted, unsolved.trusted);
                blend(wanted, &landed.q, &mut ends.q);
                blend(wanted, &landed.impulse, &mut ends.impulse);
                blend(wanted, &landed.pull, &mut ends.pull);
                blend(wanted, &landed.impulse, &mut base);
                failed = wanted.without(found);
            }
        }
        let mut momentum = span.kicked;
        for i in 0..S::N_COORDINATES {
            momentum[i] = momentum[i] - ends.pull[i];
        }
        let mut momentum = step.kicks.kicked_at_end::<FUSED>(constants, t_end, &ends.q, &momentum);
        let (_, jacobian) = S::constraint_derivatives(constants, t_end, &ends.q);
        let expected = step.slopes.pull::<FUSED>(&jacobian, &history.at_end::<FUSED>(&base));
        for i in 0..S::N_COORDINATES {
            momentum[i] = momentum[i] - expected[i];
        }
        step.slopes.gram::<_, FUSED>(&jacobian, &step.legendre.inverse_mass, &jacobian, gram);
        gram.factor::<FUSED>();
        let projected = project::<S, FUSED>(&step.slopes, &step.legendre, gram, &jacobian, momentum, active);
        history.record::<FUSED>(&ends.impulse);
        state.replace(ends.q, projected.v, projected.p, active, failed)
    }

    fn forget(&mut self, lane: usize, _mechanics: &Mechanics<S>, _state: &State<S>) {
        let History { predicted, previous } = &mut self.history;
        for c in 0..S::N_CONSTRAINTS {
            predicted[c] = predicted[c].with(lane, 0.0);
            for impulses in previous.iter_mut() {
                impulses[c] = impulses[c].with(lane, 0.0);
            }
        }
    }
}
