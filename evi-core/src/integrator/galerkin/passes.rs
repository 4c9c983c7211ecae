//! Galerkin steps by passes over all nodes, a node per lane: first guesses, their rescue, and the end of a step.

use core::borrow::Borrow;

use super::NodePasses;
use crate::array::Array;
use crate::integrator::{StepError, Tally};
use crate::linear::{Factorization, largest_magnitude};
use crate::mechanics::{
    ConstantLegendre, FirstGuess, LaneEnd, LaneStep, Lost, Mechanics, Passes, Points, ProjectionError,
    RoundOff, State, Sum,
};
use crate::memory::memory;
use crate::scalar::{InstructionSet, Lanes};
use crate::scheme::PAST;
use crate::system::MechanicalSystem;

/// Ends are on the constraints to round-off, by passes that stop early nearly so. What is farther beside them than this share of their terms belongs to passes that
/// have lost digits, as of masses whose sum is the heavier one.
const OFF: f64 = 1e-12;
const OFF_IF_ROUGH: f64 = 1e-6;
/// Ends are on the hidden constraints to round-off, where these are nearly dependent less so. What is farther beside them than this share has been projected with a
/// matrix that does not determine it.
const BESIDE: f64 = 1e-3;
/// Velocities that leave the constraints by more than this share are projected once more: the matrix is that of the end before its last displacement, which
/// in a motion that diverges is long.
const REST: f64 = 64.0 * f64::EPSILON;
/// Ends whose passes stop at more than this are projected twice: what the first projection leaves is the square of it.
pub(crate) const ROUGH: f64 = 1e-8;
/// Of the configuration, a length far above round-off and far below a step.
const SLIGHT: f64 = 1e-10;

/// The passes of a scene, with the past that they begin from.
pub(super) struct LanePasses<S: MechanicalSystem, const K: usize> {
    step: LaneStep<S, K>,
    instructions: InstructionSet,
    /// The ways of the last steps, the last one first. They affect the number of passes and what a state has below their tolerance,
    /// nothing else.
    past: [S::PerCoordinate<Lanes>; PAST],
    /// How many of them are known.
    known: usize,
    h: f64,
    /// Relative length of a last correction.
    tolerance: f64,
}

impl<S: MechanicalSystem, const K: usize> LanePasses<S, K> {
    /// Whether the scene's steps can be solved so.
    pub(super) const EXIST: bool = LaneStep::<S, K>::EXISTS;

    /// `None` if the mass matrix is not positive definite: the passes eliminate without pivoting.
    pub(super) fn new(mechanics: &Mechanics<S>, h: f64, tolerance: f64) -> Option<Self> {
        Some(Self {
            step: LaneStep::new(mechanics, h, tolerance)?,
            tolerance,
            instructions: InstructionSet::detect(),
            past: core::array::from_fn(|_| Array::filled(Lanes::ZERO)),
            known: 0,
            h,
        })
    }

    pub(super) const fn instruction_set(&self) -> InstructionSet {
        self.instructions
    }

    pub(super) const fn legendre(&self) -> &ConstantLegendre<S> {
        &self.step.legendre
    }

    /// The points of the step from `start` to `end` that was taken last, if it was by passes, and its `p⁻`.
    pub(super) fn found(
        &self,
        mechanics: &Mechanics<S>,
        start: &State<S>,
        end: &State<S>,
    ) -> Option<(Points<S, K>, S::PerCoordinate<f64>)> {
        (self.known > 0).then(|| {
            let gain = self.step.momentum_gain(mechanics, (start, end.t), &end.q);
            (self.step.points_found(start, self.h), Array::from_fn(|i| start.p[i] + gain[i]))
        })
    }

    /// The end of the step without a past.
    #[cold]
    fn begin(
        &mut self,
        mechanics: &Mechanics<S>,
        start: &State<S>,
        tally: &mut impl Tally,
    ) -> Option<LaneEnd<S>> {
        let at_start = mechanics.acceleration_with(start.t, &start.q, &start.v, &start.inputs).ok()?;
        let first = FirstGuess::Constant(&at_start.acceleration);
        let end = self.instructions.run(Passes { step: &mut self.step, start, first }).ok()?;
        tally.count_corrections(end.passes);
        Some(end)
    }
}

impl<S: MechanicalSystem, const K: usize> NodePasses<S> for LanePasses<S, K> {
    type End = LaneEnd<S>;

    #[inline]
    fn solve(
        &mut self,
        mechanics: &Mechanics<S>,
        start: &State<S>,
        tally: &mut impl Tally,
    ) -> Option<LaneEnd<S>> {
        if self.known == PAST {
            let first = FirstGuess::Continued(&self.past);
            if let Ok(end) = self.instructions.run(Passes { step: &mut self.step, start, first }) {
                tally.count_corrections(end.passes);
                return Some(end);
            }
            tally.count_restart();
        }
        self.begin(mechanics, start, tally)
    }

    #[inline]
    fn land<R: RoundOff<S>>(
        &mut self,
        mechanics: &Mechanics<S>,
        state: &mut State<S>,
        round_off: R,
        end: LaneEnd<S>,
        tally: &mut impl Tally,
    ) -> Result<[Lost<S, R>; 2], StepError> {
        let t = state.t + self.h;
        let constants = &mechanics.constants;
        let legendre = &self.step.legendre;
        let mut position = round_off.position(&state.q).plus(&end.difference);
        let (mut shares, jacobian) = S::constraint_derivatives(constants, t, position.value().borrow());
        let gram = legendre
            .factor_gram(mechanics, &jacobian, tally)
            .map_err(|cause| StepError::Projection { t, cause: ProjectionError::Singular(cause) })?;
        gram.solve(&mut shares);
        let mut pull = S::PerCoordinate::<f64>::filled(0.0);
        mechanics.subtract_constraint_force(&jacobian, &shares, &mut pull);
        position = position.plus(&self.step.inverse_mass_times(&pull));
        if self.tolerance > ROUGH {
            let mut shares = S::constraints(constants, t, position.value().borrow());
            gram.solve(&mut shares);
            let mut pull = S::PerCoordinate::<f64>::filled(0.0);
            mechanics.subtract_constraint_force(&jacobian, &shares, &mut pull);
            position = position.plus(&self.step.inverse_mass_times(&pull));
        }
        let (q, lost_q) = position.split();
        let (left, jacobian) = S::constraint_derivatives(constants, t, &q);
        let gain = self.step.momentum_gain(mechanics, (state, t), &q);
        let momentum = round_off.momentum(&state.p).plus(&gain);
        let unexpected = S::PerConstraint::<f64>::filled(0.0);
        let (mut v, mut momentum) = legendre.project(mechanics, &gram, &jacobian, &unexpected, momentum);
        // Round-off of the whole configuration passes, also where the constraint's own coordinates are zero, or at rest.
        let slight = SLIGHT * largest_magnitude(q.as_ref().iter().copied());
        let reach = Array::from_fn(|i| q[i].abs() + end.difference[i].abs() + slight);
        let speeds = Array::from_fn(|i| v[i].abs() + (end.difference[i].abs() + slight) / self.h.abs());
        let leaving = |v: &S::PerCoordinate<f64>| {
            mechanics.share_beside(&jacobian, &speeds, &mechanics.constraint_rate(&jacobian, v))
        };
        let mut rate = leaving(&v);
        if rate > REST {
            (v, momentum) = legendre.project(mechanics, &gram, &jacobian, &unexpected, momentum);
            rate = leaving(&v);
        }
        let off = if self.tolerance > ROUGH { OFF_IF_ROUGH } else { OFF };
        for (beside, most) in [(mechanics.share_beside(&jacobian, &reach, &left), off), (rate, BESIDE)] {
            // Written so that a NaN is refused.
            let is_on_constraints = beside <= most;
            if !is_on_constraints {
                let cause = ProjectionError::NotConverged { corrections: 1, last_correction: beside };
                return Err(StepError::Projection { t, cause });
            }
        }
        let (p, lost_p) = momentum.split();
        state.replace(t, q, v, p)?;
        self.past.swap(0, 1);
        self.past[0].clone_from(&self.step.ways);
        self.known = PAST.min(self.known + 1);
        Ok([lost_q, lost_p])
    }

    #[inline]
    fn forget(&mut self) {
        self.known = 0;
    }
}

// The storage of the passes is written anew in every step.
memory!([S: MechanicalSystem, const K: usize] LanePasses<S, K>, |words|
    Self { step: _, instructions: _, past, known, h: _, tolerance } => {
        words.fixed(*tolerance);
        for ways in past {
            words.lanes(ways);
        }
        words.index(known);
    }
);
