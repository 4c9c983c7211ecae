//! Watching a run, step by step.
//!
//! In: a run, and an [`Observer`] that sees it after every step. Out: the run at the time asked for, or why it [`Ended`] before. An observer is a
//! type: what it does not look at is not computed, and [`Run::advance_to`] knows nothing of observers.

#[cfg(feature = "std")]
mod assembled;
#[cfg(feature = "std")]
mod energy_drift;
mod limits;
mod watched;

use core::fmt;
use core::ops::ControlFlow;

use crate::integrator::{OneStep, Run, StepError, Tally};
use crate::mechanics::State;
use crate::system::MechanicalSystem;

#[cfg(feature = "std")]
pub use energy_drift::EnergyDrift;
pub use limits::{Limits, Stopped};
pub use watched::Watched;

/// Sees a run after every step, and may stop it.
///
/// A closure is one: `|run: &Run<Pendulum, _>| ControlFlow::Continue::<()>(..)`; so is a pair of observers, of which the second sees what the
/// first has let pass. [`every`] takes one that is to see some of the steps only. Those that ask for no more than [`Watched`] has see runs of one body
/// and of ten thousand alike.
///
/// ```
/// use std::convert::Infallible;
/// use std::ops::ControlFlow;
/// use evi_core::prelude::*;
/// use evi_core::watch::{Ended, Limits, Stopped};
/// # #[derive(MechanicalSystem)]
/// # #[evi(coordinates(theta), kinetic = 0.5 * der(theta).powi(2), potential = -rate.powi(2) * theta.cos())]
/// # struct Pendulum { rate: f64 }
/// let mut run = Simulation::new(Pendulum { rate: 3.0 }, Evi::midpoint(0.01)).start([1.0], [0.0])?;
/// let mut largest = 0.0_f64;
/// let mut swing = |run: &Run<Pendulum, _>| -> ControlFlow<Infallible> {
///     largest = largest.max(run.state().q()[0].abs());
///     ControlFlow::Continue(())
/// };
/// run.advance_observed(10.0, &mut swing)?;
/// assert!((largest - 1.0).abs() < 1e-3);
///
/// let mut limits = Limits::of(&run).steps(500);
/// let ended = run.advance_observed(20.0, &mut limits).unwrap_err();
/// assert_eq!(ended, Ended::Stopped(Stopped::Steps { steps: 500 }));
/// assert_eq!(run.steps(), 1500);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Observer<R> {
    /// Why it stops a run; [`Infallible`](core::convert::Infallible) if it never does.
    type Reason;

    /// Sees the run after a step, at the end of that step. The run ends there if this breaks.
    fn see(&mut self, run: &R) -> ControlFlow<Self::Reason>;
}

impl<R, X, F: FnMut(&R) -> ControlFlow<X>> Observer<R> for F {
    type Reason = X;

    #[inline]
    fn see(&mut self, run: &R) -> ControlFlow<X> {
        self(run)
    }
}

impl<R, A: Observer<R>, B: Observer<R>> Observer<R> for (A, B) {
    type Reason = Either<A::Reason, B::Reason>;

    #[inline]
    fn see(&mut self, run: &R) -> ControlFlow<Self::Reason> {
        let (first, second) = self;
        if let ControlFlow::Break(reason) = first.see(run) {
            return ControlFlow::Break(Either::First(reason));
        }
        match second.see(run) {
            ControlFlow::Break(reason) => ControlFlow::Break(Either::Second(reason)),
            ControlFlow::Continue(()) => ControlFlow::Continue(()),
        }
    }
}

/// An observer of some of the steps; see [`every`].
#[derive(Clone, Copy, Debug)]
pub struct Every<O> {
    steps: u64,
    observer: O,
}

/// Shows `observer` the run whenever the number of its steps is a multiple of `steps`; never if that is 0.
///
/// ```
/// use std::convert::Infallible;
/// use std::ops::ControlFlow;
/// use evi_core::prelude::*;
/// use evi_core::watch::every;
/// # #[derive(MechanicalSystem)]
/// # #[evi(coordinates(theta), kinetic = 0.5 * der(theta).powi(2), potential = -rate.powi(2) * theta.cos())]
/// # struct Pendulum { rate: f64 }
/// let mut run = Simulation::new(Pendulum { rate: 3.0 }, Evi::midpoint(0.01)).start([1.0], [0.0])?;
/// let mut checkpoints = Vec::new();
/// let mut keep = every(250, |run: &Run<Pendulum, _>| -> ControlFlow<Infallible> {
///     checkpoints.push(run.checkpoint());
///     ControlFlow::Continue(())
/// });
/// run.advance_observed(10.0, &mut keep)?;
/// assert_eq!(checkpoints.iter().map(Checkpoint::steps).collect::<Vec<_>>(), [250, 500, 750, 1000]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub const fn every<O>(steps: u64, observer: O) -> Every<O> {
    Every { steps, observer }
}

impl<R: Watched, O: Observer<R>> Observer<R> for Every<O> {
    type Reason = O::Reason;

    #[inline]
    fn see(&mut self, run: &R) -> ControlFlow<O::Reason> {
        if run.n_steps().is_multiple_of(self.steps) {
            self.observer.see(run)
        } else {
            ControlFlow::Continue(())
        }
    }
}

/// A reason of one of two observers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Either<A, B> {
    /// The first one has stopped the run.
    First(A),
    /// The second one has.
    Second(B),
}

/// Why a run has ended before the time that it was to reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ended<R> {
    /// The next step could not be taken.
    Failed(StepError),
    /// An observer has stopped the run, after the step that it saw.
    Stopped(R),
}

impl<R> From<StepError> for Ended<R> {
    fn from(error: StepError) -> Self {
        Self::Failed(error)
    }
}

impl<A: fmt::Display, B: fmt::Display> fmt::Display for Either<A, B> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::First(reason) => reason.fmt(formatter),
            Self::Second(reason) => reason.fmt(formatter),
        }
    }
}

impl<R: fmt::Display> fmt::Display for Ended<R> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Failed(error) => error.fmt(formatter),
            Self::Stopped(reason) => write!(formatter, "stopped: {reason}"),
        }
    }
}

impl<A: fmt::Debug + fmt::Display, B: fmt::Debug + fmt::Display> core::error::Error for Either<A, B> {}

impl<R: fmt::Debug + fmt::Display> core::error::Error for Ended<R> {}

impl<S: MechanicalSystem, M: OneStep<S>, T: Tally> Run<S, M, T> {
    /// As [`advance_to`](Self::advance_to), under the eyes of an observer.
    ///
    /// # Errors
    /// [`Ended::Failed`] as `advance_to` fails; the run stands before the step. [`Ended::Stopped`] with the observer's reason; the run stands at the
    /// state that the observer has seen, and can go on from there.
    pub fn advance_observed<O: Observer<Self>>(
        &mut self,
        t: f64,
        observer: &mut O,
    ) -> Result<&State<S>, Ended<O::Reason>> {
        for _ in 0..self.steps_to(t)? {
            self.advance()?;
            if let ControlFlow::Break(reason) = observer.see(self) {
                return Err(Ended::Stopped(reason));
            }
        }
        Ok(self.state())
    }
}
