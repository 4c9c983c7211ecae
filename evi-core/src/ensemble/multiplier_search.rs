//! The impulses that lead eight members to their constraints: corrections of the predicted ones, and Newton's iteration where they do not suffice.

use super::kicks::LaneKicks;
use super::lane_matrix::LaneLu;
use super::lane_span::{Drift, Ends, LaneStep, Span};
use super::lane_state::{LaneState, blend, nothing};
use super::mask::LaneMask;
use crate::integrator::TRUSTED;
use crate::newton;
use crate::scalar::{LaneOperation, Lanes, Scalar};
use crate::system::MechanicalSystem;

/// What a correction has not solved.
pub(super) struct Unsolved {
    /// Lanes that are solved.
    pub(super) solved: LaneMask,
    /// Lanes whose prediction is near enough to be followed.
    pub(super) trusted: LaneMask,
}

/// Corrects the `predicted` impulses; returns the ends that they lead to, and what is left where not every lane is solved so.
#[inline(always)]
pub(super) fn correct<S: MechanicalSystem, K: LaneKicks<S>, const FUSED: bool>(
    step: &LaneStep<S, K>,
    span: &Span<'_, S>,
    predicted: &S::PerConstraint<Lanes>,
    chord: &mut LaneLu<S>,
    active: LaneMask,
) -> (Ends<S>, Option<Unsolved>) {
    let mut ends = step.end::<FUSED>(span, predicted.clone());
    let (first, jacobian) = step.constraints(span, &ends.q);
    step.slopes.gram::<_, FUSED>(&jacobian, &step.drift, &span.jacobian, chord);
    let mut displacement: S::PerConstraint<Lanes> = nothing();
    let mut are_all_trusted = true;
    for c in 0..S::N_CONSTRAINTS {
        displacement[c] = (chord.diagonal(c) * predicted[c]).abs();
        let trusted = Lanes::splat(TRUSTED) * displacement[c];
        are_all_trusted &= LaneMask::is_everywhere_at_most(first[c].abs(), trusted);
    }
    chord.factor::<FUSED>();
    let mut correction = first.clone();
    chord.solve::<FUSED>(&mut correction);
    let mut pull = step.slopes.pull::<FUSED>(&span.jacobian, &correction);
    let mut moved = step.drift.times::<FUSED>(&pull);
    let unsolved = if const { S::STRUCTURE.has_quadratic_constraints() } {
        let allowed = step.twice_round_off::<FUSED>(&jacobian, &ends.q);
        // φ(q − d) − φ(q) + G d = ½ dᵀ φ_qq d, exactly.
        let twice_left = |moved: &S::PerCoordinate<Lanes>| {
            S::constraint_curvature(step.slopes.constants(), Lanes::splat(span.end), &ends.q, moved)
        };
        let second = twice_left(&moved);
        let mut unsolved = None;
        if !is_small_everywhere::<S>(&second, &allowed) {
            let wanted = active.without(small::<S>(&second, &allowed));
            let mut next: S::PerConstraint<Lanes> = nothing();
            for c in 0..S::N_CONSTRAINTS {
                next[c] = Lanes::splat(0.5) * second[c];
            }
            chord.solve::<FUSED>(&mut next);
            for c in 0..S::N_CONSTRAINTS {
                correction[c] = correction[c] + wanted.select(next[c], Lanes::ZERO);
            }
            pull = step.slopes.pull::<FUSED>(&span.jacobian, &correction);
            moved = step.drift.times::<FUSED>(&pull);
            let mut left = twice_left(&moved);
            for c in 0..S::N_CONSTRAINTS {
                left[c] = wanted.select(left[c] - second[c], Lanes::ZERO);
            }
            if !is_small_everywhere::<S>(&left, &allowed) {
                unsolved = Some(active.without(small::<S>(&left, &allowed)));
            }
        }
        unsolved
    } else {
        let mut there = ends.q.clone();
        for i in 0..S::N_COORDINATES {
            there[i] = there[i] - moved[i];
        }
        let second = S::constraints(step.slopes.constants(), Lanes::splat(span.end), &there);
        let mut next = second.clone();
        chord.solve::<FUSED>(&mut next);
        for c in 0..S::N_CONSTRAINTS {
            correction[c] = correction[c] + next[c];
        }
        let further = step.drift.times::<FUSED>(&step.slopes.pull::<FUSED>(&span.jacobian, &next));
        pull = step.slopes.pull::<FUSED>(&span.jacobian, &correction);
        for i in 0..S::N_COORDINATES {
            moved[i] = moved[i] + further[i];
        }
        Some(active.without(predict_round_off::<S>(&second, &first, &displacement)))
    };
    for i in 0..S::N_COORDINATES {
        ends.q[i] = ends.q[i] - moved[i];
        ends.pull[i] = ends.pull[i] + pull[i];
    }
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
    (ends, Some(Unsolved { solved, trusted }))
}

/// Newton's iteration with a fresh matrix for every correction, of the lanes `wanted`: from the `nearby` impulses where they are `trusted`, from
/// none elsewhere. Returns the ends, and the lanes that are found.
#[inline(always)]
fn iterate<S: MechanicalSystem, K: LaneKicks<S>, const FUSED: bool>(
    step: &LaneStep<S, K>,
    state: &LaneState<S>,
    nearby: &S::PerConstraint<Lanes>,
    wanted: LaneMask,
    trusted: LaneMask,
    chord: &mut LaneLu<S>,
) -> (Ends<S>, LaneMask) {
    let span = step.span::<FUSED>(state);
    let mut impulse: S::PerConstraint<Lanes> = nothing();
    blend(trusted, nearby, &mut impulse);
    let mut previous: S::PerConstraint<Lanes> = nothing();
    let mut last_length = Lanes::ZERO;
    let (mut pending, mut found) = (wanted, LaneMask::NONE);
    for _ in 0..newton::MAX_CORRECTIONS {
        let at = step.end::<FUSED>(&span, impulse.clone());
        let (residual, jacobian) = step.constraints(&span, &at.q);
        step.slopes.gram::<_, FUSED>(&jacobian, &step.drift, &span.jacobian, chord);
        chord.factor::<FUSED>();
        let mut correction = residual.clone();
        chord.solve::<FUSED>(&mut correction);
        let mut reach: S::PerCoordinate<Lanes> = nothing();
        for i in 0..S::N_COORDINATES {
            reach[i] = span.start[i].abs() + span.drifted[i].abs() + at.q[i].abs();
        }
        let scale = step.slopes.scale(&span.jacobian, &reach);
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
    (step.end::<FUSED>(&span, impulse), found)
}

/// Newton's iteration, as an operation on lanes.
struct Iterate<'a, S: MechanicalSystem, K: LaneKicks<S>> {
    step: &'a LaneStep<S, K>,
    state: &'a LaneState<S>,
    nearby: &'a S::PerConstraint<Lanes>,
    wanted: LaneMask,
    trusted: LaneMask,
    chord: &'a mut LaneLu<S>,
}

impl<S: MechanicalSystem, K: LaneKicks<S>> LaneOperation for Iterate<'_, S, K> {
    type Output = (Ends<S>, LaneMask);

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> Self::Output {
        let Self { step, state, nearby, wanted, trusted, chord } = self;
        iterate::<S, K, FUSED>(step, state, nearby, wanted, trusted, chord)
    }
}

/// [`iterate`] apart from the way that most steps take. `nearby` comes by value, so that on that way it lies in no memory.
#[cold]
#[inline(never)]
pub(super) fn iterate_apart<S: MechanicalSystem, K: LaneKicks<S>>(
    step: &LaneStep<S, K>,
    state: &LaneState<S>,
    nearby: S::PerConstraint<Lanes>,
    wanted: LaneMask,
    trusted: LaneMask,
) -> (Ends<S>, LaneMask) {
    let chord = &mut LaneLu::new::<Drift<S, K>>();
    step.instructions.run(Iterate { step, state, nearby: &nearby, wanted, trusted, chord })
}

/// Whether what is left is no more than `allowed`, in every lane.
#[inline(always)]
fn is_small_everywhere<S: MechanicalSystem>(
    left: &S::PerConstraint<Lanes>,
    allowed: &S::PerConstraint<Lanes>,
) -> bool {
    let mut all = true;
    for c in 0..S::N_CONSTRAINTS {
        all &= LaneMask::is_everywhere_at_most(left[c].abs(), allowed[c]);
    }
    all
}

/// Where it is.
#[inline(always)]
fn small<S: MechanicalSystem>(left: &S::PerConstraint<Lanes>, allowed: &S::PerConstraint<Lanes>) -> LaneMask {
    let mut all = LaneMask::ALL;
    for c in 0..S::N_CONSTRAINTS {
        all = all.and(LaneMask::at_most(left[c].abs(), allowed[c]));
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
