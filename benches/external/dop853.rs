//! DOP853 of Hairer, Nørsett and Wanner, by the crate `ode_solvers`.

use std::marker::PhantomData;

use evi_core::comparison::{Failure, Solver};
use evi_core::linear::SingularMatrix;
use evi_core::system::MechanicalSystem;
use ode_solvers::dop_shared::{IntegrationError, SolverResult};
use ode_solvers::{DVector, OutputType, SVector, System};

use super::Tolerances;
use super::index_one::{IndexOne, split};

/// Steps after which one call gives up.
pub(super) const MOST_STEPS: u32 = 1_000_000;

/// A run of DOP853 that ended early.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Dop853Error {
    /// A tolerance is not a positive number.
    #[error("tolerances must be finite and positive, got {relative:e} relative and {absolute:e} absolute")]
    Tolerances {
        /// Relative tolerance.
        relative: f64,
        /// Absolute tolerance.
        absolute: f64,
    },
    /// The time to move to, or a number of the start, is not finite.
    #[error("cannot go from t = {t:?} to t = {target:?}: a number is not finite")]
    NotFinite {
        /// Where the solver stands.
        t: f64,
        /// Where it should go.
        target: f64,
    },
    /// More steps than a comparison waits for.
    #[error("{steps} steps end at t = {t:?}")]
    TooManySteps {
        /// Time reached.
        t: f64,
        /// Steps of this call.
        steps: u32,
    },
    /// The step size has shrunk to round-off of the time.
    #[error("the step size vanishes at t = {t:?}")]
    StepSizeUnderflow {
        /// Time reached.
        t: f64,
    },
    /// Mass matrix and constraints do not determine the accelerations.
    #[error("no accelerations at t = {t:?}: {matrix}")]
    Singular {
        /// Time of the evaluation.
        t: f64,
        /// The numbers of the matrix.
        matrix: SingularMatrix,
    },
}

/// DOP853, the explicit Runge-Kutta method of order 8(5, 3) (Hairer, Nørsett, Wanner, Solving ODEs I, sec. II.10), on the index-1
/// equations from `(q, v)` at time 0, with its own choice of steps.
///
/// Where something depends on time, time is a component of its own: version 0.6.2 of the crate has 0 in the place of 1 for the node of
/// stage 12 (its pull request 42) and evaluates it at the wrong time.
///
/// Vectors of up to 12 coordinates live on the stack. No dense output, which would cost three more evaluations per step; no test for
/// stiffness, which would end the run. The crate keeps every step of a call in a vector: only that allocates.
///
/// # Errors
/// [`Dop853Error::Tolerances`], and [`Dop853Error::NotFinite`] for a start that is not finite.
pub fn dop853<S: MechanicalSystem + 'static>(
    system: &S,
    q: &S::PerCoordinate<f64>,
    v: &S::PerCoordinate<f64>,
    tolerances: Tolerances,
) -> Result<Box<dyn Solver>, Dop853Error> {
    macro_rules! by_size {
        ($($n:literal)*) => {
            match (S::N_COORDINATES, S::STRUCTURE.is_autonomous()) {
                $(($n, true) => Ok(Box::new(Run::<S, SVector<f64, { 2 * $n }>>::new(system, q, v, tolerances)?)),)*
                $(($n, false) => Ok(Box::new(Run::<S, SVector<f64, { 2 * $n + 1 }>>::new(system, q, v, tolerances)?)),)*
                _ => Ok(Box::new(Run::<S, DVector<f64>>::new(system, q, v, tolerances)?)),
            }
        };
    }
    by_size!(1 2 3 4 5 6 7 8 9 10 11 12)
}

/// Hairer's constants for the choice of steps.
pub(super) const SAFETY: f64 = 0.9;
pub(super) const BETA: f64 = 0.0;
pub(super) const SMALLEST_FACTOR: f64 = 0.333;
pub(super) const LARGEST_FACTOR: f64 = 6.0;
/// A test would end the run.
pub(super) const NO_STIFFNESS_TEST: u32 = u32::MAX;

/// A vector that `ode_solvers` integrates.
trait Integrated: Sized + 'static {
    fn from_fn(len: usize, component: impl FnMut(usize) -> f64) -> Self;

    fn components(&self) -> &[f64];

    /// The steps from `y` on, the start first, and how they ended.
    fn integrate<S: MechanicalSystem>(
        y: Self,
        equations: &IndexOne<S>,
        span: Span,
    ) -> (SolverResult<f64, Self>, Result<(), IntegrationError>);
}

/// What a call asks for.
struct Span {
    t: f64,
    target: f64,
    /// The size of the first step; 0 to have it estimated.
    first_step: f64,
    tolerances: Tolerances,
}

struct RightSide<'a, S: MechanicalSystem>(&'a IndexOne<S>);

/// Implements [`Integrated`] for the vectors of static and of dynamic length, which the crate has no common bounds for.
macro_rules! integrated {
    ([$($size:ident)?] $vector:ty, $from_fn:expr) => {
        impl<S: MechanicalSystem, $(const $size: usize)?> System<f64, $vector> for RightSide<'_, S> {
            #[inline]
            fn system(&self, t: f64, y: &$vector, slope: &mut $vector) {
                self.0.slope(t, y.as_slice(), slope.as_mut_slice());
            }
        }

        impl<$(const $size: usize)?> Integrated for $vector {
            fn from_fn(len: usize, component: impl FnMut(usize) -> f64) -> Self {
                $from_fn(len, component)
            }

            fn components(&self) -> &[f64] {
                self.as_slice()
            }

            fn integrate<S: MechanicalSystem>(
                y: Self,
                equations: &IndexOne<S>,
                Span { t, target, first_step, tolerances: Tolerances { relative, absolute } }: Span,
            ) -> (SolverResult<f64, Self>, Result<(), IntegrationError>) {
                let mut method = ode_solvers::Dop853::from_param(
                    RightSide(equations),
                    t,
                    target,
                    0.0,
                    y,
                    relative,
                    absolute,
                    SAFETY,
                    BETA,
                    SMALLEST_FACTOR,
                    LARGEST_FACTOR,
                    target - t,
                    first_step,
                    MOST_STEPS,
                    NO_STIFFNESS_TEST,
                    OutputType::Sparse,
                );
                let outcome = method.integrate().map(drop);
                (method.into(), outcome)
            }
        }
    };
}

integrated!([D] SVector<f64, D>, |_, component| SVector::from_fn(by_row(component)));
integrated!([] DVector<f64>, |len, component| DVector::from_fn(len, by_row(component)));

fn by_row(mut component: impl FnMut(usize) -> f64) -> impl FnMut(usize, usize) -> f64 {
    move |row, _| component(row)
}

/// A solver of one size of vectors.
struct Run<S: MechanicalSystem, V> {
    equations: IndexOne<S>,
    tolerances: Tolerances,
    t: f64,
    q: S::PerCoordinate<f64>,
    v: S::PerCoordinate<f64>,
    p: S::PerCoordinate<f64>,
    steps: u64,
    /// The last step size that was not cut to end at a given time; 0 before the first.
    step_size: f64,
    vector: PhantomData<V>,
}

impl<S: MechanicalSystem, V: Integrated> Run<S, V> {
    fn new(
        system: &S,
        q: &S::PerCoordinate<f64>,
        v: &S::PerCoordinate<f64>,
        tolerances: Tolerances,
    ) -> Result<Self, Dop853Error> {
        let Tolerances { relative, absolute } = tolerances;
        if !tolerances.are_sound() {
            return Err(Dop853Error::Tolerances { relative, absolute });
        }
        if !q.as_ref().iter().chain(v.as_ref()).all(|x| x.is_finite()) {
            return Err(Dop853Error::NotFinite { t: 0.0, target: 0.0 });
        }
        let equations = IndexOne::new(system);
        let p = equations.mechanics.momentum_at(0.0, q, v);
        Ok(Self {
            equations,
            tolerances,
            t: 0.0,
            q: q.clone(),
            v: v.clone(),
            p,
            steps: 0,
            step_size: 0.0,
            vector: PhantomData,
        })
    }

    /// Moves to `target` and returns the steps, of which it stands at the last.
    fn integrate(&mut self, target: f64) -> (SolverResult<f64, V>, Result<(), Dop853Error>) {
        let Self { t, tolerances, .. } = *self;
        if target == t {
            return (SolverResult::default(), Ok(()));
        }
        if !target.is_finite() {
            return (SolverResult::default(), Err(Dop853Error::NotFinite { t, target }));
        }
        let n = S::N_COORDINATES;
        let len = 2 * n + usize::from(!S::STRUCTURE.is_autonomous());
        let y = V::from_fn(len, |i| match i {
            i if i < n => self.q[i],
            i if i < 2 * n => self.v[i - n],
            _ => t,
        });
        // Of the direction in which the run goes on.
        let first_step = if self.step_size * (target - t) > 0.0 { self.step_size } else { 0.0 };
        let span = Span { t, target, first_step, tolerances };
        let (steps, outcome) = V::integrate(y, &self.equations, span);
        let taken = steps.get().0;
        if let [.., before, cut_off, _] = taken[..] {
            self.step_size = cut_off - before;
        }
        self.steps += taken.len().saturating_sub(1) as u64;
        (steps, outcome.map_err(|failure| self.explained(failure)))
    }

    fn explained(&self, failure: IntegrationError) -> Dop853Error {
        if let Some((t, matrix)) = self.equations.take_singular() {
            return Dop853Error::Singular { t, matrix };
        }
        match failure {
            IntegrationError::MaxNumStepReached { x: t, n_step: steps } => {
                Dop853Error::TooManySteps { t, steps }
            }
            IntegrationError::StepSizeUnderflow { x: t } | IntegrationError::StiffnessDetected { x: t } => {
                Dop853Error::StepSizeUnderflow { t }
            }
        }
    }

    fn stand_at(&mut self, t: f64, y: &V) {
        (self.q, self.v) = split::<S>(y.components());
        self.t = t;
        self.p = self.equations.mechanics.momentum_at(t, &self.q, &self.v);
    }
}

impl<S: MechanicalSystem, V: Integrated> Solver for Run<S, V> {
    fn t(&self) -> f64 {
        self.t
    }

    fn q(&self) -> &[f64] {
        self.q.as_ref()
    }

    fn v(&self) -> &[f64] {
        self.v.as_ref()
    }

    fn p(&self) -> &[f64] {
        self.p.as_ref()
    }

    fn steps(&self) -> u64 {
        self.steps
    }

    fn advance_to(&mut self, t: f64) -> Result<(), Failure> {
        let (steps, outcome) = self.integrate(t);
        let (times, points) = steps.get();
        if let (Some(t), Some(y)) = (times.last(), points.last()) {
            self.stand_at(*t, y);
        }
        Ok(outcome?)
    }

    fn advance_visiting(&mut self, t: f64, visit: &mut dyn FnMut(&dyn Solver)) -> Result<(), Failure> {
        let before = self.steps;
        let (steps, outcome) = self.integrate(t);
        let (times, points) = steps.get();
        for (k, (t, y)) in times.iter().zip(points).enumerate().skip(1) {
            self.steps = before + k as u64;
            self.stand_at(*t, y);
            visit(self);
        }
        Ok(outcome?)
    }
}
