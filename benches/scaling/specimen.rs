//! A scene of many bodies with its start, and the methods that take its steps.

use evi_core::assembled::{
    AssembledRun, AssembledScheme, AssembledSimulation, AssembledStep, AssembledSystem,
};
use evi_core::integrator::Statistics;
use evi_core::prelude::*;

/// A scene with its start and the time on which its shortest rod swings.
#[derive(Clone)]
pub(crate) struct Specimen<S> {
    pub(crate) scene: &'static str,
    pub(crate) bodies: usize,
    system: S,
    q: Vec<f64>,
    v: Vec<f64>,
    /// `√(l/g)` of a rod.
    time: f64,
}

/// Step sizes as shares of the time on which a rod swings: the same difficulty for chains of all lengths.
const STEP: f64 = 0.02;
const GALERKIN_STEP: f64 = 0.05;
/// How long is measured, in that time: before the net falls together and the ring closes, where no rod is slack any more.
const SPAN: f64 = 3.0;

/// A run of any scene by any method.
pub(crate) trait Steps {
    /// Takes so many steps.
    fn take(&mut self, steps: u64) -> Result<(), StepError>;

    /// Takes the steps that lead nearest to `t`.
    fn advance_to(&mut self, t: f64) -> Result<(), StepError>;

    /// Where it is.
    fn q(&self) -> &[f64];

    /// Steps so far.
    fn steps(&self) -> u64;

    /// Newton corrections so far.
    fn corrections(&self) -> u64;

    /// Largest `|φ|`.
    fn constraint_error(&self) -> f64;
}

/// Begins runs of one scene by one method.
pub(crate) struct Row {
    pub(crate) scene: &'static str,
    pub(crate) bodies: usize,
    pub(crate) method: &'static str,
    /// Steps of the time that is measured.
    pub(crate) steps: u64,
    start: Box<dyn Fn() -> Result<Box<dyn Steps>, String>>,
}

impl Row {
    pub(crate) fn start(&self) -> Result<Box<dyn Steps>, String> {
        (self.start)()
    }
}

impl<S: AssembledSystem + Clone + 'static> Specimen<S> {
    /// With rods of length `l`, from positions and velocities.
    pub(crate) fn moving(
        scene: &'static str,
        bodies: usize,
        l: f64,
        system: S,
        q: Vec<f64>,
        v: Vec<f64>,
    ) -> Self {
        Self { scene, bodies, system, q, v, time: (l / evi_examples::GRAVITY).sqrt() }
    }

    /// From rest.
    pub(crate) fn at_rest(scene: &'static str, bodies: usize, l: f64, system: S, q: Vec<f64>) -> Self {
        let v = vec![0.0; q.len()];
        Self::moving(scene, bodies, l, system, q, v)
    }

    /// The methods that the table has.
    pub(crate) fn rows(&self) -> Vec<Row> {
        let h = STEP * self.time;
        let galerkin = Galerkin::<8>::new(GALERKIN_STEP * self.time);
        vec![
            self.row("midpoint", SPAN / STEP, Evi::midpoint(h)),
            self.row("midpoint_4", SPAN / STEP, Evi::midpoint(h).composed(Composition::suzuki_4())),
            self.row("midpoint_6", SPAN / STEP, Evi::midpoint(h).composed(Composition::kahan_li_6())),
            self.row("galerkin_8", SPAN / GALERKIN_STEP, galerkin),
        ]
    }

    /// The scene by one scheme, of which so many steps are measured.
    pub(crate) fn row<F>(&self, method: &'static str, steps: f64, scheme: F) -> Row
    where
        F: AssembledScheme + Clone + 'static,
        F::Step: 'static,
    {
        let Self { scene, bodies, system, q, v, .. } = self.clone();
        let start = move || {
            let simulation = AssembledSimulation::new(system.clone(), scheme.clone());
            let run = simulation.start(q.clone(), v.clone()).map_err(|error| error.to_string())?;
            Ok(Box::new(run.with_tally(Statistics::default())) as Box<dyn Steps>)
        };
        Row { scene, bodies, method, steps: steps.round() as u64, start: Box::new(start) }
    }
}

impl<S: AssembledSystem, M: AssembledStep> Steps for AssembledRun<S, M, Statistics> {
    fn take(&mut self, steps: u64) -> Result<(), StepError> {
        (0..steps).try_for_each(|_| self.advance().map(drop))
    }

    fn advance_to(&mut self, t: f64) -> Result<(), StepError> {
        Self::advance_to(self, t).map(drop)
    }

    fn q(&self) -> &[f64] {
        self.state().q()
    }

    fn steps(&self) -> u64 {
        Self::steps(self)
    }

    fn corrections(&self) -> u64 {
        self.tally().corrections
    }

    fn constraint_error(&self) -> f64 {
        Self::constraint_error(self)
    }
}
