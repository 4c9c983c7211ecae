//! The paths: for each scene one start and one step size, and several ways to take the steps.

use evi_benches::hand_written::{
    ClosedFormSpringPendulum, HandWritten, HandWrittenDoublePendulum, HandWrittenSphericalPendulum,
    HandWrittenSpringPendulum,
};
use evi_core::baseline::{Dense, Rattle, Rk4};
use evi_core::generic::{GenericEvi, GenericRun, GenericScheme, GenericSystem};
use evi_core::integrator::{Statistics, Tally};
use evi_core::mechanics::Mechanics;
use evi_core::prelude::*;
use evi_examples::{DoublePendulum, SphericalPendulum, Start, StiffSpringPendulum};

const H: f64 = 0.01;

/// One way to take the steps of one scene.
pub(crate) struct Path {
    pub(crate) scene: &'static str,
    pub(crate) name: &'static str,
    /// Whether it is one of the four that every scene has.
    pub(crate) is_standard: bool,
    /// Takes so many steps from the scene's start, and returns a coordinate of the end. This is what is timed and counted.
    pub(crate) take: Box<dyn Fn(u64) -> f64>,
    /// Takes so many steps and looks at each.
    pub(crate) observe: Box<dyn Fn(u64) -> Observed>,
}

/// What the steps of a run have in common.
pub(crate) struct Observed {
    /// Newton corrections per step; 0 for a method without an iteration.
    pub(crate) mean_corrections: f64,
    /// Largest `|φ|`; `None` without constraints.
    pub(crate) max_constraint_error: Option<f64>,
}

/// A run of any kind.
trait Steps {
    /// The same run, with its corrections counted: what is timed does not count them.
    type Counted: Corrections;

    fn counted(self) -> Self::Counted;

    fn advance(&mut self);

    /// A coordinate, so that no step is superfluous.
    fn coordinate(&self) -> f64;

    /// Largest `|φ|`, if there are constraints.
    fn constraint_error(&self) -> Option<f64>;
}

/// A run whose corrections are counted.
trait Corrections: Steps {
    /// Newton corrections so far.
    fn corrections(&self) -> u64;
}

/// The three scenes, one after the other; in each the four standard paths first.
pub(crate) fn all() -> Vec<Path> {
    let mut paths = Vec::new();

    let pendulum = DoublePendulum::UNIT;
    let start = pendulum.at_angles(0.1, 0.1);
    let mut path = Paths { scene: "double_pendulum", paths: &mut paths };
    path.hand_written(pendulum, move || HandWrittenDoublePendulum::new(&pendulum, start, H));
    path.derived(pendulum, start);
    path.other("Simpson, ω", move || specialised(pendulum, Evi::simpson(H).frequency(2.397), start));
    path.other("linearised", move || {
        specialised(pendulum, Evi::trapezoid(H).linearised_at([0.0, -1.0, 0.0, -2.0]), start)
    });
    path.other("RATTLE", move || specialised(pendulum, Rattle::new(H), start));
    path.other("RK4", move || specialised(pendulum, Rk4::new(H), start));

    let pendulum = SphericalPendulum::UNIT;
    let start = pendulum.one_radian();
    let mut path = Paths { scene: "spherical_pendulum", paths: &mut paths };
    path.hand_written(pendulum, move || HandWrittenSphericalPendulum::new(&pendulum, start, H));
    path.derived(pendulum, start);
    path.other("RATTLE", move || specialised(pendulum, Rattle::new(H), start));

    let pendulum = StiffSpringPendulum::with_stiffness(1e4);
    let start = pendulum.horizontal();
    let mut path = Paths { scene: "stiff_spring_pendulum", paths: &mut paths };
    path.hand_written(pendulum, move || HandWrittenSpringPendulum::new(&pendulum, start, H));
    path.derived(pendulum, start);
    path.other("hand, in closed form", move || {
        Written::new(&pendulum, ClosedFormSpringPendulum::new(&pendulum, start, H))
    });
    paths
}

/// The paths of a scene, being gathered.
struct Paths<'p> {
    scene: &'static str,
    paths: &'p mut Vec<Path>,
}

impl Paths<'_> {
    fn add<R: Steps>(
        &mut self,
        name: &'static str,
        is_standard: bool,
        start: impl Fn() -> R + Copy + 'static,
    ) {
        let (take, observe) = (move |steps| take(start(), steps), move |steps| observe(start(), steps));
        let (take, observe) = (Box::new(take), Box::new(observe));
        self.paths.push(Path { scene: self.scene, name, is_standard, take, observe });
    }

    fn hand_written<const N: usize, S, R>(&mut self, system: S, start: impl Fn() -> R + Copy + 'static)
    where
        S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Copy + 'static,
        R: HandWritten<N>,
    {
        self.add("hand", true, move || Written::new(&system, start()));
    }

    /// The paths that need only the scene.
    fn derived<const N: usize, S>(&mut self, system: S, start: Start<N>)
    where
        S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + GenericSystem + Copy + 'static,
    {
        self.add("specialised", true, move || specialised(system, Evi::midpoint(H), start));
        self.add("dense", true, move || specialised(Dense(system), Evi::midpoint(H), start));
        self.add("generic", true, move || {
            GenericEvi::midpoint(H).start(system, &start.q, &start.v).expect("a consistent start")
        });
    }

    /// A path beside the standard ones.
    fn other<R: Steps>(&mut self, name: &'static str, start: impl Fn() -> R + Copy + 'static) {
        self.add(name, false, start);
    }
}

fn specialised<const N: usize, S, F>(system: S, scheme: F, start: Start<N>) -> Run<S, F::Step>
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S>,
{
    Simulation::new(system, scheme).start(start.q, start.v).expect("a consistent start")
}

fn take(mut run: impl Steps, steps: u64) -> f64 {
    for _ in 0..steps {
        run.advance();
    }
    run.coordinate()
}

fn observe(run: impl Steps, steps: u64) -> Observed {
    let mut run = run.counted();
    let mut max_constraint_error = run.constraint_error();
    for _ in 0..steps {
        run.advance();
        max_constraint_error = max_constraint_error.zip(run.constraint_error()).map(|(a, b)| larger(a, b));
    }
    Observed { mean_corrections: run.corrections() as f64 / steps as f64, max_constraint_error }
}

impl<S: MechanicalSystem, M: OneStep<S>, T: Tally> Steps for Run<S, M, T> {
    type Counted = Run<S, M, Statistics>;

    fn counted(self) -> Self::Counted {
        self.with_tally(Statistics::default())
    }

    fn advance(&mut self) {
        Run::advance(self).expect("steps small enough");
    }

    fn coordinate(&self) -> f64 {
        self.state().q()[0]
    }

    fn constraint_error(&self) -> Option<f64> {
        largest_magnitude(self.mechanics().constraint_residual(self.state()).as_ref())
    }
}

impl<S: MechanicalSystem, M: OneStep<S>> Corrections for Run<S, M, Statistics> {
    fn corrections(&self) -> u64 {
        self.tally().corrections
    }
}

impl<S: GenericSystem> Steps for GenericRun<S> {
    type Counted = Self;

    fn counted(self) -> Self {
        self
    }

    fn advance(&mut self) {
        GenericRun::advance(self).expect("steps small enough");
    }

    fn coordinate(&self) -> f64 {
        self.q()[0]
    }

    fn constraint_error(&self) -> Option<f64> {
        largest_magnitude(&self.constraint_residual())
    }
}

impl<S: GenericSystem> Corrections for GenericRun<S> {
    fn corrections(&self) -> u64 {
        self.statistics().corrections
    }
}

/// A run written by hand, with the scene's constraints to judge it by.
struct Written<S: MechanicalSystem, R, const COUNTS: bool> {
    run: R,
    mechanics: Mechanics<S>,
    /// Stays 0 unless it `COUNTS`.
    corrections: u64,
}

impl<S: MechanicalSystem, R> Written<S, R, false> {
    fn new(system: &S, run: R) -> Self {
        Self { run, mechanics: Mechanics::new(system), corrections: 0 }
    }
}

impl<const N: usize, S, R, const COUNTS: bool> Steps for Written<S, R, COUNTS>
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    R: HandWritten<N>,
{
    type Counted = Written<S, R, true>;

    fn counted(self) -> Self::Counted {
        let Self { run, mechanics, corrections } = self;
        Written { run, mechanics, corrections }
    }

    fn advance(&mut self) {
        let corrections = self.run.advance().expect("steps small enough");
        if COUNTS {
            self.corrections += u64::from(corrections);
        }
    }

    fn coordinate(&self) -> f64 {
        self.run.q()[0]
    }

    fn constraint_error(&self) -> Option<f64> {
        largest_magnitude(self.mechanics.constraint_residual_at(0.0, &self.run.q()).as_ref())
    }
}

impl<const N: usize, S, R> Corrections for Written<S, R, true>
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    R: HandWritten<N>,
{
    fn corrections(&self) -> u64 {
        self.corrections
    }
}

/// Largest magnitude; `None` of nothing.
fn largest_magnitude(residuals: &[f64]) -> Option<f64> {
    residuals.iter().map(|residual| residual.abs()).reduce(larger)
}

/// The larger of two magnitudes; NaN if one is.
fn larger(a: f64, b: f64) -> f64 {
    if a <= b || b.is_nan() { b } else { a }
}
