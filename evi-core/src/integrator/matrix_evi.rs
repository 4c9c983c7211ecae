//! Exponential variational integrators with a matrix frequency.

use super::multipliers::MultiplierStep;
use super::positions;
use super::{Evi, OneStep, Scheme, StepError, Symmetric, Tally};
use crate::array::Array;
use crate::mechanics::{
    Dropped, ImplicitStep, ImpulseStep, MatrixAction, Mechanics, QuadraticPart, Rounded, State, StepModes,
    StepStart,
};
use crate::memory::memory;
use crate::scheme::{Mollifier, Quadrature, SchemeError, checked_step_size, to_multiple_of_pi};
use crate::system::MechanicalSystem;

/// An exponential variational integrator that integrates a quadratic part of the Lagrangian exactly, and samples only the rest of
/// the potential, `U`, at `K` nodes:
///
/// ```text
/// L_d(q₀, q₁) = exact action of ½ vᵀMv − ½ (q − q_ref)ᵀΩ(q − q_ref)  −  h Σ wⱼ U(tⱼ, xⱼ)
/// ```
///
/// `Ω` is a symmetric matrix that is constant over the run; every mode of `W² = M⁻¹Ω` has a frequency of its own, zero (straight),
/// positive (trigonometric) or negative squared (hyperbolic). Where `U` vanishes the motion is exact. The scheme is symplectic on the
/// constraint manifold, time-symmetric and of order 2 for symmetric nodes, with an error that is proportional to the defect of the
/// quadratic model. Translations in the kernel of `Ω` conserve their momentum, and `q_ref` stays at rest if it is an equilibrium.
///
/// On the trapezoidal rule ([`Evi::trapezoid`]) this is the impulse method: explicit but for the constraints, on which alone Newton's
/// iteration runs. On other nodes a step solves for positions and multipliers together.
///
/// Three ways to a matrix: [`Evi::stiffness`], [`Evi::linearised_at`], [`Evi::linearised_along`]. All are for scenes `L = ½ vᵀMv − V(t, q)` with
/// constant, positive definite `M`. Tables are full matrices: the cost of a step grows with the square of the number of
/// coordinates, whatever the pattern of the scene. Few modes gain, long chains do not.
///
/// There are no step sizes with `w h = kπ` for a frequency `w`: the ends of a step do not determine the mode between them.
/// Near them a coupled motion is resonant ([`MatrixEviStep::modes`] tells how near each mode is); a [`Mollifier`] damps this.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatrixEvi<const K: usize, P> {
    quadrature: Quadrature<K>,
    h: f64,
    part: P,
    mollifier: Option<Mollifier>,
}

/// What finds the quadratic part of a scene when a run is prepared.
pub trait QuadraticModel<S: MechanicalSystem> {
    /// The quadratic part.
    ///
    /// # Errors
    /// [`SchemeError`] where the scene has none of this kind.
    fn quadratic_part(&self, mechanics: &Mechanics<S>) -> Result<QuadraticPart<S>, SchemeError>;
}

/// A given stiffness about a reference; see [`Evi::stiffness`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiffness<const N: usize> {
    matrix: [[f64; N]; N],
    reference: [f64; N],
}

/// The linearisation at an equilibrium; see [`Evi::linearised_at`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearisedAt<Q> {
    q: Q,
}

/// The linearisation at a point of a motion; see [`Evi::linearised_along`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearisedAlong<Q> {
    q: Q,
    v: Q,
}

impl<const K: usize> Evi<K> {
    /// Integrates the quadratic potential `½ (q − q_ref)ᵀ Ω (q − q_ref)` exactly, where `Ω` is the symmetric `matrix` in units of energy over
    /// those of two coordinates, and `q_ref` is 0 or that of [`MatrixEvi::about`]. The constraints add nothing to it.
    ///
    /// ```
    /// use evi_core::prelude::*;
    /// let scheme = Evi::trapezoid(0.05).stiffness([[0.0, 0.0], [0.0, 2500.0]]);
    /// # let _ = scheme;
    /// ```
    pub fn stiffness<const N: usize>(self, matrix: [[f64; N]; N]) -> MatrixEvi<K, Stiffness<N>> {
        self.with_quadratic_part(Stiffness { matrix, reference: [0.0; N] })
    }

    /// Integrates the small motions about an equilibrium exactly: Newton's iteration finds the equilibrium next to `q`, and `Ω` is
    /// the stiffness there, with the curvature of the constraints, `V_qq + Σ λᵢ (φᵢ)_qq`.
    ///
    /// The multipliers `λ` that hold the equilibrium are frozen for the run: `λᵀφ` is subtracted from the Lagrangian, which changes no motion, for
    /// it vanishes on the constraints, but makes their curvature visible to the interpolation. Without it a rotation that a constraint
    /// enforces is none that a frequency fits. Frequencies of a run never follow its state: such steps are not symplectic.
    ///
    /// ```
    /// use evi_core::prelude::*;
    /// // The hanging rest of a double pendulum.
    /// let scheme = Evi::trapezoid(0.025).linearised_at([0.0, -1.0, 0.0, -2.0]);
    /// # let _ = scheme;
    /// ```
    pub fn linearised_at<Q>(self, q: Q) -> MatrixEvi<K, LinearisedAt<Q>> {
        self.with_quadratic_part(LinearisedAt { q })
    }

    /// The same with the multipliers that hold the scene at a point `(q, v)` of a motion, and the reference that the quadratic model
    /// has there: a uniform rotation on a circle is exact. Away from steady motions any such choice is as legal as any other, and
    /// nothing says that it gains.
    pub fn linearised_along<Q>(self, q: Q, v: Q) -> MatrixEvi<K, LinearisedAlong<Q>> {
        self.with_quadratic_part(LinearisedAlong { q, v })
    }

    fn with_quadratic_part<P>(self, part: P) -> MatrixEvi<K, P> {
        MatrixEvi { quadrature: self.quadrature, h: self.h, part, mollifier: None }
    }
}

impl<const K: usize, const N: usize> MatrixEvi<K, Stiffness<N>> {
    /// The stiffness about another reference than 0.
    pub const fn about(self, reference: [f64; N]) -> Self {
        Self { part: Stiffness { matrix: self.part.matrix, reference }, ..self }
    }
}

impl<const K: usize, P> MatrixEvi<K, P> {
    /// Evaluates the rest of the potential in positions that are averaged over the fast motion.
    pub fn mollified(self, mollifier: Mollifier) -> Self {
        Self { mollifier: Some(mollifier), ..self }
    }
}

impl<S, const N: usize> QuadraticModel<S> for Stiffness<N>
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
{
    fn quadratic_part(&self, _mechanics: &Mechanics<S>) -> Result<QuadraticPart<S>, SchemeError> {
        QuadraticPart::new(Array::from_fn(|row| self.matrix[row]), self.reference)
    }
}

impl<S: MechanicalSystem, Q: Clone + Into<S::PerCoordinate<f64>>> QuadraticModel<S> for LinearisedAt<Q> {
    fn quadratic_part(&self, mechanics: &Mechanics<S>) -> Result<QuadraticPart<S>, SchemeError> {
        let linearisation = mechanics.linearised_at(&self.q.clone().into())?;
        Ok(QuadraticPart::of(mechanics, &linearisation))
    }
}

impl<S: MechanicalSystem, Q: Clone + Into<S::PerCoordinate<f64>>> QuadraticModel<S> for LinearisedAlong<Q> {
    fn quadratic_part(&self, mechanics: &Mechanics<S>) -> Result<QuadraticPart<S>, SchemeError> {
        let linearisation = mechanics.linearised_along(&self.q.clone().into(), &self.v.clone().into())?;
        Ok(QuadraticPart::of(mechanics, &linearisation))
    }
}

impl<const K: usize, P: Clone> Symmetric for MatrixEvi<K, P> {
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

impl<S: MechanicalSystem, const K: usize, P: QuadraticModel<S>> Scheme<S> for MatrixEvi<K, P> {
    type Step = MatrixEviStep<S, K>;

    fn prepare(&self, mechanics: Mechanics<S>) -> Result<MatrixEviStep<S, K>, SchemeError> {
        const SCHEME: &str = "a matrix frequency";
        let h = checked_step_size(self.h)?;
        if !S::STRUCTURE.is_separable_with_constant_mass() {
            let requirement = "a constant mass matrix and no coupling of velocity with position or time";
            return Err(SchemeError::UnsupportedStructure { scheme: SCHEME, requirement });
        }
        if S::STRUCTURE.forces.exist() {
            let requirement = "no forces but those of the potential, whose quadratic part it integrates";
            return Err(SchemeError::UnsupportedStructure { scheme: SCHEME, requirement });
        }
        let part = self.part.quadratic_part(&mechanics)?;
        let modes = StepModes::new(&mechanics, &part, h)?;
        let report = Array::from_fn(|k| StepMode {
            squared_frequency: modes.flows[k].squared_frequency,
            phase: modes.flows[k].phase(),
            condition: modes.flows[k].condition(),
        });
        let form = if self.quadrature.is_trapezoid() {
            let requirement = "a positive definite mass matrix";
            let step = ImpulseStep::new(&mechanics, part, &modes, self.mollifier, h)
                .map_err(|_| SchemeError::UnsupportedStructure { scheme: SCHEME, requirement })?;
            let step = MultiplierStep::new(&mechanics, step);
            Form::Impulse { mechanics, step, h }
        } else {
            let action = MatrixAction::new(mechanics, part, &modes, self.mollifier, self.quadrature, h);
            Form::General(action)
        };
        Ok(MatrixEviStep { form, modes: report })
    }
}

/// A mode of a matrix frequency, as a step sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepMode {
    /// `κ = w²`, per unit of time squared; 0 for a straight mode, negative for a hyperbolic one.
    pub squared_frequency: f64,
    /// `√|κ| |h|`.
    pub phase: f64,
    /// How much a step magnifies round-off and the coupling of this mode to others: `1/|sin wh|` beyond a quarter turn, else 1.
    /// Tens announce a resonance, and from 1,000 on the scheme refuses the step size.
    pub condition: f64,
}

impl StepMode {
    /// Distance of the phase from the nearest `kπ`, `k ≥ 1`, where the ends of a step do not determine the mode between them; infinite for a
    /// hyperbolic mode.
    pub fn to_resonance(&self) -> f64 {
        if self.squared_frequency < 0.0 { f64::INFINITY } else { to_multiple_of_pi(self.phase) }
    }
}

/// The one-step map of a [`MatrixEvi`] for a scene.
pub struct MatrixEviStep<S: MechanicalSystem, const K: usize> {
    form: Form<S, K>,
    modes: S::PerCoordinate<StepMode>,
}

// One of them is made per run: the difference in size costs nothing.
#[allow(clippy::large_enum_variant)]
pub(crate) enum Form<S: MechanicalSystem, const K: usize> {
    /// The nodes are the ends of the step: linear in the momentum.
    Impulse { mechanics: Mechanics<S>, step: MultiplierStep<S, ImpulseStep<S>>, h: f64 },
    /// Any nodes.
    General(MatrixAction<S, K>),
}

impl<S: MechanicalSystem, const K: usize> MatrixEviStep<S, K> {
    /// The modes of the quadratic part, in ascending order of their squared frequencies: as many as coordinates, for constraints are
    /// not a part of it.
    pub fn modes(&self) -> &[StepMode] {
        self.modes.as_ref()
    }
}

#[cfg(feature = "std")]
impl<S: MechanicalSystem, const K: usize> MatrixEviStep<S, K> {
    /// How the steps are solved.
    pub(crate) const fn form(&self) -> &Form<S, K> {
        &self.form
    }
}

impl<S: MechanicalSystem, const K: usize> OneStep<S> for MatrixEviStep<S, K> {
    fn h(&self) -> f64 {
        match &self.form {
            Form::Impulse { h, .. } => *h,
            Form::General(action) => action.h(),
        }
    }

    fn mechanics(&self) -> &Mechanics<S> {
        match &self.form {
            Form::Impulse { mechanics, .. } => mechanics,
            Form::General(action) => &action.mechanics,
        }
    }

    #[inline]
    fn advance(&mut self, state: &mut State<S>, tally: &mut impl Tally) -> Result<(), StepError> {
        match &mut self.form {
            Form::Impulse { mechanics, step, h } => {
                step.advance(mechanics, *h, state, Dropped, tally).map(drop)
            }
            Form::General(action) => advance(action, state, tally),
        }
    }
}

/// A step on any nodes: Newton's iteration on positions and multipliers.
fn advance<S: MechanicalSystem, const K: usize>(
    action: &MatrixAction<S, K>,
    state: &mut State<S>,
    tally: &mut impl Tally,
) -> Result<(), StepError> {
    let h = action.h();
    let start = StepStart::new(&action.mechanics, state.t, &state.q, &state.p, &state.inputs);
    let guess = Array::from_fn(|i| h * state.v[i]);
    let solution = positions::iterate(action, &start, guess, tally)?;
    let mut momentum = Rounded(action.end_momentum(&start, &solution));
    let t = state.t + h;
    let q = Array::from_fn(|i| state.q[i] + solution.difference[i]);
    let mean_velocity = Array::from_fn(|i| solution.difference[i] / h);
    let v = action
        .mechanics
        .project_momentum(t, &q, &mut momentum, mean_velocity, tally)
        .map_err(|cause| StepError::Projection { t, cause })?;
    state.replace(t, q, v, momentum.0)
}

memory!([S: MechanicalSystem, const K: usize] MatrixEviStep<S, K>, |words| Self { form, modes: _ } => {
    match form {
        Form::Impulse { mechanics: _, step, h: _ } => {
            step.free().for_each_number(|number| words.fixed(number));
            words.part(step);
        }
        // Its iteration begins from the state.
        Form::General(action) => action.for_each_number(|number| words.fixed(number)),
    }
});
