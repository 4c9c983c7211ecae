//! Gauss integrators: order `2K` in one step for scenes without constraints, whatever their mass depends on.

mod newton;

use super::{Compensable, CompensableStep, Iteration, OneStep, Scheme, StepError, Symmetric, Tally};
use crate::array::Array;
use crate::mechanics::{
    Dropped, GaussEnd, GaussGuess, GaussPasses, Lost, LostDigits, Mechanics, RoundOff, State, Sum,
};
use crate::memory::memory;
use crate::scalar::{InstructionSet, Lanes};
use crate::scheme::{PAST, SchemeError, checked_step_size};
use crate::system::MechanicalSystem;
pub(crate) use newton::GaussNewton;

/// The Gauss collocation method with `K` nodes, `1 ≤ K ≤ 8`, in canonical variables: the Galerkin integrator on polynomials of degree `K` with Gauss
/// quadrature.
///
/// Of order `2K`, symplectic, time-symmetric (Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed., sec. II.1.3 and
/// VI.4.2). For scenes without constraints, others are refused; there it takes one node less than a [`Galerkin`](super::Galerkin) of the same
/// order, and its passes over all nodes, a node per vector lane, take every mass matrix. Passes that do not converge are rescued by Newton's iteration
/// on all nodes.
///
/// ```
/// use evi_core::prelude::*;
/// let order_16 = Gauss::<8>::new(0.1);
/// # let _ = order_16;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gauss<const K: usize> {
    h: f64,
    by_newton: bool,
}

impl<const K: usize> Gauss<K> {
    /// The member with `K` nodes, for steps of size `h`.
    pub const fn new(h: f64) -> Self {
        Self { h, by_newton: false }
    }

    /// Solves every step by Newton's iteration on all nodes, to compare with: the same steps to round-off, slower.
    #[must_use]
    pub const fn by_newton(self) -> Self {
        Self { by_newton: true, ..self }
    }
}

impl<const K: usize> Symmetric for Gauss<K> {
    fn step_size(&self) -> f64 {
        self.h
    }

    fn with_step_size(&self, h: f64) -> Self {
        Self { h, ..*self }
    }

    fn check_symmetry(&self) -> Result<(), SchemeError> {
        Ok(())
    }
}

impl<const K: usize> Compensable for Gauss<K> {}

impl<S: MechanicalSystem, const K: usize> Scheme<S> for Gauss<K> {
    type Step = GaussStep<S, K>;

    fn prepare(&self, mechanics: Mechanics<S>) -> Result<Self::Step, SchemeError> {
        if S::N_CONSTRAINTS > 0 {
            let requirement = "a scene without constraints; `Galerkin` takes them";
            return Err(SchemeError::UnsupportedStructure { scheme: "a Gauss integrator", requirement });
        }
        let h = checked_step_size(self.h)?;
        Ok(GaussStep {
            passes: (!self.by_newton).then(|| GaussPasses::new(&mechanics, h)),
            instructions: InstructionSet::detect(),
            past: core::array::from_fn(|_| Array::filled(Lanes::ZERO)),
            known: 0,
            newton: GaussNewton::new(h),
            mechanics,
            h,
        })
    }
}

/// The one-step map of a [`Gauss`] scheme, with the storage of its iterations: nothing is allocated under a step.
pub struct GaussStep<S: MechanicalSystem, const K: usize> {
    mechanics: Mechanics<S>,
    passes: Option<GaussPasses<S, K>>,
    instructions: InstructionSet,
    /// Velocities at the nodes of the last steps, the last one first. They affect the number of passes and the last bits of a state,
    /// nothing else.
    past: [S::PerCoordinate<Lanes>; PAST],
    /// How many of them are known.
    known: usize,
    newton: GaussNewton<S, K>,
    h: f64,
}

impl<S: MechanicalSystem, const K: usize> OneStep<S> for GaussStep<S, K> {
    fn h(&self) -> f64 {
        self.h
    }

    fn mechanics(&self) -> &Mechanics<S> {
        &self.mechanics
    }

    fn advance(&mut self, state: &mut State<S>, tally: &mut impl Tally) -> Result<(), StepError> {
        self.advance_with(state, Dropped, tally).map(drop)
    }
}

impl<S: MechanicalSystem, const K: usize> CompensableStep<S> for GaussStep<S, K> {
    fn advance_compensated(
        &mut self,
        state: &mut State<S>,
        lost: &mut LostDigits<S>,
        tally: &mut impl Tally,
    ) -> Result<(), StepError> {
        let [q, p] = self.advance_with(state, &*lost, tally)?;
        *lost = LostDigits::new(q, p);
        Ok(())
    }
}

impl<S: MechanicalSystem, const K: usize> GaussStep<S, K> {
    /// How its steps are solved: which iteration, in which vector instructions; to be printed.
    pub fn iteration(&self) -> Iteration {
        if self.passes.is_some() { Iteration::Passes(self.instructions) } else { Iteration::Newton }
    }

    /// The velocities at the nodes of the step that was taken last.
    pub(crate) fn velocities_found(&self) -> [S::PerCoordinate<f64>; K] {
        match &self.passes {
            Some(passes) if self.known > 0 => {
                core::array::from_fn(|node| Array::from_fn(|i| passes.velocities[i].to_array()[node]))
            }
            _ => self.newton.velocities(),
        }
    }

    #[inline]
    fn advance_with<R: RoundOff<S>>(
        &mut self,
        state: &mut State<S>,
        round_off: R,
        tally: &mut impl Tally,
    ) -> Result<[Lost<S, R>; 2], StepError> {
        let (end, is_by_passes) = match self.by_passes(state, tally)? {
            Some(end) => (end, true),
            None => (self.newton.solve(&self.mechanics, state, tally)?, false),
        };
        let t = state.t + self.h;
        let (q, lost_q) = round_off.position(&state.q).plus(&end.difference).split();
        let mut momentum = round_off.momentum(&state.p).plus(&end.gain);
        let v = self
            .mechanics
            .project_momentum(t, &q, &mut momentum, state.v.clone(), tally)
            .map_err(|cause| StepError::Projection { t, cause })?;
        let (p, lost_p) = momentum.split();
        state.replace(t, q, v, p)?;
        match &self.passes {
            Some(passes) if is_by_passes => {
                self.past.swap(0, 1);
                self.past[0].clone_from(&passes.velocities);
                self.known = PAST.min(self.known + 1);
            }
            _ => self.known = 0,
        }
        Ok([lost_q, lost_p])
    }

    /// What the step changes, if its passes converge: from the last steps, or from the state alone.
    #[inline]
    fn by_passes(
        &mut self,
        state: &State<S>,
        tally: &mut impl Tally,
    ) -> Result<Option<GaussEnd<S>>, StepError> {
        let Some(passes) = &mut self.passes else { return Ok(None) };
        if self.known == PAST {
            if let Ok(end) = self.instructions.run(passes.from(state, GaussGuess::Continued(&self.past))) {
                tally.count_corrections(end.passes);
                return Ok(Some(end));
            }
            tally.count_restart();
        }
        let (t, q, v) = (state.t, &state.q, &state.v);
        let acceleration = self
            .mechanics
            .acceleration_with(t, q, v, &state.inputs)
            .map_err(|matrix| StepError::Singular { t, correction: 0, matrix })?
            .acceleration;
        let guess = GaussGuess::Constant(&acceleration);
        let end = self.instructions.run(passes.from(state, guess)).ok();
        match &end {
            Some(end) => tally.count_corrections(end.passes),
            None => tally.count_newton(),
        }
        Ok(end)
    }
}

// Newton's iteration begins from the state, and the storage of the passes is written anew in every step.
memory!([S: MechanicalSystem, const K: usize] GaussStep<S, K>, |words|
    Self { mechanics: _, passes, instructions: _, past, known, newton: _, h: _ } => {
        words.fixed(if passes.is_some() { 1.0 } else { 0.0 });
        for velocities in past {
            words.lanes(velocities);
        }
        words.index(known);
    }
);
