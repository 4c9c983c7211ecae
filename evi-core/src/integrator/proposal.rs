//! Which integrator takes the fewest evaluations to a wanted error: number of nodes and step size, from trial runs.
//!
//! In: a scene, its start, a horizon and the error wanted there. Out: a [`Proposal`] with what it expects, or why there is none.
//!
//! **Error.** The trial run with `n` steps is compared with that of `2n`: `ε(n) = ‖qₙ − q₂ₙ‖`, Euclidean over all coordinates, which is the error of the
//! first but for that of the second, smaller by `2^-2K`. The number of steps doubles until the wanted error lies between two that are known, and
//! the number for it is interpolated between them in logarithms: nothing relies on an order that coarse steps do not show yet.
//!
//! **Cost.** Passes, each of which evaluates the scene's kernels at all nodes once, a node per vector lane: those of the trial, per step. A
//! step that needs Newton's iteration counts as [`PASSES_OF_NEWTON`].
//!
//! **Horizon.** A trial has at most [`LONGEST_TRIAL`] coarse steps. Where the horizon is longer, it covers the beginning alone, and the error is
//! continued in proportion to time, as that of a symplectic step on a regular motion grows (Hairer, Lubich, Wanner, Geometric Numerical Integration,
//! 2nd ed., thm. X.3.1); a trial whose error grows faster is no basis for that, and is refused.

use super::{Galerkin, Gauss, Scheme, Simulation, StartError, Statistics, StepError};
use crate::array::Array;
use crate::system::MechanicalSystem;

/// What a step of Newton's iteration on all points costs, in passes.
pub const PASSES_OF_NEWTON: f64 = 100.0;

/// The most coarse steps of a trial; its finest run has a few times as many.
pub const LONGEST_TRIAL: u64 = 256;

/// An integrator for a wanted error, and what it is expected to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proposal {
    /// The method.
    pub member: Member,
    /// Step size: a whole number of steps leads to the horizon.
    pub h: f64,
    /// Number of these steps.
    pub steps: u64,
    /// Position error that is expected at the horizon, Euclidean over all coordinates.
    pub expected_error: f64,
    /// Passes that the run is expected to take.
    pub expected_passes: f64,
}

/// A method with its number of nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Member {
    /// [`Galerkin`] with so many intervals.
    Galerkin(usize),
    /// [`Gauss`] with so many nodes: without constraints, where the mass varies.
    Gauss(usize),
}

/// Why no integrator is proposed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProposalError {
    /// The horizon or the wanted error is no positive number.
    #[error("horizon and error must be finite and positive, got {horizon:e} and {error:e}")]
    Wanted {
        /// The horizon.
        horizon: f64,
        /// The error wanted.
        error: f64,
    },
    /// The trial does not start.
    #[error(transparent)]
    Start(#[from] StartError),
    /// No trial run arrives: its steps fail, however small.
    #[error("no trial run arrives, with {steps} steps as little as before: {cause}")]
    Step {
        /// Number of steps of the last trial.
        steps: u64,
        /// Why it ended.
        cause: StepError,
    },
    /// Trials with more and more steps do not approach each other.
    #[error("trials with up to {steps} steps still differ by {difference:e}")]
    NotResolved {
        /// Number of steps of the finest.
        steps: u64,
        /// By how much it differs from the one before.
        difference: f64,
    },
    /// The wanted error is below what round-off leaves.
    #[error(
        "an error of {wanted:e} is below round-off: trials differ by {reached:e} however small their steps"
    )]
    RoundOff {
        /// The error wanted.
        wanted: f64,
        /// What trials differ by at the horizon.
        reached: f64,
    },
    /// The error grows faster than a regular motion's, so that a part of the horizon does not tell that of the whole.
    #[error(
        "from half of a trial of {trial:?} to its end the error grows {factor:.1e} times: that does not tell it at {horizon:?}"
    )]
    Growth {
        /// Time of the trial.
        trial: f64,
        /// Growth of the error over its second half.
        factor: f64,
        /// The horizon.
        horizon: f64,
    },
}

/// The integrator among `Galerkin` (`Gauss` for a mass that varies, without constraints) with 4 and with 8 nodes that is expected to reach the
/// horizon with the wanted position error in the fewest passes.
///
/// ```
/// use evi_core::integrator::{Member, propose};
/// use evi_core::prelude::*;
/// # #[derive(MechanicalSystem, Clone)]
/// # #[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential = -k * x.cos())]
/// # struct Pendulum { k: f64 }
/// let pendulum = Pendulum { k: 9.81 };
/// let proposal = propose(&pendulum, [1.0], [0.0], 10.0, 1e-9)?;
/// let mut run = match proposal.member {
///     Member::Galerkin(8) => Simulation::new(pendulum, Galerkin::<8>::new(proposal.h)).start([1.0], [0.0])?,
///     other => panic!("{other:?}"),
/// };
/// run.advance_to(10.0)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ProposalError`]: a start or an error that cannot be, trials that do not arrive or do not settle, an error below round-off, or a motion whose
/// error over the horizon does not follow from a trial.
pub fn propose<S: MechanicalSystem + Clone>(
    system: &S,
    q: impl Into<S::PerCoordinate<f64>>,
    v: impl Into<S::PerCoordinate<f64>>,
    horizon: f64,
    error: f64,
) -> Result<Proposal, ProposalError> {
    let is_sound = |x: f64| x.is_finite() && x > 0.0;
    if !(is_sound(horizon) && is_sound(error)) {
        return Err(ProposalError::Wanted { horizon, error });
    }
    let wanted = Wanted { system, q: q.into(), v: v.into(), horizon, error };
    if S::N_CONSTRAINTS == 0 && !S::STRUCTURE.is_separable_with_constant_mass() {
        cheaper(
            wanted.propose(Member::Gauss(4), 8.0, Gauss::<4>::new),
            wanted.propose(Member::Gauss(8), 16.0, Gauss::<8>::new),
        )
    } else {
        cheaper(
            wanted.propose(Member::Galerkin(4), 8.0, Galerkin::<4>::new),
            wanted.propose(Member::Galerkin(8), 16.0, Galerkin::<8>::new),
        )
    }
}

/// The proposal with fewer passes; an error only if both are.
fn cheaper(
    low: Result<Proposal, ProposalError>,
    high: Result<Proposal, ProposalError>,
) -> Result<Proposal, ProposalError> {
    match (low, high) {
        (Ok(low), Ok(high)) if low.expected_passes < high.expected_passes => Ok(low),
        (Ok(low), Err(_)) => Ok(low),
        (_, high) => high,
    }
}

/// What is wanted of which motion.
struct Wanted<'s, S: MechanicalSystem> {
    system: &'s S,
    q: S::PerCoordinate<f64>,
    v: S::PerCoordinate<f64>,
    horizon: f64,
    error: f64,
}

/// A run over the time of the trial.
struct Trial<S: MechanicalSystem> {
    steps: u64,
    middle: S::PerCoordinate<f64>,
    end: S::PerCoordinate<f64>,
    passes: f64,
}

/// A number of steps of a trial, the error that they have at the horizon, and passes per step.
#[derive(Clone, Copy)]
struct Known {
    steps: f64,
    error: f64,
    passes: f64,
}

impl<S: MechanicalSystem + Clone> Wanted<'_, S> {
    /// Numbers of steps are doubled from here.
    const FEWEST_STEPS: u64 = 8;
    /// Trials are doubled so often at most.
    const MOST_TRIALS: u32 = 40;
    /// Of the finest run of a trial.
    const MOST_STEPS: u64 = 32 * LONGEST_TRIAL;
    /// Differences that no longer shrink are round-off below this fraction of the configuration.
    const SMALL: f64 = 1e-9;
    /// Differences above this fraction of the configuration say nothing.
    const COARSE: f64 = 0.1;
    /// What is aimed at, as a fraction of the wanted error: errors are no smooth function of the step size.
    const AIM: f64 = 0.3;
    /// Growth of an error in proportion to the cube of time, over a second half.
    const FASTEST_GROWTH: f64 = 8.0;

    fn propose<F: Scheme<S>>(
        &self,
        member: Member,
        order: f64,
        scheme: impl Fn(f64) -> F,
    ) -> Result<Proposal, ProposalError> {
        let size = length(&self.q, &Array::from_fn(|_| 0.0)).max(f64::MIN_POSITIVE);
        let mut time = self.horizon;
        let mut steps = Self::FEWEST_STEPS;
        let mut before: Option<Trial<S>> = None;
        let mut known: Option<Known> = None;
        let mut last = ProposalError::NotResolved { steps, difference: f64::INFINITY };
        for _ in 0..Self::MOST_TRIALS {
            let coarse = before.take();
            match self.run(&scheme, time, steps) {
                Err(ProposalError::Step { cause, .. }) => last = ProposalError::Step { steps, cause },
                Err(other) => return Err(other),
                Ok(fine) => {
                    if let Some(coarse) = coarse {
                        let difference = length(&coarse.end, &fine.end);
                        let extrapolation = self.horizon / time;
                        let is_fine = difference <= Self::COARSE * size;
                        if is_fine {
                            self.check_growth(&coarse, &fine, difference, time)?;
                            let here = Known {
                                steps: coarse.steps as f64,
                                error: difference * extrapolation,
                                passes: coarse.passes / coarse.steps as f64,
                            };
                            if let Some(Known { steps, error, passes }) = self.settled(known, here, order)? {
                                let steps = (steps * extrapolation).ceil();
                                return Ok(Proposal {
                                    member,
                                    h: self.horizon / steps,
                                    steps: steps as u64,
                                    expected_error: error,
                                    expected_passes: steps * passes,
                                });
                            }
                            known = Some(here);
                        } else {
                            last = ProposalError::NotResolved { steps, difference };
                        }
                    }
                    before = Some(fine);
                }
            }
            let most = if known.is_some() { Self::MOST_STEPS } else { 2 * LONGEST_TRIAL };
            if 2 * steps <= most {
                steps *= 2;
            } else if known.is_none() {
                // Finer steps over a part of the horizon.
                (time, steps) = (0.5 * time, LONGEST_TRIAL);
                before = None;
            } else {
                break;
            }
        }
        Err(last)
    }

    /// The number of steps of a trial for the wanted error, if it does not lie beyond what is known.
    fn settled(
        &self,
        before: Option<Known>,
        here: Known,
        order: f64,
    ) -> Result<Option<Known>, ProposalError> {
        let aim = Self::AIM * self.error;
        match before {
            // Coarser steps are not known: those of the trial do.
            None => Ok((here.error <= aim).then_some(here)),
            Some(before) if here.error <= aim => {
                let slope = (before.error / here.error).log2().clamp(1.0, order);
                let doublings = ((here.error / aim).log2() / slope).max(-1.0);
                let passes = here.passes * (before.passes / here.passes).powf(-doublings);
                Ok(Some(Known { steps: here.steps * doublings.exp2(), error: aim, passes }))
            }
            Some(before) => {
                let is_small = here.error <= Self::SMALL * length(&self.q, &Array::from_fn(|_| 0.0));
                if is_small && here.error > 0.5 * before.error {
                    return Err(ProposalError::RoundOff { wanted: self.error, reached: here.error });
                }
                Ok(None)
            }
        }
    }

    /// Refuses a growth of the error that does not continue to the horizon in proportion to time.
    fn check_growth(
        &self,
        coarse: &Trial<S>,
        fine: &Trial<S>,
        difference: f64,
        time: f64,
    ) -> Result<(), ProposalError> {
        let factor = difference / length(&coarse.middle, &fine.middle);
        let is_regular = time >= self.horizon || factor <= Self::FASTEST_GROWTH;
        if is_regular {
            Ok(())
        } else {
            Err(ProposalError::Growth { trial: time, factor, horizon: self.horizon })
        }
    }

    fn run<F: Scheme<S>>(
        &self,
        scheme: &impl Fn(f64) -> F,
        time: f64,
        steps: u64,
    ) -> Result<Trial<S>, ProposalError> {
        let scheme = scheme(time / steps as f64);
        let run = Simulation::new(self.system.clone(), scheme).start(self.q.clone(), self.v.clone())?;
        let mut run = run.with_tally(Statistics::default());
        let mut middle = self.q.clone();
        for step in 1..=steps {
            let state = run.advance().map_err(|cause| ProposalError::Step { steps, cause })?;
            if 2 * step == steps {
                middle.clone_from(state.q());
            }
        }
        let tally = run.tally();
        let passes = tally.corrections as f64 + PASSES_OF_NEWTON * tally.newton_steps as f64;
        Ok(Trial { steps, middle, end: run.state().q().clone(), passes })
    }
}

/// `‖a − b‖`.
fn length<A: Array<f64>>(a: &A, b: &A) -> f64 {
    a.as_ref().iter().zip(b.as_ref()).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
