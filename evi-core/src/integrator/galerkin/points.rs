//! Galerkin steps by passes over their points: first guesses, their rescue, and the end of a step.

use core::borrow::Borrow;

use super::NodePasses;
use crate::array::Array;
use crate::integrator::{StepError, Tally};
use crate::linear::unknowns;
use crate::mechanics::{
    Lost, Mechanics, NodeMotion, PointEnd, PointGuess, PointIteration, PointPasses, Points, ProjectionError,
    RoundOff, State, Sum,
};
use crate::memory::memory;
use crate::scalar::InstructionSet;
use crate::scheme::PAST;
use crate::system::MechanicalSystem;

/// The passes of a scene, with the past that they begin from.
pub(super) struct PointSteps<S: MechanicalSystem, const K: usize> {
    passes: PointPasses<S, K>,
    instructions: InstructionSet,
    /// What the last steps have found, the last one first. It affects the number of passes and the last bits of a state, nothing else.
    past: [NodeMotion<S>; PAST],
    /// How many of them are known.
    known: usize,
    h: f64,
}

impl<S: MechanicalSystem, const K: usize> PointSteps<S, K> {
    pub(super) fn new(mechanics: &Mechanics<S>, h: f64) -> Self {
        Self {
            passes: PointPasses::new(mechanics, h),
            instructions: InstructionSet::detect(),
            past: core::array::from_fn(|_| NodeMotion::rest()),
            known: 0,
            h,
        }
    }

    pub(super) const fn instruction_set(&self) -> InstructionSet {
        self.instructions
    }

    /// The points of the step that was taken last, if it was by passes.
    pub(super) fn found(&self) -> Option<Points<S, K>> {
        (self.known > 0).then(|| self.passes.points_found(self.h))
    }
}

impl<S: MechanicalSystem, const K: usize> NodePasses<S> for PointSteps<S, K> {
    type End = PointEnd<S>;

    fn solve(
        &mut self,
        mechanics: &Mechanics<S>,
        start: &State<S>,
        tally: &mut impl Tally,
    ) -> Option<PointEnd<S>> {
        let Self { passes, instructions, .. } = self;
        if self.known == PAST {
            let guess = PointGuess::Continued(&self.past);
            if let Ok(end) = instructions.run(PointIteration { passes, mechanics, start, guess }) {
                tally.count_corrections(end.passes);
                return Some(end);
            }
            tally.count_restart();
        }
        let at_start = mechanics.acceleration_with(start.t, &start.q, &start.v, &start.inputs).ok()?;
        let guess = PointGuess::Constant(&at_start);
        let end = instructions.run(PointIteration { passes, mechanics, start, guess }).ok()?;
        tally.count_corrections(end.passes);
        Some(end)
    }

    fn land<R: RoundOff<S>>(
        &mut self,
        mechanics: &Mechanics<S>,
        state: &mut State<S>,
        round_off: R,
        end: PointEnd<S>,
        tally: &mut impl Tally,
    ) -> Result<[Lost<S, R>; 2], StepError> {
        let t = state.t + self.h;
        let failed = |cause: ProjectionError| StepError::Projection { t, cause };
        let mut position = round_off.position(&state.q).plus(&end.difference);
        if S::N_CONSTRAINTS > 0 {
            let correction = {
                let value = position.value();
                let q: &S::PerCoordinate<f64> = value.borrow();
                let (residual, jacobian) = S::constraint_derivatives(&mechanics.constants, t, q);
                let (_, hessian) = S::lagrangian_derivatives(&mechanics.constants, t, q, &end.velocity);
                let kkt = mechanics
                    .mass_kkt(&hessian, &jacobian)
                    .factor()
                    .map_err(|matrix| failed(matrix.into()))?;
                let mut correction = unknowns::<S>(|_| 0.0, |c| -residual[c]);
                kkt.solve(&mut correction);
                correction
            };
            position = position.plus(&Array::from_fn(|i| correction[i]));
        }
        let (q, lost_q) = position.split();
        let mut momentum = round_off.momentum(&state.p).plus(&end.gain);
        let v = mechanics.project_momentum(t, &q, &mut momentum, end.velocity, tally).map_err(failed)?;
        let (p, lost_p) = momentum.split();
        state.replace(t, q, v, p)?;
        self.past.swap(0, 1);
        self.past[0].clone_from(&self.passes.found);
        self.known = PAST.min(self.known + 1);
        Ok([lost_q, lost_p])
    }

    #[inline]
    fn forget(&mut self) {
        self.known = 0;
    }
}

// The storage of the passes is written anew in every step.
memory!([S: MechanicalSystem, const K: usize] PointSteps<S, K>, |words|
    Self { passes: _, instructions: _, past, known, h: _ } => {
        for NodeMotion { velocities, multipliers } in past {
            words.lanes(velocities);
            words.lanes(multipliers);
        }
        words.index(known);
    }
);
