//! The runs and what is measured in each.

use std::fmt;
use std::time::Instant;

use evi_core::baseline::{Rattle, Rk4};
use evi_core::prelude::*;
use evi_examples::{DoublePendulum, GRAVITY, Start};

/// Step sizes of the short runs, s.
const STEP_SIZES: [f64; 3] = [1e-1, 1e-2, 1e-3];
/// Steps of the short runs.
const SHORT: u64 = 100;
/// Steps of the long runs.
const LONG: u64 = 20_000;
/// Errors over time are recorded as the largest of so many steps.
const WINDOW: u64 = 100;
/// A run that stops with an energy error beyond this had left the pendulum's energies, about 60 J, long before, J.
const DIVERGED: f64 = 1e6;
/// Frequency of the slow normal mode of the hanging double pendulum, √(2 − √2) √(g/l), rad/s.
const SLOW_MODE: f64 = 2.397;

/// Where the pendulum starts, at rest.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum InitialState {
    /// Both rods horizontal: chaotic motion.
    Horizontal,
    /// Both rods 0.1 rad from the downward vertical: regular motion.
    Mild,
}

/// What integrates.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Method {
    /// Exponential variational integrator with 1 (midpoint) or 3 (Simpson) nodes; linear at `omega = 0`.
    Evi {
        nodes: usize,
        omega: f64,
    },
    Rk4,
    Rattle,
}

/// One run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    pub(crate) state: InitialState,
    pub(crate) method: Method,
    /// Step size, s.
    pub(crate) h: f64,
    pub(crate) steps: u64,
}

/// What a run showed.
#[derive(Clone, Debug)]
pub(crate) struct Measurement {
    pub(crate) case: Case,
    pub(crate) steps_done: u64,
    /// `max |H − H₀|`, J.
    pub(crate) max_energy_error: f64,
    /// `max |φ|`, m².
    pub(crate) max_constraint_error: f64,
    /// `max |G v| / (‖G‖ ‖v‖)`.
    pub(crate) max_hidden_constraint_error: f64,
    /// Time of the steps alone, s.
    pub(crate) seconds: f64,
    /// Why the run ended before its time.
    pub(crate) stopped: Option<StepError>,
    /// `(t, max |H − H₀|)` of consecutive windows.
    pub(crate) energy_over_time: Vec<(f64, f64)>,
}

/// 100 steps with each step size.
pub(crate) fn short_runs() -> Vec<Measurement> {
    let mut measurements = Vec::new();
    for state in [InitialState::Horizontal, InitialState::Mild] {
        for method in methods() {
            let cases = STEP_SIZES.map(|h| Case { state, method, h, steps: SHORT });
            measurements.extend(cases.into_iter().map(measure));
        }
    }
    measurements
}

/// 20,000 steps with one step size for each start.
pub(crate) fn long_runs() -> Vec<Measurement> {
    let mut measurements = Vec::new();
    for (state, h) in [(InitialState::Horizontal, 0.01), (InitialState::Mild, 0.05)] {
        let cases = methods().into_iter().map(|method| Case { state, method, h, steps: LONG });
        measurements.extend(cases.map(measure));
    }
    measurements
}

/// Every method, in the order of tables and legends.
pub(crate) fn methods() -> Vec<Method> {
    let omegas = [0.0, (GRAVITY / DoublePendulum::UNIT.l1).sqrt(), SLOW_MODE];
    let evi = |nodes| omegas.map(|omega| Method::Evi { nodes, omega });
    evi(1).into_iter().chain(evi(3)).chain([Method::Rattle, Method::Rk4]).collect()
}

fn measure(case: Case) -> Measurement {
    let h = case.h;
    match case.method {
        Method::Evi { nodes: 1, omega: 0.0 } => measure_with(Evi::midpoint(h), case),
        Method::Evi { nodes: 1, omega } => measure_with(Evi::midpoint(h).frequency(omega), case),
        Method::Evi { omega: 0.0, .. } => measure_with(Evi::simpson(h), case),
        Method::Evi { omega, .. } => measure_with(Evi::simpson(h).frequency(omega), case),
        Method::Rk4 => measure_with(Rk4::new(h), case),
        Method::Rattle => measure_with(Rattle::new(h), case),
    }
}

fn measure_with<F: Scheme<DoublePendulum>>(scheme: F, case: Case) -> Measurement {
    let system = DoublePendulum::UNIT;
    let Start { q, v } = match case.state {
        InitialState::Horizontal => system.horizontal(),
        InitialState::Mild => system.at_angles(0.1, 0.1),
    };
    let simulation = Simulation::new(system, scheme);
    let start =
        || simulation.start(q, v).expect("the starts are consistent and the frequencies not resonant");

    let mut run = start();
    let initial_energy = run.energy();
    let mut measurement = Measurement {
        case,
        steps_done: 0,
        max_energy_error: 0.0,
        max_constraint_error: 0.0,
        max_hidden_constraint_error: 0.0,
        seconds: 0.0,
        stopped: None,
        energy_over_time: Vec::new(),
    };
    let mut window_error = 0.0_f64;
    for step in 1..=case.steps {
        if let Err(error) = run.advance() {
            measurement.stopped = Some(error);
            break;
        }
        let (mechanics, state) = (run.mechanics(), run.state());
        let energy_error = (mechanics.energy(state) - initial_energy).abs();
        measurement.steps_done = step;
        raise(&mut measurement.max_energy_error, [energy_error]);
        raise(&mut measurement.max_constraint_error, mechanics.constraint_residual(state));
        raise(&mut measurement.max_hidden_constraint_error, mechanics.hidden_constraint_residual(state));
        raise(&mut window_error, [energy_error]);
        if step % WINDOW == 0 {
            measurement.energy_over_time.push((state.t(), std::mem::take(&mut window_error)));
        }
    }

    // Once more without the measurements, for the time of the steps.
    let mut run = start();
    let clock = Instant::now();
    for _ in 0..measurement.steps_done {
        run.advance().expect("the same steps succeeded above");
    }
    measurement.seconds = clock.elapsed().as_secs_f64();
    measurement
}

/// Raises `largest` to the largest magnitude among `values`.
fn raise(largest: &mut f64, values: impl IntoIterator<Item = f64>) {
    for value in values {
        *largest = largest.max(value.abs());
    }
}

impl Measurement {
    /// `ok`, or what stopped the run, and where.
    pub(crate) fn status(&self) -> String {
        let step = self.steps_done + 1;
        match self.stopped {
            None => "ok".to_owned(),
            Some(_) if self.max_energy_error > DIVERGED => format!("diverged at step {step}"),
            Some(StepError::NoSolution { .. }) => format!("no solution found at step {step}"),
            Some(StepError::Singular { .. }) => format!("singular equations at step {step}"),
            Some(error) => format!("{error}, at step {step}"),
        }
    }
}

impl fmt::Display for InitialState {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Horizontal => "horizontal",
            Self::Mild => "mild",
        })
    }
}

impl Method {
    /// Short name for tables.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Evi { .. } => "EVI",
            Self::Rk4 => "RK4",
            Self::Rattle => "RATTLE",
        }
    }

    /// Number of nodes, for methods that have a choice.
    pub(crate) const fn nodes(self) -> Option<usize> {
        match self {
            Self::Evi { nodes, .. } => Some(nodes),
            Self::Rk4 | Self::Rattle => None,
        }
    }

    /// Frequency, for methods that have one.
    pub(crate) const fn omega(self) -> Option<f64> {
        match self {
            Self::Evi { omega, .. } => Some(omega),
            Self::Rk4 | Self::Rattle => None,
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Evi { nodes, omega: 0.0 } => write!(formatter, "EVI S={nodes}, u=0"),
            Self::Evi { nodes, omega } => write!(formatter, "EVI S={nodes}, ω={omega:.3}"),
            Self::Rk4 | Self::Rattle => formatter.write_str(self.name()),
        }
    }
}
