//! The table of methods.

use evi_core::baseline::{GeneralizedAlpha, ImplicitMidpoint, Rattle, Rk4, Shake};
use evi_core::comparison::{Failure, Solver};
use evi_core::generic::{GenericEvi, GenericGalerkin, GenericScheme};
use evi_core::prelude::*;
use evi_examples::Scene;

use super::Refusal;
use crate::external::{DiffsolError, DiffsolMethod, Tolerances, diffsol, dop853};

/// A method and how it starts on scenes of type `S`.
pub struct Method<S> {
    /// What there is to say about it.
    pub facts: MethodFacts,
    /// A solver at the start of the scene's standard motion, with the given step size or tolerance.
    pub start: Start<S>,
}

/// Starts a solver on a scene with a step size or a tolerance.
pub type Start<S> = fn(&S, f64) -> Result<Box<dyn Solver>, Failure>;

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

/// Every method, for scenes of type `S`; one that a scene does not admit says so when it starts.
pub fn all<S: Scene>() -> Vec<Method<S>> {
    vec![
        member("midpoint", 2, "variational, midpoint rule", |s, h| run(s, Evi::midpoint(h))),
        member("midpoint_4", 4, "5 midpoint steps composed (Suzuki)", |s, h| {
            run(s, Evi::midpoint(h).composed(Composition::suzuki_4()))
        }),
        member("midpoint_6", 6, "9 midpoint steps composed (Kahan, Li)", |s, h| {
            run(s, Evi::midpoint(h).composed(Composition::kahan_li_6()))
        }),
        member("midpoint_8", 8, "17 midpoint steps composed (Kahan, Li)", |s, h| {
            run(s, Evi::midpoint(h).composed(Composition::kahan_li_8()))
        }),
        member("trapezoid", 2, "variational, trapezoidal rule: leapfrog or RATTLE", |s, h| {
            run(s, Evi::trapezoid(h))
        }),
        member("trapezoid_4", 4, "5 trapezoid steps composed (Suzuki)", |s, h| {
            run(s, Evi::trapezoid(h).composed(Composition::suzuki_4()))
        }),
        member("trapezoid_6", 6, "9 trapezoid steps composed (Kahan, Li)", |s, h| {
            run(s, Evi::trapezoid(h).composed(Composition::kahan_li_6()))
        }),
        member("trapezoid_8", 8, "17 trapezoid steps composed (Kahan, Li)", |s, h| {
            run(s, Evi::trapezoid(h).composed(Composition::kahan_li_8()))
        }),
        member("exponential", 2, "impulse method: quadratic part at an equilibrium exact", |s, h| {
            run(s, Evi::trapezoid(h).linearised_at(equilibrium(s)?))
        }),
        member("exponential_8", 8, "17 exponential steps composed (Kahan, Li)", |s, h| {
            run(s, Evi::trapezoid(h).linearised_at(equilibrium(s)?).composed(Composition::kahan_li_8()))
        }),
        member("galerkin_4", 8, "variational, Lobatto IIIA-IIIB with 5 stages", |s, h| {
            run(s, Galerkin::<4>::new(h))
        }),
        member("galerkin_8", 16, "variational, Lobatto IIIA-IIIB with 9 stages", |s, h| {
            run(s, Galerkin::<8>::new(h))
        }),
        member("gauss_4", 8, "variational, Gauss collocation with 4 nodes", |s, h| {
            run(s, Gauss::<4>::new(h))
        }),
        member("gauss_8", 16, "variational, Gauss collocation with 8 nodes", |s, h| {
            run(s, Gauss::<8>::new(h))
        }),
        baseline("rattle", 2, "leapfrog on the constraints", |s, h| run(s, Rattle::new(h))),
        baseline("shake", 2, "leapfrog on the constraints, velocities by differences", |s, h| {
            run(s, Shake::new(h))
        }),
        baseline("implicit_midpoint", 2, "implicit midpoint rule", |s, h| run(s, ImplicitMidpoint::new(h))),
        baseline("generalized_alpha", 2, "generalized-α, index 3", |s, h| run(s, GeneralizedAlpha::new(h))),
        baseline("rk4", 4, "explicit Runge-Kutta, index-1 equations", |s, h| run(s, Rk4::new(h))),
        generic("midpoint_generic", 2, "midpoint on matrices of run-time size, dual numbers", |s: &S, h| {
            let (q, v) = s.standard_motion();
            Ok(Box::new(GenericEvi::midpoint(h).start(s.clone(), q.as_ref(), v.as_ref())?))
        }),
        generic("midpoint_8_generic", 8, "the same, 17 steps composed (Kahan, Li)", |s: &S, h| {
            let (q, v) = s.standard_motion();
            let scheme = GenericEvi::midpoint(h).composed(Composition::kahan_li_8());
            Ok(Box::new(scheme.start(s.clone(), q.as_ref(), v.as_ref())?))
        }),
        generic(
            "galerkin_8_generic",
            16,
            "the member of 9 stages by Newton's iteration on dense matrices",
            |s: &S, h| {
                let (q, v) = s.standard_motion();
                Ok(Box::new(GenericGalerkin::new(8, h).start(s.clone(), q.as_ref(), v.as_ref())?))
            },
        ),
        external(
            "dop853",
            8,
            "explicit Runge-Kutta, index-1 equations, crate ode_solvers",
            |s: &S, tolerance| {
                let (q, v) = s.standard_motion();
                Ok(dop853(s, &q, &v, Tolerances::both(tolerance))?)
            },
        ),
        external("diffsol_bdf", 5, "BDF, index-1 equations, crate diffsol", |s, tolerance| {
            run_of_diffsol(s, DiffsolMethod::Bdf, tolerance)
        }),
        external("diffsol_esdirk", 3, "ESDIRK34, index-1 equations, crate diffsol", |s, tolerance| {
            run_of_diffsol(s, DiffsolMethod::Esdirk34, tolerance)
        }),
        program("heyoka", 20, "Taylor series, index-1 equations, compiled by heyoka", |_, _| {
            Err(Refusal::NotRun { reason: "a program of its own, asked for with --peers".into() }.into())
        }),
    ]
}

fn equilibrium<S: Scene>(system: &S) -> Result<S::PerCoordinate<f64>, Refusal> {
    system.equilibrium().ok_or(Refusal::NoEquilibrium)
}

/// A row of the table on one path; what comes from elsewhere chooses its steps by a tolerance.
macro_rules! rows {
    ($($kind:ident: $role:ident, $path:ident, $resolution:ident;)*) => {
        $(const fn $kind<S>(name: &'static str, order: u32, summary: &'static str, start: Start<S>) -> Method<S> {
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

fn run<S: Scene, F: Scheme<S, Step: 'static>>(system: &S, scheme: F) -> Result<Box<dyn Solver>, Failure> {
    let (q, v) = system.standard_motion();
    Ok(Box::new(Simulation::new(system.clone(), scheme).start(q, v)?))
}

fn run_of_diffsol<S: Scene>(
    system: &S,
    method: DiffsolMethod,
    tolerance: f64,
) -> Result<Box<dyn Solver>, Failure> {
    let (q, v) = system.standard_motion();
    match diffsol(system, method, &q, &v, Tolerances::both(tolerance)) {
        Err(DiffsolError::NotBuilt) => Err(Refusal::NotBuilt { feature: "diffsol" }.into()),
        result => Ok(result?),
    }
}
