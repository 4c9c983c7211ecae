//! What runs of one motion are off by at several step sizes, and the orders that these errors show.

use evi_core::array::Array;
use evi_core::prelude::*;

use crate::motions::Motion;
use crate::{distance, observed_order};

/// Errors of the runs of one motion, one entry per step size.
#[derive(Clone, Default, Debug)]
pub struct Errors {
    /// Step sizes.
    pub h: Vec<f64>,
    /// Distance of the positions at the end.
    pub q: Vec<f64>,
    /// Distance of the velocities at the end.
    pub v: Vec<f64>,
    /// Distance of the index-1 multipliers at the end; empty without constraints.
    pub multipliers: Vec<f64>,
    /// Largest `|H − H₀|` at a step; empty where the energy is not conserved.
    pub energy: Vec<f64>,
}

impl Errors {
    /// Adds the errors of a run in `n` steps.
    ///
    /// # Errors
    /// [`StepError`] of a step that was not taken; nothing is added then.
    ///
    /// # Panics
    /// If the motion has no consistent start.
    pub fn measure<S, F>(&mut self, motion: &Motion<S>, n: u32, scheme: F) -> Result<(), StepError>
    where
        S: MechanicalSystem + Clone,
        F: Scheme<S>,
    {
        let simulation = Simulation::new(motion.system.clone(), scheme);
        let q0 = S::PerCoordinate::<f64>::from_fn(|i| motion.q0[i]);
        let v0 = S::PerCoordinate::<f64>::from_fn(|i| motion.v0[i]);
        let mut run = simulation.start(q0, v0).expect("a consistent start");
        let start_energy = run.energy();
        let mut energy_error = 0.0_f64;
        for _ in 0..n {
            run.advance()?;
            energy_error = energy_error.max((run.energy() - start_energy).abs());
        }
        let state = run.state();
        self.h.push(motion.t / f64::from(n));
        self.q.push(distance(state.q().as_ref(), &motion.q));
        self.v.push(distance(state.v().as_ref(), &motion.v));
        if !motion.multipliers.is_empty() {
            let recovered = run.mechanics().acceleration(state.t(), state.q(), state.v()).expect("regular");
            self.multipliers.push(distance(recovered.multipliers.as_ref(), &motion.multipliers));
        }
        if motion.conserves_energy {
            self.energy.push(energy_error);
        }
        Ok(())
    }
}

/// The errors of `motion` at its own numbers of steps.
///
/// # Panics
/// If a step is not taken.
#[track_caller]
pub fn measure<S, F>(motion: &Motion<S>, scheme: impl Fn(f64) -> F) -> Errors
where
    S: MechanicalSystem + Clone,
    F: Scheme<S>,
{
    let mut errors = Errors::default();
    for n in motion.steps {
        errors.measure(motion, n, scheme(motion.t / f64::from(n))).expect("every step");
    }
    errors
}

/// The order that the errors of one quantity show, where they are neither coarse nor round-off.
#[derive(Clone, Copy, Debug)]
pub struct Slope {
    /// Least-squares slope.
    pub order: f64,
    /// Number of step sizes that it comes from.
    pub points: usize,
    /// The smallest and the largest of these errors.
    pub window: [f64; 2],
}

/// The orders of all quantities of a motion.
#[derive(Clone, Copy, Debug)]
pub struct Orders {
    /// Of the positions.
    pub q: Slope,
    /// Of the velocities.
    pub v: Slope,
    /// Of the index-1 multipliers, if there are any.
    pub multipliers: Option<Slope>,
    /// Of the energy, where it is conserved.
    pub energy: Option<Slope>,
}

/// Errors in this window may show an order: the motion is resolved, and the round-off of thousands of steps is far.
pub const WINDOW: [f64; 2] = [2e-12, 1e-4];
/// The finest errors in the window make a slope: at least so many,
const FEWEST: usize = 5;
/// and all below so many times the smallest. The rate of coarser ones has not settled: the next terms of the expansion are as large.
const SPAN: f64 = 1e2;

/// The orders of a scheme on a motion, at step sizes that shrink by about `ratio` from `motion.t / coarsest` on, until every error
/// has left the [`WINDOW`].
///
/// # Panics
/// When fewer than five errors of a quantity lie in the window.
#[track_caller]
pub fn orders<S, F>(motion: &Motion<S>, coarsest: u32, ratio: f64, scheme: impl Fn(f64) -> F) -> Orders
where
    S: MechanicalSystem + Clone,
    F: Scheme<S>,
{
    /// Beyond, a run costs more than it shows.
    const MOST_STEPS: f64 = 20_000.0;
    let mut errors = Errors::default();
    let mut n = f64::from(coarsest);
    while n < MOST_STEPS {
        let steps = n.round() as u32;
        // A coarse step may have no solution; a finer one then has.
        let taken = errors.measure(motion, steps, scheme(motion.t / f64::from(steps))).is_ok();
        let latest = [&errors.q, &errors.v, &errors.multipliers, &errors.energy];
        if taken && latest.iter().all(|errors| errors.last().is_none_or(|error| *error < WINDOW[0])) {
            break;
        }
        n = (n * ratio).max(n + 1.0);
    }
    let slope = |errors_of: &[f64]| {
        let end = errors_of.iter().rposition(|error| *error >= WINDOW[0]).expect("a coarse error") + 1;
        let coarsest = errors_of[end - 1] * SPAN;
        let first = errors_of[..end].iter().rposition(|error| *error > coarsest).map_or(0, |last| last + 1);
        let range = first.min(end.saturating_sub(FEWEST))..end;
        let (h, inside) = (&errors.h[range.clone()], &errors_of[range]);
        let enough = inside.len() >= FEWEST && inside.iter().all(|error| *error <= WINDOW[1]);
        assert!(enough, "too few errors in the window: {errors_of:?} at {:?}", errors.h);
        let smallest = inside.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = inside.iter().copied().fold(0.0, f64::max);
        Slope { order: observed_order(h, inside), points: inside.len(), window: [smallest, largest] }
    };
    let known = |errors_of: &[f64]| (!errors_of.is_empty()).then(|| slope(errors_of));
    Orders {
        q: slope(&errors.q),
        v: slope(&errors.v),
        multipliers: known(&errors.multipliers),
        energy: known(&errors.energy),
    }
}

/// Checks the orders of `q`, `v`, the recovered multipliers and `H`, on step sizes that shrink by 1.15.
///
/// # Panics
/// When one is off.
#[track_caller]
pub fn check_orders<S, F>(motion: &Motion<S>, coarsest: u32, scheme: impl Fn(f64) -> F, order: f64)
where
    S: MechanicalSystem + Clone,
    F: Scheme<S>,
{
    /// Slopes over a factor of two in step size carry the next terms of the error expansion, which in compositions of many stages
    /// have large coefficients; 0.29 measured, 0.1 mostly.
    const TOLERANCE: f64 = 0.3;
    let found = orders(motion, coarsest, 1.15, scheme);
    let check = |quantity: &str, slope: Slope| {
        let Slope { order: observed, points, window: [smallest, largest] } = slope;
        println!("{quantity} {observed:.3} from {points} points, {smallest:.1e} to {largest:.1e}");
        assert!((observed - order).abs() <= TOLERANCE, "order of {quantity} is {observed:.3}, not {order}");
    };
    check("q", found.q);
    check("v", found.v);
    found.multipliers.into_iter().for_each(|slope| check("multipliers", slope));
    found.energy.into_iter().for_each(|slope| check("H", slope));
}
