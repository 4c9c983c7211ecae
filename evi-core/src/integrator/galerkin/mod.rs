//! Galerkin variational integrators: order `2K` in one step with inner points, each of them on the constraints.

mod newton;
mod passes;
mod points;

use core::fmt;

use super::{Compensable, CompensableStep, OneStep, Scheme, StepError, Symmetric, Tally};
use crate::array::Array;
use crate::mechanics::{
    ConstantLegendre, Dropped, GalerkinAction, Lost, LostDigits, Mechanics, Points, RoundOff, State, Sum,
};
use crate::memory::memory;
use crate::newton::TARGET;
use crate::scalar::InstructionSet;
use crate::scheme::{Frequency, Linear, NodalCurves, SchemeError, checked_step_size};
use crate::system::MechanicalSystem;
pub(crate) use newton::NewtonSolve;
use passes::LanePasses;
pub(crate) use passes::ROUGH;
use points::PointSteps;

/// A Galerkin variational integrator with `K` intervals between Lobatto nodes, `1 ≤ K ≤ 8`.
///
/// The curve of a step is a polynomial of degree `K`, or with a [`Frequency`] an element of
/// `span{1, t, …, t^(K−2), cos ωt, sin ωt}`, through `K + 1` points at the Lobatto nodes; the action is Lobatto's rule on these nodes; every
/// point satisfies the constraints. Of order `2K` in positions, velocities, energy and the multipliers that
/// [`Mechanics::acceleration`] recovers, symplectic on the constraint manifold, time-symmetric (Jay, SIAM J. Numer. Anal. 33 (1996) 368;
/// Wenger, Ober-Blöbaum, Leyendecker, Adv. Comput. Math. 43 (2017) 1163). Inner velocities need not satisfy the hidden constraints,
/// and are not reported.
///
/// Linear momentum is kept by polynomials, and by every frequency from `K = 2` on, since the curves then contain the
/// constants. One interval is RATTLE, and with a frequency the exponential integrator on the trapezoidal rule.
///
/// Polynomials are found by passes over all nodes at once, a node per vector lane, at a cost of a few kernels per pass; mixed curves, and steps whose
/// passes do not converge, by Newton's iteration on `K (n + m)` unknowns. `K = 8` fills the lanes, and is the fastest member for errors below 1e-4;
/// [`propose`](super::propose) finds the step size for an error.
///
/// ```
/// use evi_core::prelude::*;
/// let order_6 = Galerkin::<3>::new(0.1);
/// let exponential = Galerkin::<3>::new(0.1).frequency(3.13);
/// # let _ = (order_6, exponential);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Galerkin<const K: usize, F = Linear> {
    h: f64,
    curves: F,
    by_newton: bool,
    tolerance: f64,
}

impl<const K: usize> Galerkin<K> {
    /// The member on polynomials, for steps of size `h`.
    pub const fn new(h: f64) -> Self {
        Self { h, curves: Linear, by_newton: false, tolerance: TARGET }
    }

    /// Gives every coordinate the same frequency.
    pub fn frequency(self, frequency: impl Into<Frequency>) -> Galerkin<K, Frequency> {
        self.on(frequency.into())
    }

    /// Gives coordinate `i` the frequency `frequencies[i]`; [`Frequency::ZERO`] stands for a polynomial.
    pub fn frequencies<const N: usize>(self, frequencies: [Frequency; N]) -> Galerkin<K, [Frequency; N]> {
        self.on(frequencies)
    }

    /// The same member on other curves.
    fn on<F>(self, curves: F) -> Galerkin<K, F> {
        let Self { h, curves: Linear, by_newton, tolerance } = self;
        Galerkin { h, curves, by_newton, tolerance }
    }
}

impl<const K: usize, F> Galerkin<K, F> {
    /// Solves every step by Newton's iteration on all points at once, to compare with: the same steps to round-off, slower.
    #[must_use]
    pub fn by_newton(self) -> Self {
        Self { by_newton: true, ..self }
    }

    /// Ends the passes of a step where the next one would move no point by more than `tolerance` of the configuration, instead of at round-off. What a
    /// step keeps exactly it then keeps to that tolerance, but for the constraints and the hidden ones, which hold to round-off; as long as it is
    /// well below the error of a step, runs end as near to the truth, after fewer passes. A tolerance below round-off is round-off; steps whose mass depends on
    /// positions, and those of scenes of many bodies, are solved to round-off whatever it is.
    #[must_use]
    pub fn solved_to(self, tolerance: f64) -> Self {
        // Written so that a NaN is round-off.
        Self { tolerance: if tolerance > TARGET { tolerance } else { TARGET }, ..self }
    }

    /// Relative length of a last correction.
    pub(crate) const fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Whether [`by_newton`](Self::by_newton) has been called.
    pub(crate) const fn is_by_newton(&self) -> bool {
        self.by_newton
    }
}

impl<const K: usize, F: Clone> Symmetric for Galerkin<K, F> {
    fn step_size(&self) -> f64 {
        self.h
    }

    fn with_step_size(&self, h: f64) -> Self {
        Self { h, curves: self.curves.clone(), by_newton: self.by_newton, tolerance: self.tolerance }
    }

    fn check_symmetry(&self) -> Result<(), SchemeError> {
        Ok(())
    }
}

impl<const K: usize, F> Compensable for Galerkin<K, F> {}

impl<S: MechanicalSystem, const K: usize, F: NodalCurves<S>> Scheme<S> for Galerkin<K, F> {
    type Step = GalerkinStep<S, F, K>;

    fn prepare(&self, mechanics: Mechanics<S>) -> Result<Self::Step, SchemeError> {
        let h = checked_step_size(self.h)?;
        if S::STATED_RANK.is_some() {
            let requirement = "constraints that are independent";
            return Err(SchemeError::UnsupportedStructure { scheme: "Galerkin", requirement });
        }
        let action = GalerkinAction::new(mechanics, self.curves.tables::<K>(h)?, h);
        let has_passes = F::ARE_POLYNOMIALS && !self.by_newton;
        let is_mass_constant = LanePasses::<S, K>::EXIST;
        Ok(GalerkinStep {
            // A mass matrix that is not positive definite leaves the step to Newton's iteration.
            passes: if has_passes && is_mass_constant {
                LanePasses::new(&action.mechanics, h, self.tolerance)
            } else {
                None
            },
            points: (has_passes && !is_mass_constant).then(|| PointSteps::new(&action.mechanics, h)),
            newton: NewtonSolve::new(&action),
            action,
        })
    }
}

/// The one-step map of a [`Galerkin`] scheme, with the storage of its iterations: nothing is allocated under a step.
pub struct GalerkinStep<S: MechanicalSystem, F: NodalCurves<S>, const K: usize> {
    action: GalerkinAction<S, F::Tables<K>, K>,
    /// Of scenes with a constant mass.
    passes: Option<LanePasses<S, K>>,
    /// Of all others.
    points: Option<PointSteps<S, K>>,
    newton: NewtonSolve<S, K>,
}

impl<S: MechanicalSystem, F: NodalCurves<S>, const K: usize> GalerkinStep<S, F, K> {
    /// The action of a step.
    pub(crate) const fn action(&self) -> &GalerkinAction<S, F::Tables<K>, K> {
        &self.action
    }

    /// The Legendre transform of steps that are found by passes on a constant mass.
    pub(crate) fn legendre(&self) -> Option<&ConstantLegendre<S>> {
        self.passes.as_ref().map(LanePasses::legendre)
    }

    /// The points of the step from `start` to `end` that was taken last, and its `p⁻`; `None` if no step was taken.
    pub(crate) fn found(
        &self,
        start: &State<S>,
        end: &State<S>,
    ) -> Option<(Points<S, K>, S::PerCoordinate<f64>)> {
        let of_lanes =
            self.passes.as_ref().and_then(|passes| passes.found(&self.action.mechanics, start, end));
        of_lanes.or_else(|| {
            let by_passes = self.points.as_ref().and_then(PointSteps::found);
            let points = by_passes.or_else(|| self.newton.found())?;
            let gain = self.action.momentum_gain(start, &points);
            Some((points, Array::from_fn(|i| start.p[i] + gain[i])))
        })
    }

    /// How its steps are solved: which iteration, in which vector instructions; to be printed.
    pub fn iteration(&self) -> Iteration {
        match (&self.passes, &self.points) {
            (Some(passes), _) => Iteration::Passes(passes.instruction_set()),
            (_, Some(passes)) => Iteration::Passes(passes.instruction_set()),
            _ => Iteration::Newton,
        }
    }
}

/// How the equations of a Galerkin step are solved.
#[derive(Clone, Copy, Debug)]
pub enum Iteration {
    /// By passes over all nodes at once, a node per lane; steps whose passes do not converge by Newton's iteration.
    Passes(InstructionSet),
    /// By Newton's iteration on all points.
    Newton,
}

impl fmt::Display for Iteration {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Passes(instructions) => write!(formatter, "passes in {instructions}"),
            Self::Newton => write!(formatter, "Newton's iteration"),
        }
    }
}

impl<S: MechanicalSystem, F: NodalCurves<S>, const K: usize> OneStep<S> for GalerkinStep<S, F, K> {
    fn h(&self) -> f64 {
        self.action.h()
    }

    fn mechanics(&self) -> &Mechanics<S> {
        &self.action.mechanics
    }

    fn advance(&mut self, state: &mut State<S>, tally: &mut impl Tally) -> Result<(), StepError> {
        self.advance_with(state, Dropped, tally).map(drop)
    }
}

impl<S: MechanicalSystem, F: NodalCurves<S>, const K: usize> CompensableStep<S> for GalerkinStep<S, F, K> {
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

impl<S: MechanicalSystem, F: NodalCurves<S>, const K: usize> GalerkinStep<S, F, K> {
    #[inline]
    fn advance_with<R: RoundOff<S>>(
        &mut self,
        state: &mut State<S>,
        round_off: R,
        tally: &mut impl Tally,
    ) -> Result<[Lost<S, R>; 2], StepError> {
        let mechanics = &self.action.mechanics;
        // Branches on constants, so that a scene has code for one kind of passes.
        let landed = if !F::ARE_POLYNOMIALS {
            None
        } else if LanePasses::<S, K>::EXIST {
            by_passes(&mut self.passes, mechanics, state, round_off, tally)?
        } else {
            by_passes(&mut self.points, mechanics, state, round_off, tally)?
        };
        if let Some(lost) = landed {
            self.newton.remember(None);
            return Ok(lost);
        }
        let points = self.newton.solve(&self.action, state, tally)?;
        let t = state.t + self.action.h();
        let (q, lost_q) = round_off.position(&state.q).plus(&points.differences[K - 1]).split();
        let mut momentum = round_off.momentum(&state.p).plus(&self.action.momentum_gain(state, &points));
        let guess = self.action.velocity(&state.q, &points, K);
        let v = self
            .mechanics()
            .project_momentum(t, &q, &mut momentum, guess, tally)
            .map_err(|cause| StepError::Projection { t, cause })?;
        let (p, lost_p) = momentum.split();
        state.replace(t, q, v, p)?;
        self.newton.remember(Some(points));
        Ok([lost_q, lost_p])
    }
}

/// Passes over all nodes, with the past that they begin from.
trait NodePasses<S: MechanicalSystem> {
    /// What passes find.
    type End;

    /// The end of the step from `start`, if the passes converge: from the last steps, or from the state alone.
    fn solve(
        &mut self,
        mechanics: &Mechanics<S>,
        start: &State<S>,
        tally: &mut impl Tally,
    ) -> Option<Self::End>;

    /// Overwrites `state` with that end, on the constraints and the hidden ones to round-off, and returns the digits that this loses.
    fn land<R: RoundOff<S>>(
        &mut self,
        mechanics: &Mechanics<S>,
        state: &mut State<S>,
        round_off: R,
        end: Self::End,
        tally: &mut impl Tally,
    ) -> Result<[Lost<S, R>; 2], StepError>;

    /// Drops the past: the next step is not predicted from it.
    fn forget(&mut self);
}

/// Takes the step by passes; `None` if there are none, or if they do not converge.
#[inline]
fn by_passes<S: MechanicalSystem, R: RoundOff<S>>(
    passes: &mut Option<impl NodePasses<S>>,
    mechanics: &Mechanics<S>,
    state: &mut State<S>,
    round_off: R,
    tally: &mut impl Tally,
) -> Result<Option<[Lost<S, R>; 2]>, StepError> {
    let Some(passes) = passes else { return Ok(None) };
    if let Some(end) = passes.solve(mechanics, state, tally) {
        return passes.land(mechanics, state, round_off, end, tally).map(Some);
    }
    tally.count_newton();
    passes.forget();
    Ok(None)
}

memory!([S: MechanicalSystem, F: NodalCurves<S>, const K: usize] GalerkinStep<S, F, K>, |words|
    Self { action, passes, points, newton } => {
        action.for_each_number(|number| words.fixed(number));
        words.fixed(if passes.is_some() { 1.0 } else { 0.0 });
        if let Some(passes) = passes {
            words.part(passes);
        }
        words.fixed(if points.is_some() { 1.0 } else { 0.0 });
        if let Some(points) = points {
            words.part(points);
        }
        words.part(newton);
    }
);
