//! The table of methods.

use evi_core::baseline::{GeneralizedAlpha, ImplicitMidpoint, Rattle, Rk4, Shake};
use evi_core::comparison::{Failure, Solver};
use evi_core::generic::{GenericEvi, GenericGalerkin, GenericScheme};
use evi_core::prelude::*;

use super::{Motion, Refusal, Subject};
use crate::external::{self, DiffsolError, DiffsolMethod, Tolerances, diffsol};

/// A method and how it starts on scenes of type `S`.
pub struct Method<S: MechanicalSystem> {
    /// What there is to say about it.
    pub facts: MethodFacts,
    /// A solver at the start of a motion, with the given step size or tolerance.
    pub start: Start<S>,
}

/// Starts a solver on a motion with a step size or a tolerance.
pub type Start<S> = fn(&Motion<S>, f64) -> Result<Box<dyn Solver>, Failure>;

/// What there is to say about a method, whatever the scene.
#[derive(Clone, Copy, Debug)]
pub struct MethodFacts {
    /// Name on the command line and in files, in snake case.
    pub name: &'static str,
    /// How it comes to its equations.
    pub path: Path,
    /// On whose side it stands.
    pub role: Role,
    /// Power of the step size to which errors fall.
    pub order: u32,
    /// What it is run with.
    pub resolution: Resolution,
    /// One sentence.
    pub summary: &'static str,
}

/// How a method comes to the equations of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Path {
    /// By the kernels that the derive emits.
    Specialised,
    /// On sizes known at run time, with derivatives by dual numbers.
    Generic,
    /// A solver from elsewhere; its right side are the specialised kernels.
    External,
    /// A program from elsewhere, with its own equations; it gives ends of motions, not solvers.
    Program,
}

impl Path {
    /// As in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Specialised => "specialised",
            Self::Generic => "generic",
            Self::External | Self::Program => "external",
        }
    }
}

/// On whose side a method stands in a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A method that this project exists for.
    Member,
    /// A method to compare with.
    Baseline,
}

impl Role {
    /// Whether it is [`Member`](Self::Member).
    pub const fn is_member(self) -> bool {
        matches!(self, Self::Member)
    }
}

/// What determines how exact a method is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resolution {
    /// The size of its steps, all alike.
    StepSize,
    /// A tolerance, by which it chooses its steps.
    Tolerance,
}

/// Every method that the report compares, for scenes of type `S`; one that a scene does not admit says so when it starts.
pub fn all<S: Subject>() -> Vec<Method<S>> {
    vec![
        midpoint(),
        midpoint_4(),
        midpoint_6(),
        midpoint_8(),
        trapezoid(),
        trapezoid_4(),
        trapezoid_6(),
        trapezoid_8(),
        exponential(),
        exponential_8(),
        galerkin_4(),
        galerkin_8(),
        gauss_4(),
        gauss_8(),
        rattle(),
        shake(),
        implicit_midpoint(),
        generalized_alpha(),
        rk4(),
        midpoint_generic(),
        midpoint_8_generic(),
        galerkin_8_generic(),
        dop853(),
        diffsol_bdf(),
        diffsol_esdirk(),
        heyoka(),
    ]
}

/// Methods as functions, one each: a program compiles those that it names.
macro_rules! methods {
    ($($kind:ident $name:ident: $order:literal, $summary:literal, $start:expr;)*) => {
        $(#[doc = concat!("`", stringify!($name), "`: ", $summary, ".")]
        pub fn $name<S: Subject>() -> Method<S> {
            $kind(stringify!($name), $order, $summary, $start)
        })*
    };
}
methods! {
    member midpoint: 2, "variational, midpoint rule", |m, h| run(m, Evi::midpoint(h));
    member midpoint_compensated: 2, "variational, midpoint rule, compensated summation", |m, h| {
        run(m, Evi::midpoint(h).compensated())
    };
    member midpoint_4: 4, "5 midpoint steps composed (Suzuki)", |m, h| {
        run(m, Evi::midpoint(h).composed(Composition::suzuki_4()))
    };
    member midpoint_6: 6, "9 midpoint steps composed (Kahan, Li)", |m, h| {
        run(m, Evi::midpoint(h).composed(Composition::kahan_li_6()))
    };
    member midpoint_8: 8, "17 midpoint steps composed (Kahan, Li)", |m, h| {
        run(m, Evi::midpoint(h).composed(Composition::kahan_li_8()))
    };
    member trapezoid: 2, "variational, trapezoidal rule: leapfrog or RATTLE", |m, h| run(m, Evi::trapezoid(h));
    member trapezoid_4: 4, "5 trapezoid steps composed (Suzuki)", |m, h| {
        run(m, Evi::trapezoid(h).composed(Composition::suzuki_4()))
    };
    member trapezoid_6: 6, "9 trapezoid steps composed (Kahan, Li)", |m, h| {
        run(m, Evi::trapezoid(h).composed(Composition::kahan_li_6()))
    };
    member trapezoid_8: 8, "17 trapezoid steps composed (Kahan, Li)", |m, h| {
        run(m, Evi::trapezoid(h).composed(Composition::kahan_li_8()))
    };
    member simpson: 2, "variational, Simpson's rule", |m, h| run(m, Evi::simpson(h));
    member midpoint_trig: 2, "midpoint rule on curves of the motion's frequency", |m, h| {
        run(m, Evi::midpoint(h).frequency(frequency(m)?))
    };
    member trapezoid_trig: 2, "trapezoidal rule on curves of the motion's frequency", |m, h| {
        run(m, Evi::trapezoid(h).frequency(frequency(m)?))
    };
    member simpson_trig: 2, "Simpson's rule on curves of the motion's frequency", |m, h| {
        run(m, Evi::simpson(h).frequency(frequency(m)?))
    };
    member exponential: 2, "impulse method: quadratic part at an equilibrium exact", |m, h| {
        run(m, Evi::trapezoid(h).linearised_at(equilibrium(m)?))
    };
    member exponential_8: 8, "17 exponential steps composed (Kahan, Li)", |m, h| {
        run(m, Evi::trapezoid(h).linearised_at(equilibrium(m)?).composed(Composition::kahan_li_8()))
    };
    member galerkin_4: 8, "variational, Lobatto IIIA-IIIB with 5 stages", |m, h| run(m, Galerkin::<4>::new(h));
    member galerkin_8: 16, "variational, Lobatto IIIA-IIIB with 9 stages", |m, h| run(m, Galerkin::<8>::new(h));
    member gauss_4: 8, "variational, Gauss collocation with 4 nodes", |m, h| run(m, Gauss::<4>::new(h));
    member gauss_8: 16, "variational, Gauss collocation with 8 nodes", |m, h| run(m, Gauss::<8>::new(h));
    baseline rattle: 2, "leapfrog on the constraints", |m, h| run(m, Rattle::new(h));
    baseline shake: 2, "leapfrog on the constraints, velocities by differences", |m, h| run(m, Shake::new(h));
    baseline implicit_midpoint: 2, "implicit midpoint rule", |m, h| run(m, ImplicitMidpoint::new(h));
    baseline generalized_alpha: 2, "generalized-α, index 3", |m, h| run(m, GeneralizedAlpha::new(h));
    baseline rk4: 4, "explicit Runge-Kutta, index-1 equations", |m, h| run(m, Rk4::new(h));
    generic midpoint_generic: 2, "midpoint on matrices of run-time size, dual numbers", |m, h| {
        run_generic(m, &GenericEvi::midpoint(h))
    };
    generic midpoint_8_generic: 8, "the same, 17 steps composed (Kahan, Li)", |m, h| {
        run_generic(m, &GenericEvi::midpoint(h).composed(Composition::kahan_li_8()))
    };
    generic galerkin_8_generic: 16, "the member of 9 stages by Newton's iteration on dense matrices", |m, h| {
        run_generic(m, &GenericGalerkin::new(8, h))
    };
    external dop853: 8, "explicit Runge-Kutta, index-1 equations, crate ode_solvers", |m, tolerance| {
        Ok(external::dop853(&m.system, &m.q, &m.v, Tolerances::both(tolerance))?)
    };
    external diffsol_bdf: 5, "BDF, index-1 equations, crate diffsol", |m, tolerance| {
        run_of_diffsol(m, DiffsolMethod::Bdf, tolerance)
    };
    external diffsol_esdirk: 3, "ESDIRK34, index-1 equations, crate diffsol", |m, tolerance| {
        run_of_diffsol(m, DiffsolMethod::Esdirk34, tolerance)
    };
    program heyoka: 20, "Taylor series, index-1 equations, compiled by heyoka", |_, _| {
        Err(Refusal::NotRun { reason: "a program of its own, asked for with --peers".into() }.into())
    };
}

fn equilibrium<S: Subject>(motion: &Motion<S>) -> Result<S::PerCoordinate<f64>, Refusal> {
    motion.equilibrium.clone().ok_or(Refusal::NoEquilibrium)
}

fn frequency<S: Subject>(motion: &Motion<S>) -> Result<Frequency, Refusal> {
    motion.frequency.ok_or(Refusal::NoFrequency)
}

/// A row of the table on one path; what comes from elsewhere chooses its steps by a tolerance.
macro_rules! rows {
    ($($kind:ident: $role:ident, $path:ident, $resolution:ident;)*) => {
        $(const fn $kind<S: MechanicalSystem>(name: &'static str, order: u32, summary: &'static str, start: Start<S>) -> Method<S> {
            let (path, role, resolution) = (Path::$path, Role::$role, Resolution::$resolution);
            Method { facts: MethodFacts { name, path, role, order, resolution, summary }, start }
        })*
    };
}
rows! {
    member: Member, Specialised, StepSize;
    baseline: Baseline, Specialised, StepSize;
    generic: Baseline, Generic, StepSize;
    external: Baseline, External, Tolerance;
    program: Baseline, Program, Tolerance;
}

fn run<S: Subject, F: Scheme<S, Step: 'static>>(
    Motion { system, q, v, .. }: &Motion<S>,
    scheme: F,
) -> Result<Box<dyn Solver>, Failure> {
    Ok(Box::new(Simulation::new(system.clone(), scheme).start(q.clone(), v.clone())?))
}

fn run_generic<S: Subject>(
    Motion { system, q, v, .. }: &Motion<S>,
    scheme: &impl GenericScheme,
) -> Result<Box<dyn Solver>, Failure> {
    Ok(Box::new(scheme.start(system.clone(), q.as_ref(), v.as_ref())?))
}

fn run_of_diffsol<S: Subject>(
    Motion { system, q, v, .. }: &Motion<S>,
    method: DiffsolMethod,
    tolerance: f64,
) -> Result<Box<dyn Solver>, Failure> {
    match diffsol(system, method, q, v, Tolerances::both(tolerance)) {
        Err(DiffsolError::NotBuilt) => Err(Refusal::NotBuilt { feature: "diffsol" }.into()),
        result => Ok(result?),
    }
}
