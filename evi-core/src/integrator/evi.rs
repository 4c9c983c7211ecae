//! Exponential variational integrators.

use core::borrow::Borrow;

use super::curves::check_soft_coordinates;
use super::multipliers::MultiplierStep;
use super::of_rank::check_dependent_constraints;
use super::positions::{self, Guess, Sags};
use super::{Compensable, CompensableStep, OneStep, Scheme, StepError, Symmetric};
use crate::array::Array;
use crate::mechanics::{
    CentralStep, ConstantLegendre, DiscreteLagrangian, Dropped, FoldedStep, ImplicitStep, LeapfrogStep, Lost,
    LostDigits, Mechanics, ProjectionError, RoundOff, State, StepSolution, StepStart, Sum,
};
use crate::memory::memory;
use crate::newton::Tally;
use crate::scheme::{
    Frequency, Interpolant, Linear, Quadrature, Resonance, SceneFrequencies, SchemeError, checked_step_size,
};
use crate::system::MechanicalSystem;

/// An exponential variational integrator with `K` intermediate points.
///
/// The action of a step is a weighted sum of the Lagrangian over `K` nodes of a curve that is linear
/// ([`Linear`]) or trigonometric or hyperbolic ([`Frequency`], one for all coordinates or an array with one per
/// coordinate). Symplectic on the constraint manifold, of order 2 for symmetric nodes whatever `K` is (Marsden & West, Acta
/// Numerica 10 (2001), thm. 2.3.1), and time-symmetric then.
///
/// On straight curves every linear and angular momentum of the scene is preserved. A frequency keeps only symmetries that act
/// linearly, such as rotations about the origin: a constant is not in the span of `cos ωt, sin ωt`, so that with `K ≥ 2`
/// nodes motions depend on where the origin is. Give a frequency to coordinates that oscillate about 0, or about the reference of
/// [`about`](Self::about), with about that frequency, and [`Frequency::ZERO`] to those that translate, rotate, or are soft: with `K ≥ 2`
/// a free coordinate grows at the rate `ω² |h| √(Σ wⱼ σⱼ²)` ([`growth_rate`](crate::scheme::growth_rate)). Where nothing in the scene holds a
/// coordinate this is refused. Where constraints bend the motion, a scalar frequency gains nothing; [`linearised_at`](Self::linearised_at) does.
///
/// ```
/// use evi_core::prelude::*;
/// let classical = Evi::midpoint(0.01);
/// let exponential = Evi::new(Quadrature::<3>::lobatto(), 0.01).frequency(3.13);
/// # let _ = (classical, exponential);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evi<const K: usize, F = Linear> {
    pub(super) quadrature: Quadrature<K>,
    pub(super) h: f64,
    pub(super) interpolant: F,
    pub(super) allows_soft_modes: bool,
}

impl Evi<1> {
    /// The implicit midpoint member, `S = 1`.
    pub const fn midpoint(h: f64) -> Self {
        Self::new(Quadrature::midpoint(), h)
    }
}

impl Evi<3> {
    /// The member on Simpson's rule, `S = 3` equally spaced points.
    pub fn simpson(h: f64) -> Self {
        Self::new(Quadrature::uniform(), h)
    }
}

impl<const K: usize> Evi<K> {
    /// The member on the nodes of `quadrature`, with linear interpolation, for steps of size `h` (units of time;
    /// negative steps go back in time).
    pub const fn new(quadrature: Quadrature<K>, h: f64) -> Self {
        Self { quadrature, h, interpolant: Linear, allows_soft_modes: false }
    }

    /// Interpolates every coordinate with the same frequency; for scenes in which all coordinates oscillate about 0.
    pub fn frequency(self, frequency: impl Into<Frequency>) -> Evi<K, Frequency> {
        self.on(frequency.into())
    }

    /// Interpolates every coordinate with the frequency that the scene gives it by an item `frequency(..)`, on straight lines
    /// those without one. Schemes for scenes without such items do not compile.
    ///
    /// ```
    /// use evi_core::prelude::*;
    /// #[derive(MechanicalSystem)]
    /// #[evi(
    ///     coordinates(x, y),
    ///     kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    ///     potential = 0.5 * k * y.powi(2),
    ///     frequency(y: (k / m).sqrt()),
    /// )]
    /// struct Rail { m: f64, k: f64 }
    /// let simulation = Simulation::new(Rail { m: 2.0, k: 8.0 }, Evi::simpson(0.1).scene_frequencies());
    /// let mut run = simulation.start([0.0, 1.0], [1.0, 0.0])?;
    /// let state = run.advance_to(10.0)?;
    /// assert!((state.q()[0] - 10.0).abs() < 1e-13 && (state.q()[1] - 20.0_f64.cos()).abs() < 1e-4);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn scene_frequencies(self) -> Evi<K, SceneFrequencies> {
        self.on(SceneFrequencies)
    }

    /// Interpolates coordinate `i` with `frequencies[i]`, [`Frequency::ZERO`] on a straight line. Coordinates of one body should
    /// share theirs.
    pub fn frequencies<const N: usize>(self, frequencies: [Frequency; N]) -> Evi<K, [Frequency; N]> {
        self.on(frequencies)
    }
}

impl<const K: usize, F> Evi<K, F> {
    /// The rule that samples the Lagrangian.
    #[cfg(feature = "std")]
    pub(crate) const fn quadrature(&self) -> &Quadrature<K> {
        &self.quadrature
    }

    /// Its curves.
    #[cfg(feature = "std")]
    pub(crate) const fn interpolant(&self) -> &F {
        &self.interpolant
    }

    /// Whether coordinates that nothing holds may have a frequency.
    #[cfg(feature = "std")]
    pub(crate) const fn allows_soft_modes(&self) -> bool {
        self.allows_soft_modes
    }
}

impl Evi<2> {
    /// The member on the trapezoidal rule, `S = 2`; the impulse method with [`stiffness`](Self::stiffness).
    pub fn trapezoid(h: f64) -> Self {
        Self::new(Quadrature::uniform(), h)
    }
}

impl<const K: usize, F: Clone> Symmetric for Evi<K, F> {
    fn step_size(&self) -> f64 {
        self.h
    }

    fn with_step_size(&self, h: f64) -> Self {
        Self { h, ..self.clone() }
    }

    fn check_symmetry(&self) -> Result<(), SchemeError> {
        self.quadrature.check_symmetry()
    }
}

impl<const K: usize, F> Compensable for Evi<K, F> {}

impl<S: MechanicalSystem, const K: usize, F: Interpolant<S>> Scheme<S> for Evi<K, F> {
    type Step = EviStep<S, F, K>;

    fn prepare(&self, mechanics: Mechanics<S>) -> Result<Self::Step, SchemeError> {
        let action = self.action(mechanics)?;
        let (h, quadrature) = (action.h(), action.quadrature());
        let frequencies = Array::from_fn(|i| self.interpolant.frequency(&action.mechanics.constants, i));
        // Where M or A is singular, the constraints are needed to determine the motion: the general step uses them.
        let folded = if FoldedStep::<S, F>::EXISTS { FoldedStep::new(&action).ok() } else { None };
        let leapfrog = if EviStep::<S, F, K>::MAY_LEAP && quadrature.is_trapezoid() {
            LeapfrogStep::new(&action.mechanics, h).ok()
        } else {
            None
        };
        let central = if EviStep::<S, F, K>::MAY_BE_CENTRAL && quadrature.is_midpoint() {
            CentralStep::new(&action.mechanics, h)
        } else {
            None
        };
        let legendre =
            if ConstantLegendre::<S>::EXISTS { ConstantLegendre::new(&action.mechanics).ok() } else { None };
        let folded = folded.map(|free| MultiplierStep::new(&action.mechanics, free));
        let leapfrog = leapfrog.map(|free| MultiplierStep::new(&action.mechanics, free));
        Ok(EviStep { action, frequencies, folded, leapfrog, central, legendre, sags: Sags::none() })
    }
}

impl<const K: usize, F> Evi<K, F> {
    /// The discrete Lagrangian of this scheme for a scene.
    ///
    /// # Errors
    /// [`SchemeError`] for a scheme that defines no step for this scene.
    pub(crate) fn action<S: MechanicalSystem>(
        &self,
        mechanics: Mechanics<S>,
    ) -> Result<DiscreteLagrangian<S, F::Table<K>, K>, SchemeError>
    where
        F: Interpolant<S>,
    {
        let h = checked_step_size(self.h)?;
        let quadrature = self.interpolant.rule(&mechanics.constants, &self.quadrature, h)?;
        let table = self.interpolant.table(&mechanics.constants, &quadrature, h)?;
        if !self.allows_soft_modes {
            check_soft_coordinates::<S, K>(&self.interpolant, &mechanics.constants, &quadrature, h)?;
        }
        Ok(DiscreteLagrangian::new(mechanics, table, quadrature, h))
    }
}

/// What positions and momenta lose in a step.
type LostInStep<S, R> = [Lost<S, R>; 2];

/// The difference of positions that a step has made, and what is lost.
type Taken<S, R> = (<S as MechanicalSystem>::PerCoordinate<f64>, LostInStep<S, R>);

/// The one-step map of an [`Evi`] for a scene, with everything folded in that is constant for a run.
pub struct EviStep<S: MechanicalSystem, F: Interpolant<S>, const K: usize> {
    action: DiscreteLagrangian<S, F::Table<K>, K>,
    /// Of the curves.
    frequencies: S::PerCoordinate<Frequency>,
    /// The step of a quadratic Lagrangian.
    folded: Option<MultiplierStep<S, FoldedStep<S, F>>>,
    /// The step of a potential that acts at the ends alone.
    leapfrog: Option<MultiplierStep<S, LeapfrogStep<S>>>,
    /// The step of a central force.
    central: Option<CentralStep<S>>,
    /// The Legendre transform of a constant mass matrix.
    legendre: Option<ConstantLegendre<S>>,
    /// What the general step expects the next one from.
    sags: Sags<S>,
}

impl<S: MechanicalSystem, F: Interpolant<S>, const K: usize> OneStep<S> for EviStep<S, F, K> {
    fn h(&self) -> f64 {
        self.action.h()
    }

    fn mechanics(&self) -> &Mechanics<S> {
        &self.action.mechanics
    }

    #[inline]
    fn advance(&mut self, state: &mut State<S>, tally: &mut impl Tally) -> Result<(), StepError> {
        self.advance_with(state, Dropped, tally).map(drop)
    }
}

impl<S: MechanicalSystem, F: Interpolant<S>, const K: usize> CompensableStep<S> for EviStep<S, F, K> {
    #[inline]
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

impl<S: MechanicalSystem, F: Interpolant<S>, const K: usize> EviStep<S, F, K> {
    /// Whether two nodes on the curves of `F` can make a leapfrog step that is not folded.
    pub(crate) const MAY_LEAP: bool =
        K == 2 && F::IS_STRAIGHT && LeapfrogStep::<S>::EXISTS && !FoldedStep::<S, F>::EXISTS;
    /// Whether one node on the curves of `F` can make the step of a central force.
    const MAY_BE_CENTRAL: bool =
        K == 1 && F::IS_STRAIGHT && CentralStep::<S>::EXISTS && !FoldedStep::<S, F>::EXISTS;

    #[inline(always)]
    fn advance_with<R: RoundOff<S>>(
        &mut self,
        state: &mut State<S>,
        round_off: R,
        tally: &mut impl Tally,
    ) -> Result<LostInStep<S, R>, StepError> {
        if FoldedStep::<S, F>::EXISTS
            && let Some(folded) = &mut self.folded
        {
            return folded.advance(&self.action.mechanics, self.action.h(), state, round_off, tally);
        }
        if Self::MAY_LEAP
            && let Some(leapfrog) = &mut self.leapfrog
        {
            return leapfrog.advance(&self.action.mechanics, self.action.h(), state, round_off, tally);
        }
        if Self::MAY_BE_CENTRAL
            && let Some(central) = &self.central
            && let Some(lost) = central.advance(&self.action.mechanics, state, round_off, tally)
        {
            return Ok(lost);
        }
        if FoldedStep::<S, F>::EXISTS || Self::MAY_LEAP || (Self::MAY_BE_CENTRAL && self.central.is_some()) {
            let (end, lost) = self.advanced_rarely(state.clone(), round_off, tally)?;
            *state = end;
            return Ok(lost);
        }
        let guess = self.sags.guess(self.action.h(), &state.v);
        let (difference, lost) = self.advance_implicitly(state, &guess, round_off, tally)?;
        self.sags.remember(&guess, &difference);
        Ok(lost)
    }

    /// The step of a scene that as a rule has a simpler one. It takes copies, so that nothing that the simpler one needs lies in memory
    /// for it, and no history.
    #[inline(always)]
    fn advanced_rarely<R: RoundOff<S>>(
        &self,
        mut state: State<S>,
        round_off: R,
        tally: &mut impl Tally,
    ) -> Result<(State<S>, LostInStep<S, R>), StepError> {
        let h = self.action.h();
        let guess = Guess::plain(Array::from_fn(|i| h * state.v[i]));
        let (_, lost) = self.advance_implicitly(&mut state, &guess, round_off, tally)?;
        Ok((state, lost))
    }

    /// The step whose positions and multipliers are found together; returns the difference of positions and what is lost.
    #[inline(always)]
    fn advance_implicitly<R: RoundOff<S>>(
        &self,
        state: &mut State<S>,
        guess: &Guess<S>,
        round_off: R,
        tally: &mut impl Tally,
    ) -> Result<Taken<S, R>, StepError> {
        let t = state.t + self.action.h();
        let start = StepStart::new(self.mechanics(), state.t, &state.q, &state.p, &state.inputs);
        let solution = positions::solve(&self.action, &start, guess, tally)?;
        let (q, lost_q) = round_off.position(&state.q).plus(&solution.difference).split();
        let momentum = round_off.end_momentum(
            &state.p,
            || self.action.end_momentum(&start, &solution),
            || self.action.momentum_gain(&start, &solution),
        );
        let (v, momentum) = self
            .project(t, &q, momentum, &solution, tally)
            .map_err(|cause| StepError::Projection { t, cause })?;
        let (p, lost_p) = momentum.split();
        check_dependent_constraints(self.mechanics(), t, &q)?;
        state.replace(t, q, v, p)?;
        Ok((solution.difference, [lost_q, lost_p]))
    }

    /// The action of a step.
    #[cfg(feature = "std")]
    pub(crate) const fn action(&self) -> &DiscreteLagrangian<S, F::Table<K>, K> {
        &self.action
    }

    /// The Legendre transform of a constant mass matrix.
    #[cfg(feature = "std")]
    pub(crate) const fn legendre(&self) -> Option<&ConstantLegendre<S>> {
        self.legendre.as_ref()
    }

    /// The step of a quadratic Lagrangian, if the steps are such.
    #[cfg(feature = "std")]
    pub(crate) const fn folded(&self) -> Option<&MultiplierStep<S, FoldedStep<S, F>>> {
        if FoldedStep::<S, F>::EXISTS { self.folded.as_ref() } else { None }
    }

    /// The step of a potential that acts at the ends alone, if the steps are such.
    #[cfg(feature = "std")]
    pub(crate) const fn leapfrog(&self) -> Option<&MultiplierStep<S, LeapfrogStep<S>>> {
        if Self::MAY_LEAP { self.leapfrog.as_ref() } else { None }
    }

    /// How far the frequency of every coordinate is from where steps lose their meaning.
    ///
    /// ```
    /// use evi_core::prelude::*;
    /// # #[derive(MechanicalSystem)]
    /// # #[evi(coordinates(theta), kinetic = 0.5 * der(theta).powi(2), potential = -rate.powi(2) * theta.cos())]
    /// # struct Pendulum { rate: f64 }
    /// let run = Simulation::new(Pendulum { rate: 3.0 }, Evi::simpson(0.5).frequency(3.0)).start([1.0], [0.0])?;
    /// let [theta] = run.map().resonances();
    /// assert!(theta.phase == 1.5 && theta.margin() > 0.5);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn resonances(&self) -> S::PerCoordinate<Resonance> {
        let quadrature = self.action.quadrature();
        Array::from_fn(|i| Resonance::of(self.frequencies[i], quadrature, self.action.h()))
    }

    /// The two-step view: `q_next` from two consecutive configurations, the first at time `t_prev`.
    ///
    /// Solves `D₂L_d(q_prev, q_curr) + f⁺ + D₁L_d(q_curr, q_next) + f⁻ − Gᵀ(q_curr) ℓ = 0`, `φ(q_next) = 0`; for scenes
    /// without inputs, which the compiler checks.
    ///
    /// # Errors
    /// [`StepError`] as for [`OneStep::advance`].
    pub fn next_configuration(
        &self,
        t_prev: f64,
        q_prev: &S::PerCoordinate<f64>,
        q_curr: &S::PerCoordinate<f64>,
    ) -> Result<S::PerCoordinate<f64>, StepError> {
        const { assert!(S::N_INPUTS == 0, "this scene has inputs: take steps from states, which hold them") };
        let inputs = Array::from_fn(|_| 0.0);
        let difference = S::PerCoordinate::<f64>::from_fn(|i| q_curr[i] - q_prev[i]);
        // The part of this momentum normal to the constraints at q_curr goes into the impulse: no projection needed.
        let momentum = self.action.arriving_momentum(t_prev, q_prev, &difference, &inputs);
        let t = t_prev + self.action.h();
        let start = StepStart::new(self.mechanics(), t, q_curr, &momentum, &inputs);
        let StepSolution { difference, .. } =
            positions::solve(&self.action, &start, &Guess::plain(difference), &mut ())?;
        Ok(Array::from_fn(|i| q_curr[i] + difference[i]))
    }

    /// Removes from `momentum` the impulse that leaves the constraints at the end of a step, and returns the velocity with what is left of it.
    #[inline]
    fn project<P: Sum<S>>(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
        mut momentum: P,
        solution: &StepSolution<S>,
        tally: &mut impl Tally,
    ) -> Result<(S::PerCoordinate<f64>, P), ProjectionError> {
        let mechanics = self.mechanics();
        if ConstantLegendre::<S>::EXISTS
            && let Some(legendre) = &self.legendre
        {
            return Ok(if S::N_CONSTRAINTS == 0 {
                let v = legendre.velocity(momentum.value().borrow());
                (v, momentum)
            } else {
                let (_, jacobian) = S::constraint_derivatives(&mechanics.constants, t, q);
                let gram = legendre.factor_gram(mechanics, &jacobian, tally)?;
                legendre.project(mechanics, &gram, &jacobian, &solution.impulse, momentum)
            });
        }
        let guess = Array::from_fn(|i| solution.difference[i] / self.action.h());
        let v = mechanics.project_momentum(t, q, &mut momentum, guess, tally)?;
        Ok((v, momentum))
    }
}

memory!([S: MechanicalSystem, F: Interpolant<S>, const K: usize] EviStep<S, F, K>, |words|
    Self { action, frequencies: _, folded, leapfrog, central: _, legendre: _, sags } => {
        action.for_each_number(|number| words.fixed(number));
        // Which of the steps there are depends on the scene and the scheme alone.
        if let Some(folded) = folded {
            words.part(folded);
        }
        if let Some(leapfrog) = leapfrog {
            words.part(leapfrog);
        }
        words.part(sags);
    }
);
