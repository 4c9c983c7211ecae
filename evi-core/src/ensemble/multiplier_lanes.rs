//! Eight members' steps of a kick, a drift and a kick with constraints: Newton's iteration on the multipliers alone, member by lane.
//!
//! In and out as of `integrator/multipliers`, whose iteration this is: one correction with the matrix `G₁ D G₀ᵀ` at the predicted end, a second where
//! a lane needs it, and Newton's iteration with fresh matrices for the lanes that this does not solve. Whatever a lane needs, it alone gets:
//! what is computed for a neighbour's sake is blended out, so that a member moves as it would in any other company.

use super::kicks::{LaneKicks, LaneLegendre};
use super::lane_map::LaneMap;
use super::lane_matrix::{LaneLu, LaneMatrix, Slopes};
use super::lane_state::{LaneState, blend, nothing, side_by_side};
use super::mask::LaneMask;
use super::projection::project;
use crate::integrator::TRUSTED;
use crate::mechanics::{AsMass, KickDriftKick, Mechanics, State};
use crate::newton;
use crate::scalar::{InstructionSet, LANES, LaneOperation, Lanes, Scalar};
use crate::system::MechanicalSystem;

/// The step of eight members, with the impulses that they have needed so far.
pub(super) struct MultiplierLanes<S: MechanicalSystem, K: LaneKicks<S>> {
    h: f64,
    slopes: Slopes<S>,
    kicks: K,
    drift: LaneMatrix<S, Drift<S, K>>,
    legendre: LaneLegendre<S>,
    /// `G₁ D G₀ᵀ`.
    chord: LaneLu<S>,
    /// `G M⁻¹ Gᵀ`.
    gram: LaneLu<S>,
    /// What a cubic through the last four impulses predicts.
    predicted: S::PerConstraint<Lanes>,
    /// Impulses of the last three steps, newest first.
    previous: [S::PerConstraint<Lanes>; 3],
    instructions: InstructionSet,
}

/// What the drift of a step couples.
type Drift<S, K> = <<K as LaneKicks<S>>::Member as KickDriftKick<S>>::Coupling;

/// Eight steps as functions of their impulses.
struct Span<S: MechanicalSystem> {
    end: Lanes,
    /// `q₀`.
    start: S::PerCoordinate<Lanes>,
    /// `D p½`, without constraint forces.
    drifted: S::PerCoordinate<Lanes>,
    /// Varying entries of `G₀`.
    jacobian: S::PerJacobianEntry<Lanes>,
}

/// Ends of steps with their impulses.
struct Ends<S: MechanicalSystem> {
    q: S::PerCoordinate<Lanes>,
    impulse: S::PerConstraint<Lanes>,
    /// `G₀ᵀ ℓ`.
    pull: S::PerCoordinate<Lanes>,
}

impl<S: MechanicalSystem> Span<S> {
    #[inline(always)]
    fn copy(&self) -> Self {
        let Self { end, start, drifted, jacobian } = self;
        Self { end: *end, start: start.clone(), drifted: drifted.clone(), jacobian: jacobian.clone() }
    }
}

impl<S: MechanicalSystem> Ends<S> {
    #[inline(always)]
    fn copy(&self) -> Self {
        let Self { q, impulse, pull } = self;
        Self { q: q.clone(), impulse: impulse.clone(), pull: pull.clone() }
    }
}

impl<S: MechanicalSystem, K: LaneKicks<S>> MultiplierLanes<S, K> {
    pub(super) fn new(h: f64, mechanics: [&Mechanics<S>; LANES], members: [&K::Member; LANES]) -> Self {
        let constants = side_by_side(|lane, i| mechanics[lane].constants[i]);
        Self {
            h,
            slopes: Slopes::new(constants),
            kicks: K::of(members),
            drift: LaneMatrix::of(members.map(|member| member.drift())),
            legendre: LaneLegendre::of(members.map(|member| member.legendre())),
            chord: LaneLu::new::<Drift<S, K>>(),
            gram: LaneLu::new::<AsMass>(),
            predicted: nothing(),
            previous: core::array::from_fn(|_| nothing()),
            instructions: InstructionSet::detect(),
        }
    }

    /// `q₁(ℓ) = q₀ − D G₀ᵀ ℓ + D p½`, with `G₀ᵀ ℓ`.
    #[inline(always)]
    fn end<const FUSED: bool>(&self, span: &Span<S>, impulse: S::PerConstraint<Lanes>) -> Ends<S> {
        let pull = self.slopes.pull::<FUSED>(&span.jacobian, &impulse);
        let moved = self.drift.times::<FUSED>(&pull);
        let mut q: S::PerCoordinate<Lanes> = nothing();
        for i in 0..S::N_COORDINATES {
            q[i] = (span.start[i] - moved[i]) + span.drifted[i];
        }
        Ends { q, impulse, pull }
    }

    /// Corrects the predicted impulses; returns the ends that they lead to, and where not all lanes are solved so, those that are, and those whose
    /// prediction is near enough to be followed.
    #[inline(always)]
    fn attempt<const FUSED: bool>(
        &mut self,
        span: &Span<S>,
        active: LaneMask,
    ) -> (Ends<S>, Option<[LaneMask; 2]>) {
        let mut ends = self.end::<FUSED>(span, self.predicted.clone());
        let (first, jacobian) = S::constraint_derivatives(self.slopes.constants(), span.end, &ends.q);
        self.slopes.gram::<_, FUSED>(&jacobian, &self.drift, &span.jacobian, &mut self.chord);
        let mut displacement: S::PerConstraint<Lanes> = nothing();
        let mut are_all_trusted = true;
        for c in 0..S::N_CONSTRAINTS {
            displacement[c] = (self.chord.diagonal(c) * self.predicted[c]).abs();
            let trusted = Lanes::splat(TRUSTED) * displacement[c];
            are_all_trusted &= LaneMask::is_everywhere_at_most(first[c].abs(), trusted);
        }
        self.chord.factor::<FUSED>();
        let mut correction = first.clone();
        self.chord.solve::<FUSED>(&mut correction);
        let unsolved = if const { S::STRUCTURE.has_quadratic_constraints() } {
            let reach = self.slopes.along::<FUSED>(&jacobian, &ends.q);
            // φ(q − d) − φ(q) + G d = ½ dᵀ φ_qq d, exactly.
            let remainder = |moved: &S::PerCoordinate<Lanes>| {
                let mut half = S::constraint_curvature(self.slopes.constants(), span.end, &ends.q, moved);
                for c in 0..S::N_CONSTRAINTS {
                    half[c] = Lanes::splat(0.5) * half[c];
                }
                half
            };
            let mut pull = self.slopes.pull::<FUSED>(&span.jacobian, &correction);
            let mut moved = self.drift.times::<FUSED>(&pull);
            let second = remainder(&moved);
            let mut unsolved = None;
            if !is_round_off_everywhere::<S>(&second, &reach) {
                let wanted = active.without(round_off::<S>(&second, &reach));
                let mut next = second.clone();
                self.chord.solve::<FUSED>(&mut next);
                for c in 0..S::N_CONSTRAINTS {
                    correction[c] = correction[c] + wanted.select(next[c], Lanes::ZERO);
                }
                pull = self.slopes.pull::<FUSED>(&span.jacobian, &correction);
                moved = self.drift.times::<FUSED>(&pull);
                let mut left = remainder(&moved);
                for c in 0..S::N_CONSTRAINTS {
                    left[c] = wanted.select(left[c] - second[c], Lanes::ZERO);
                }
                if !is_round_off_everywhere::<S>(&left, &reach) {
                    unsolved = Some(active.without(round_off::<S>(&left, &reach)));
                }
            }
            for i in 0..S::N_COORDINATES {
                ends.q[i] = ends.q[i] - moved[i];
                ends.pull[i] = ends.pull[i] + pull[i];
            }
            unsolved
        } else {
            let moved = self.drift.times::<FUSED>(&self.slopes.pull::<FUSED>(&span.jacobian, &correction));
            for i in 0..S::N_COORDINATES {
                ends.q[i] = ends.q[i] - moved[i];
            }
            let second = S::constraints(self.slopes.constants(), span.end, &ends.q);
            let mut next = second.clone();
            self.chord.solve::<FUSED>(&mut next);
            for c in 0..S::N_CONSTRAINTS {
                correction[c] = correction[c] + next[c];
            }
            let moved = self.drift.times::<FUSED>(&self.slopes.pull::<FUSED>(&span.jacobian, &next));
            let pull = self.slopes.pull::<FUSED>(&span.jacobian, &correction);
            for i in 0..S::N_COORDINATES {
                ends.q[i] = ends.q[i] - moved[i];
                ends.pull[i] = ends.pull[i] + pull[i];
            }
            Some(active.without(predict_round_off::<S>(&second, &first, &displacement)))
        };
        for c in 0..S::N_CONSTRAINTS {
            ends.impulse[c] = ends.impulse[c] + correction[c];
        }
        if are_all_trusted && unsolved.is_none() {
            return (ends, None);
        }
        let mut trusted = LaneMask::ALL;
        for c in 0..S::N_CONSTRAINTS {
            trusted = trusted.and(LaneMask::at_most(first[c].abs(), Lanes::splat(TRUSTED) * displacement[c]));
        }
        let solved = LaneMask::ALL.without(unsolved.unwrap_or(LaneMask::NONE)).and(trusted);
        (ends, Some([solved, trusted]))
    }

    /// Newton's iteration with a fresh matrix for every correction, of the lanes `wanted`: from the impulses of `ends` where they are `trusted`, from
    /// none elsewhere. Overwrites these lanes of `ends` and returns those that are found.
    #[inline(always)]
    fn iterate<const FUSED: bool>(
        &mut self,
        span: &Span<S>,
        ends: &mut Ends<S>,
        wanted: LaneMask,
        trusted: LaneMask,
    ) -> LaneMask {
        let mut impulse: S::PerConstraint<Lanes> = nothing();
        blend(trusted, &ends.impulse, &mut impulse);
        let mut previous: S::PerConstraint<Lanes> = nothing();
        let mut last_length = Lanes::ZERO;
        let (mut pending, mut found) = (wanted, LaneMask::NONE);
        for _ in 0..newton::MAX_CORRECTIONS {
            let at = self.end::<FUSED>(span, impulse.clone());
            let (residual, jacobian) = S::constraint_derivatives(self.slopes.constants(), span.end, &at.q);
            self.slopes.gram::<_, FUSED>(&jacobian, &self.drift, &span.jacobian, &mut self.chord);
            self.chord.factor::<FUSED>();
            let mut correction = residual.clone();
            self.chord.solve::<FUSED>(&mut correction);
            let mut reach: S::PerCoordinate<Lanes> = nothing();
            for i in 0..S::N_COORDINATES {
                reach[i] = span.start[i].abs() + span.drifted[i].abs() + at.q[i].abs();
            }
            let scale = self.slopes.scale(&span.jacobian, &reach);
            let mut length = Lanes::ZERO;
            for c in 0..S::N_CONSTRAINTS {
                length = length + residual[c].abs() / scale[c];
                let corrected = impulse[c] + correction[c];
                impulse[c] = pending.select(corrected, impulse[c]);
            }
            let stagnates = LaneMask::at_most(length, Lanes::splat(newton::STAGNATION))
                .and(LaneMask::below(Lanes::splat(newton::STAGNATION_RATIO) * last_length, length))
                .and(LaneMask::below(Lanes::ZERO, last_length));
            let done = predict_round_off::<S>(&residual, &previous, &scale).or(stagnates).and(pending);
            // What is no number never becomes one.
            let finite = LaneMask::below(length * Lanes::ZERO, Lanes::splat(1.0));
            (previous, last_length) = (residual, length);
            found = found.or(done);
            pending = pending.without(done).and(finite);
            if !pending.is_any() {
                break;
            }
        }
        let landed = self.end::<FUSED>(span, impulse);
        blend(wanted, &landed.q, &mut ends.q);
        blend(wanted, &landed.impulse, &mut ends.impulse);
        blend(wanted, &landed.pull, &mut ends.pull);
        found
    }
}

/// Newton's iteration, as an operation on lanes.
struct Iterate<'a, S: MechanicalSystem, K: LaneKicks<S>> {
    map: &'a mut MultiplierLanes<S, K>,
    span: &'a Span<S>,
    ends: &'a mut Ends<S>,
    wanted: LaneMask,
    trusted: LaneMask,
}

impl<S: MechanicalSystem, K: LaneKicks<S>> LaneOperation for Iterate<'_, S, K> {
    type Output = LaneMask;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> LaneMask {
        self.map.iterate::<FUSED>(self.span, self.ends, self.wanted, self.trusted)
    }
}

/// Apart from the way that most steps take; returns the lanes that are found, and the ends.
#[cold]
#[inline(never)]
fn iterate_apart<S: MechanicalSystem, K: LaneKicks<S>>(
    map: &mut MultiplierLanes<S, K>,
    span: Span<S>,
    mut ends: Ends<S>,
    wanted: LaneMask,
    trusted: LaneMask,
) -> (LaneMask, Ends<S>) {
    let instructions = map.instructions;
    let found = instructions.run(Iterate { map, span: &span, ends: &mut ends, wanted, trusted });
    (found, ends)
}

/// Whether residuals are round-off of terms as large as `reach`, in every lane.
#[inline(always)]
fn is_round_off_everywhere<S: MechanicalSystem>(
    left: &S::PerConstraint<Lanes>,
    reach: &S::PerConstraint<Lanes>,
) -> bool {
    let mut all = true;
    for c in 0..S::N_CONSTRAINTS {
        let target = Lanes::splat(newton::TARGET) * reach[c].abs();
        all &= LaneMask::is_everywhere_at_most(left[c].abs(), target);
    }
    all
}

/// Where they are.
#[inline(always)]
fn round_off<S: MechanicalSystem>(
    left: &S::PerConstraint<Lanes>,
    reach: &S::PerConstraint<Lanes>,
) -> LaneMask {
    let mut all = LaneMask::ALL;
    for c in 0..S::N_CONSTRAINTS {
        let target = Lanes::splat(newton::TARGET) * reach[c].abs();
        all = all.and(LaneMask::at_most(left[c].abs(), target));
    }
    all
}

/// Where `newton::predicts_round_off` holds for every constraint.
#[inline(always)]
fn predict_round_off<S: MechanicalSystem>(
    residual: &S::PerConstraint<Lanes>,
    previous: &S::PerConstraint<Lanes>,
    scale: &S::PerConstraint<Lanes>,
) -> LaneMask {
    let mut all = LaneMask::ALL;
    for c in 0..S::N_CONSTRAINTS {
        let target = Lanes::splat(newton::TARGET) * scale[c].abs();
        let denominator = previous[c].abs().larger(target);
        let square = residual[c] * residual[c];
        let is_zero = LaneMask::at_most(residual[c].abs(), Lanes::ZERO);
        all = all.and(LaneMask::below(square, target * denominator).or(is_zero));
    }
    all
}

impl<S: MechanicalSystem, K: LaneKicks<S>> LaneMap<S> for MultiplierLanes<S, K> {
    #[inline(always)]
    fn advance<const FUSED: bool>(&mut self, state: &mut LaneState<S>, active: LaneMask) -> LaneMask {
        let (t, t_end) = (Lanes::splat(state.t), Lanes::splat(state.t + self.h));
        let constants = self.slopes.constants();
        let kicked = self.kicks.kicked_at_start::<FUSED>(constants, t, &state.q, &state.p);
        let drifted = self.drift.times::<FUSED>(&kicked);
        if S::N_CONSTRAINTS == 0 {
            let mut q: S::PerCoordinate<Lanes> = nothing();
            for i in 0..S::N_COORDINATES {
                q[i] = state.q[i] + drifted[i];
            }
            let p = self.kicks.kicked_at_end::<FUSED>(constants, t_end, &q, &kicked);
            let v = self.legendre.velocity::<FUSED>(&p);
            return state.replace(q, v, p, active, LaneMask::NONE);
        }
        let (_, jacobian) = S::constraint_derivatives(constants, t, &state.q);
        let span = Span { end: t_end, start: state.q.clone(), drifted, jacobian };
        let (mut ends, rest) = self.attempt::<FUSED>(&span, active);
        let mut base = self.predicted.clone();
        let mut failed = LaneMask::NONE;
        if let Some([solved, trusted]) = rest {
            let wanted = active.without(solved);
            if wanted.is_any() {
                // By copies, so that on the way of most steps nothing lies in memory for this one's sake.
                let (found, landed) = iterate_apart(self, span.copy(), ends.copy(), wanted, trusted);
                ends = landed;
                failed = wanted.without(found);
                blend(wanted, &ends.impulse, &mut base);
            }
        }
        let Ends { q, impulse, pull } = ends;
        let mut momentum = kicked;
        for i in 0..S::N_COORDINATES {
            momentum[i] = momentum[i] - pull[i];
        }
        let constants = self.slopes.constants();
        let mut momentum = self.kicks.kicked_at_end::<FUSED>(constants, t_end, &q, &momentum);
        let (_, jacobian) = S::constraint_derivatives(constants, t_end, &q);
        // Averages of the multipliers with the weights `1 − τ` and `τ`, the impulses belong to the times ⅓ h and ⅔ h.
        let mut expected: S::PerConstraint<Lanes> = nothing();
        for c in 0..S::N_CONSTRAINTS {
            let change = base[c] - self.previous[0][c];
            expected[c] = Lanes::splat(1.0 / 3.0).times_plus::<FUSED>(change, base[c]);
        }
        let expected = self.slopes.pull::<FUSED>(&jacobian, &expected);
        for i in 0..S::N_COORDINATES {
            momentum[i] = momentum[i] - expected[i];
        }
        self.slopes.gram::<_, FUSED>(&jacobian, &self.legendre.inverse_mass, &jacobian, &mut self.gram);
        self.gram.factor::<FUSED>();
        let projected =
            project::<S, FUSED>(&self.slopes, &self.legendre, &self.gram, &jacobian, momentum, active);
        let [first, second, third] = &self.previous;
        for c in 0..S::N_CONSTRAINTS {
            let (four, six) = (Lanes::splat(4.0), Lanes::splat(6.0));
            let old = six.times_plus::<FUSED>(first[c], third[c]);
            self.predicted[c] = four.times_plus::<FUSED>(impulse[c] + second[c], -old);
        }
        self.previous = [impulse, first.clone(), second.clone()];
        state.replace(q, projected.v, projected.p, active, failed)
    }

    fn forget(&mut self, lane: usize, _mechanics: &Mechanics<S>, _state: &State<S>) {
        for c in 0..S::N_CONSTRAINTS {
            self.predicted[c] = self.predicted[c].with(lane, 0.0);
            for impulses in &mut self.previous {
                impulses[c] = impulses[c].with(lane, 0.0);
            }
        }
    }
}
