//! A scene joined with a scheme, and the start of a run.

use core::fmt;

use super::of_rank::{OfRank, ROUND_OFF, Violation, violation};
use super::rank_check::{check_agreement, check_rank, explained};
use super::{OneStep, Run, Scheme};
use crate::array::Array;
use crate::mechanics::{CONSISTENCY, ConstraintSet, Mechanics, ProjectionError, State, norm};
use crate::scalar::Scalar;
use crate::scheme::SchemeError;
use crate::system::MechanicalSystem;

/// Round-off of a momentum is that of its largest terms: four digits are left of it.
const LARGEST_PHASE: f64 = 1e12;

/// A scene and the scheme that integrates it.
///
/// ```
/// # use evi_core::prelude::*;
/// #[derive(MechanicalSystem)]
/// #[evi(coordinates(theta), kinetic = 0.5 * der(theta).powi(2), potential = -rate.powi(2) * theta.cos())]
/// struct Pendulum { rate: f64 }
///
/// let simulation = Simulation::new(Pendulum { rate: 3.0 }, Evi::midpoint(0.01));
/// let mut run = simulation.start([1.0], [0.0])?;
/// run.advance_to(10.0)?;
/// assert!((run.energy() + 9.0 * 1.0_f64.cos()).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Simulation<S, F> {
    system: S,
    scheme: F,
}

/// Which constraint an error speaks of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConstraintLabel {
    /// Its name in the attribute.
    Name(&'static str),
    /// Its place in `φ`, counted from 0, where constraints have no names: on the generic path.
    Index(usize),
}

impl fmt::Display for ConstraintLabel {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Name(name) => write!(formatter, "`{name}`"),
            Self::Index(index) => write!(formatter, "{index}"),
        }
    }
}

/// A run that cannot start.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StartError {
    /// The scheme defines no step.
    #[error(transparent)]
    Scheme(#[from] SchemeError),
    /// A parameter that the equations name is not finite.
    #[error("parameter `{name}` is not finite: {value}")]
    Parameter {
        /// The field of the struct.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A number of the start, or the energy or the momentum there, is not finite.
    #[error("{quantity} {index} of the start is not finite: {value}")]
    NotFinite {
        /// `position`, `velocity` or `momentum`; `time` or `energy` (then `index` is 0).
        quantity: &'static str,
        /// Index in its vector.
        index: usize,
        /// The value.
        value: f64,
    },
    /// Positions or velocities are not one per coordinate; only where sizes are known at run time.
    #[error("{quantity} of the start has {found} values, the system {expected} coordinates")]
    Length {
        /// `position` or `velocity`.
        quantity: &'static str,
        /// Number of coordinates.
        expected: usize,
        /// Number of values.
        found: usize,
    },
    /// The step size is so many times the time scale of the motion that nothing is left of momenta but round-off.
    #[error(
        "a step of {h:e} is {phase:e} times 1/ω of the fastest motion at the start: beyond {limit:e} momenta are round-off"
    )]
    Phase {
        /// Step size.
        h: f64,
        /// `|h| ω`, where `ω²` is the largest entry of `M^(−½) ∂²L/∂q² M^(−½)`.
        phase: f64,
        /// The largest that is accepted.
        limit: f64,
    },
    /// The position violates a constraint.
    #[error(
        "the start violates constraint {constraint}: residual {residual:e}, allowed {allowed:e}. \
         `start_projected` moves the start onto the constraints"
    )]
    InconsistentPosition {
        /// The constraint.
        constraint: ConstraintLabel,
        /// `φ(t₀, q₀)`.
        residual: f64,
        /// Largest residual that passes.
        allowed: f64,
    },
    /// The velocity leads away from a constraint.
    #[error(
        "the start velocity leaves constraint {constraint}: G v + ∂φ/∂t is {residual:e} of its terms, \
         allowed {allowed:e}. `start_projected` projects the velocity"
    )]
    InconsistentVelocity {
        /// The constraint.
        constraint: ConstraintLabel,
        /// `|G v + ∂φ/∂t| / (‖G‖ ‖v‖ + |∂φ/∂t|)`.
        residual: f64,
        /// Largest residual that passes.
        allowed: f64,
    },
    /// Some constraints follow from the others. Their motion is determined, but not what each of them pulls.
    #[error(
        "of {constraints} constraints {rank} are independent at the start; from the others follow {dependent} (singular values \
         {smallest_kept:.1e} of the largest, then {largest_dropped:.1e}). Leave these out, or, if they are meant, integrate with \
         `simulation.constraints_of_rank::<{rank}>()`"
    )]
    DependentConstraints {
        /// Number of independent constraints.
        rank: usize,
        /// Number of constraints.
        constraints: usize,
        /// The constraints that follow from the others.
        dependent: ConstraintSet,
        /// The smallest singular value that counts, relative to the largest.
        smallest_kept: f64,
        /// The largest that does not.
        largest_dropped: f64,
    },
    /// Not as many constraints are independent as [`Simulation::constraints_of_rank`] states.
    #[error(
        "constraints of rank {stated} are stated, {rank} are independent at the start (singular values {smallest_kept:.1e} of the \
         largest, then {largest_dropped:.1e}; from the others follow: {dependent})"
    )]
    Rank {
        /// The rank that the scene states.
        stated: usize,
        /// Number of independent constraints.
        rank: usize,
        /// The constraints that follow from the others.
        dependent: ConstraintSet,
        /// The smallest singular value that counts, relative to the largest.
        smallest_kept: f64,
        /// The largest that does not.
        largest_dropped: f64,
    },
    /// The constraints are independent, but so nearly dependent that the squares of their angles are round-off.
    #[error(
        "constraint {constraint} follows nearly from the others at the start: the smallest singular value is {smallest:.1e} of the \
         largest, and its square is round-off. `simulation.constraints_of_rank::<{rank}>()` does not square it"
    )]
    NearlyDependentConstraints {
        /// The constraint.
        constraint: ConstraintLabel,
        /// Number of independent constraints: all.
        rank: usize,
        /// The smallest singular value relative to the largest.
        smallest: f64,
    },
    /// No position satisfies all constraints, of which some are stated to follow from the others.
    #[error(
        "constraints contradict each other: where as many hold as are independent, constraint {constraint} has the residual \
         {residual:e}, allowed {allowed:e}"
    )]
    ContradictoryConstraints {
        /// The constraint.
        constraint: ConstraintLabel,
        /// `φ` at the nearest position on the others.
        residual: f64,
        /// Largest residual that passes.
        allowed: f64,
    },
    /// The mass matrix and the constraints do not determine the motion at the start, or the start cannot be
    /// projected on the constraints.
    #[error("start: {0}")]
    Projection(#[from] ProjectionError),
}

impl<S: MechanicalSystem, F: Scheme<S>> Simulation<S, F> {
    /// A simulation of `system` with `scheme`.
    pub const fn new(system: S, scheme: F) -> Self {
        Self { system, scheme }
    }

    /// The same simulation of a scene of whose constraints `R` are independent, which is checked where a run starts; see [`OfRank`].
    ///
    /// ```
    /// use evi_core::prelude::*;
    /// /// A pendulum whose rod is written down twice.
    /// #[derive(MechanicalSystem)]
    /// #[evi(
    ///     coordinates(x, y),
    ///     kinetic = 0.5 * (der(x).powi(2) + der(y).powi(2)),
    ///     potential = 9.81 * y,
    ///     constraint(rod: x.powi(2) + y.powi(2) == l.powi(2)),
    ///     constraint(again: x.powi(2) + y.powi(2) == l.powi(2)),
    /// )]
    /// struct HeldTwice { l: f64 }
    /// let simulation = Simulation::new(HeldTwice { l: 1.0 }, Evi::midpoint(0.01));
    /// let error = simulation.start([0.6, -0.8], [0.0; 2]).err().expect("refused");
    /// assert!(error.to_string().contains("`again`"));
    /// let simulation = Simulation::new(HeldTwice { l: 1.0 }, Evi::midpoint(0.01)).constraints_of_rank::<1>();
    /// let mut run = simulation.start([0.6, -0.8], [0.0; 2])?;
    /// let state = run.advance_to(1.0)?.clone();
    /// let [rod, again] = run.mechanics().acceleration(state.t(), state.q(), state.v())?.multipliers;
    /// assert!((rod - again).abs() < 1e-14);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn constraints_of_rank<const R: usize>(self) -> Simulation<OfRank<S, R>, F>
    where
        F: Scheme<OfRank<S, R>>,
    {
        Simulation::new(OfRank(self.system), self.scheme)
    }

    /// The scene.
    pub const fn system(&self) -> &S {
        &self.system
    }

    /// The scheme.
    pub const fn scheme(&self) -> &F {
        &self.scheme
    }

    /// A run from positions and velocities at time 0 that satisfy the constraints; its inputs are zero until
    /// [`Run::set_inputs`].
    ///
    /// # Errors
    /// [`StartError`] for numbers that are not finite, an inconsistent start, a scheme that defines no step, or a
    /// configuration where mass matrix and constraints do not determine the motion.
    pub fn start(
        &self,
        q: impl Into<S::PerCoordinate<f64>>,
        v: impl Into<S::PerCoordinate<f64>>,
    ) -> Result<Run<S, F::Step>, StartError> {
        self.start_at(0.0, q, v)
    }

    /// A run from a consistent start at time `t`.
    ///
    /// # Errors
    /// As for [`start`](Self::start).
    pub fn start_at(
        &self,
        t: f64,
        q: impl Into<S::PerCoordinate<f64>>,
        v: impl Into<S::PerCoordinate<f64>>,
    ) -> Result<Run<S, F::Step>, StartError> {
        check_parameters::<S>(&self.system.parameters())?;
        let step = self.scheme.prepare(Mechanics::new(&self.system))?;
        let state = checked_start(step.mechanics(), step.h(), t, q.into(), v.into())?;
        Ok(Run::new(step, state))
    }

    /// A run from the consistent start nearest to `(q, v)` in the metric of the mass matrix, at time `t`.
    ///
    /// # Errors
    /// As for [`start`](Self::start), except for inconsistency, which is mended.
    pub fn start_projected(
        &self,
        t: f64,
        q: impl Into<S::PerCoordinate<f64>>,
        v: impl Into<S::PerCoordinate<f64>>,
    ) -> Result<Run<S, F::Step>, StartError> {
        check_parameters::<S>(&self.system.parameters())?;
        let step = self.scheme.prepare(Mechanics::new(&self.system))?;
        let (q, v) = (q.into(), v.into());
        let mechanics = step.mechanics();
        check_finite(mechanics, t, &q, &v)?;
        let q =
            mechanics.project_configuration(t, &q, &v).map_err(|cause| explained(cause, mechanics, t, &q))?;
        check_agreement(mechanics, t, &q)?;
        check_rank(mechanics, t, &q)?;
        let state = project_velocity(mechanics, t, q, v)?;
        check_phase(mechanics, step.h(), &state)?;
        Ok(Run::new(step, state))
    }
}

/// The mechanics of a scene with these parameters, and the state at a consistent start of steps of size `h`.
///
/// # Errors
/// As for [`Simulation::start`], those of the scheme aside.
#[cfg(feature = "std")]
pub(crate) fn consistent_start<S: MechanicalSystem>(
    parameters: &S::PerParameter<f64>,
    h: f64,
    t: f64,
    q: S::PerCoordinate<f64>,
    v: S::PerCoordinate<f64>,
) -> Result<(Mechanics<S>, State<S>), StartError> {
    check_parameters::<S>(parameters)?;
    let mechanics = Mechanics { constants: S::constants(parameters) };
    let state = checked_start(&mechanics, h, t, q, v)?;
    Ok((mechanics, state))
}

/// The state at a consistent start.
fn checked_start<S: MechanicalSystem>(
    mechanics: &Mechanics<S>,
    h: f64,
    t: f64,
    q: S::PerCoordinate<f64>,
    v: S::PerCoordinate<f64>,
) -> Result<State<S>, StartError> {
    check_finite(mechanics, t, &q, &v)?;
    check_position(mechanics, t, &q)?;
    check_rank(mechanics, t, &q)?;
    check_velocity(mechanics, t, h, &q, &v)?;
    let state = project_velocity(mechanics, t, q, v)?;
    check_phase(mechanics, h, &state)?;
    Ok(state)
}

/// Removes what round-off left of the velocity normal to the constraints, and finds the momentum.
fn project_velocity<S: MechanicalSystem>(
    mechanics: &Mechanics<S>,
    t: f64,
    q: S::PerCoordinate<f64>,
    v: S::PerCoordinate<f64>,
) -> Result<State<S>, StartError> {
    let projected =
        mechanics.project_velocity(t, &q, v).map_err(|cause| explained(cause, mechanics, t, &q))?;
    // Finite numbers overflow where a mass or a gradient is out of all proportion.
    refuse_what_is_not_finite(&[
        ("position", q.as_ref()),
        ("velocity", projected.v.as_ref()),
        ("momentum", projected.p.as_ref()),
    ])?;
    Ok(State { t, q, v: projected.v, p: projected.p, inputs: Array::from_fn(|_| 0.0) })
}

fn check_parameters<S: MechanicalSystem>(parameters: &S::PerParameter<f64>) -> Result<(), StartError> {
    for (name, &value) in S::PARAMETERS.iter().zip(parameters.as_ref()) {
        if !value.is_finite() {
            return Err(StartError::Parameter { name, value });
        }
    }
    Ok(())
}

fn check_finite<S: MechanicalSystem>(
    mechanics: &Mechanics<S>,
    t: f64,
    q: &S::PerCoordinate<f64>,
    v: &S::PerCoordinate<f64>,
) -> Result<(), StartError> {
    let time = [t];
    let energy = [mechanics.energy_at(t, q, v)];
    refuse_what_is_not_finite(&[
        ("time", &time),
        ("position", q.as_ref()),
        ("velocity", v.as_ref()),
        ("energy", &energy),
    ])
}

fn refuse_what_is_not_finite(numbers: &[(&'static str, &[f64])]) -> Result<(), StartError> {
    for &(quantity, values) in numbers {
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            return Err(StartError::NotFinite { quantity, index, value: values[index] });
        }
    }
    Ok(())
}

/// Refuses steps over which forces of the potential are so large that what cancels in a momentum leaves none of its digits: it is the sum of
/// terms that are `|h| ω` times as large.
fn check_phase<S: MechanicalSystem>(
    mechanics: &Mechanics<S>,
    h: f64,
    state: &State<S>,
) -> Result<(), StartError> {
    let phase = Scalar::sqrt(mechanics.largest_squared_rate(state.t, &state.q, &state.v)) * h.abs();
    // What is no number is found elsewhere, by its own name.
    if phase > LARGEST_PHASE {
        return Err(StartError::Phase { h, phase, limit: LARGEST_PHASE });
    }
    Ok(())
}

/// Refuses a position beside a constraint.
fn check_position<S: MechanicalSystem>(
    mechanics: &Mechanics<S>,
    t: f64,
    q: &S::PerCoordinate<f64>,
) -> Result<(), StartError> {
    let Some(Violation { constraint, residual, allowed }) = violation(mechanics, t, q) else { return Ok(()) };
    if S::STATED_RANK.is_some()
        && let Ok(nearest) = mechanics.project_configuration(t, q, &Array::from_fn(|_| 0.0))
    {
        check_agreement(mechanics, t, &nearest)?;
    }
    Err(StartError::InconsistentPosition { constraint, residual, allowed })
}

/// Compares `G v + ∂φ/∂t` with its terms. A velocity that leaves a constraint by less than the round-off of the configuration in
/// one step of size `h` passes: near a turning point a state has no other.
fn check_velocity<S: MechanicalSystem>(
    mechanics: &Mechanics<S>,
    t: f64,
    h: f64,
    q: &S::PerCoordinate<f64>,
    v: &S::PerCoordinate<f64>,
) -> Result<(), StartError> {
    let residual = mechanics.hidden_constraint_residual_at(t, q, v);
    let (_, jacobian) = S::constraint_derivatives(&mechanics.constants, t, q);
    let rate = mechanics.constraint_rate(&jacobian, v);
    let gradient_norms = mechanics.gradient_norms(&jacobian);
    for c in 0..S::N_CONSTRAINTS {
        let is_round_off = (h * rate[c]).abs() <= ROUND_OFF * gradient_norms[c] * norm(q.as_ref());
        if !is_round_off && (residual[c] > CONSISTENCY || residual[c].is_nan()) {
            let (residual, allowed) = (residual[c], CONSISTENCY);
            let constraint = ConstraintLabel::Name(S::CONSTRAINTS[c]);
            return Err(StartError::InconsistentVelocity { constraint, residual, allowed });
        }
    }
    Ok(())
}
